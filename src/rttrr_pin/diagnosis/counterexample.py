"""A state in which two programs differ, with as few numbers as can be, as a test to paste."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.evidence import Evidence, flat, loaded, part_of, places, spread
from rttrr_pin.errors import RttrrError
from rttrr_pin.exact.enclosures import enclose
from rttrr_pin.implementations import Batch, Implementation
from rttrr_pin.implementations.protocol import evaluated
from rttrr_pin.validation.compare import with_allowance
from rttrr_pin.validation.comparison import true_parameters

KEPT = 1e-3
"""A simpler state is taken if this part of the error / tolerance is still there."""

ROUND = (1.0, -1.0, 0.5, -0.5)
"""What numbers of a state become, if they cannot become 0."""

Seen = tuple[Array, Array, Array]
"""The subject's values, those of the reference, and error / tolerance, (N, numbers) each."""


def counterexample(programs: Sequence[Implementation], evidence: Evidence) -> str:
    """Python code of a test, whose expected value is proven; empty where no state without payload differs."""
    batch = evidence.batch
    ratios = evidence.of_tolerance(evidence.expected)
    bare = ~loaded(batch)
    failing = np.flatnonzero((ratios > 1.0).any(axis=1) & bare)
    if not len(failing):
        return ""
    nonzero = sum((getattr(batch, name)[failing] != 0.0).sum(axis=1) for name in "qva")
    clear = ratios[failing].max(axis=1) >= KEPT * ratios[failing].max()
    order = np.lexsort((np.arange(len(failing)), nonzero, ~clear))
    state = _bare(part_of(batch, failing[order[:1]]))
    if not any(hasattr(one, "states") for one in programs):
        try:
            state = _simplest(state, lambda own: _seen(programs, own, evidence.quantities))
            *values, ratio = _seen(programs, state, evidence.quantities)
        except RttrrError:  # a program that refuses a simpler state
            return ""
    else:
        row = failing[order[:1]]
        values, ratio = [evidence.values[row], evidence.expected[row]], ratios[row]
    k = int(np.argmax(ratio[0]))
    names = ("your program", programs[1].name)
    got = [(name, float(x[0, k])) for name, x in zip(names, values, strict=True)]
    return _as_test(state, places(batch.model, evidence.quantities), k, got)


def _bare(batch: Batch) -> Batch:
    return Batch(batch.model, batch.q, batch.v, batch.a)


def _seen(programs: Sequence[Implementation], batch: Batch, quantities: Sequence[str]) -> Seen:
    results = [with_allowance(batch, evaluated(one, batch)) for one in programs]
    x, y = (flat(dict(one.values), quantities) for one in results)
    first, second = (spread(dict(one.allowance or {}), quantities) for one in results)
    allowed = first + second
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(x == y, 0.0, np.abs(x - y) / allowed)
    return x, y, np.where(np.isnan(ratio), np.inf, ratio)


def _simplest(state: Batch, ask: Callable[[Batch], Seen]) -> Batch:
    """Zeros where they may be, then round numbers, number by number, as long as the difference stays clear."""
    model = state.model
    zero = model.coordinates_at(np.zeros((1, model.nv)))
    fixed = {first + k for first in model.quaternions for k in range(4)}
    least = max(1.0, KEPT * float(ask(state)[2].max()))
    steps: list[Callable[[dict[str, Array]], list[dict[str, Array]]]] = []

    def whole(name: str) -> Callable[[dict[str, Array]], list[dict[str, Array]]]:
        return lambda own: [own | {name: zero if name == "q" else np.zeros_like(own[name])}]

    def entry(name: str, k: int) -> Callable[[dict[str, Array]], list[dict[str, Array]]]:
        def options(own: dict[str, Array]) -> list[dict[str, Array]]:
            x = float(own[name][0, k])
            chosen = [y for y in (0.0, *ROUND, float(f"{x:.1g}"), float(f"{x:.2g}")) if abs(y) <= abs(x) or y == 0.0]
            if x == 0.0 or x in chosen[:1]:
                return []
            out = []
            for y in chosen:
                moved = own[name].copy()
                moved[0, k] = y
                out.append(own | {name: moved})
            return out

        return options

    steps += [whole(name) for name in "vaq"]
    steps += [
        entry(name, k) for name in "vaq" for k in range(getattr(state, name).shape[1]) if name != "q" or k not in fixed
    ]
    own = {name: getattr(state, name) for name in "qva"}
    for step in steps:
        options = step(own)
        if not options:
            continue
        q, v, a = (np.concatenate([one[name] for one in options]) for name in "qva")
        ratios = ask(Batch(model, q, v, a))[2].max(axis=1)
        good = np.flatnonzero(ratios >= least)
        if len(good):
            own = options[int(good[0])]
    return Batch(model, own["q"], own["v"], own["a"])


def _as_test(state: Batch, labels: Sequence[tuple[str, str]], k: int, of_programs: Sequence[tuple[str, float]]) -> str:
    """The code; the expected value is the middle of its enclosure, and it is for the program farther from that."""
    model = state.model
    quantity, at = labels[k]
    exact = getattr(enclose(model, state.q, state.v, state.a, (), true_parameters(model)), quantity)
    column = sum(1 for own in labels[:k] if own[0] == quantity)
    lower, upper = (x.reshape(len(x), -1)[0, column] for x in (exact.lower, exact.upper))
    expected = float(lower + (upper - lower) / 2)
    name, got = max(of_programs, key=lambda own: abs(own[1] - expected))
    index = f"[{column}]" if quantity == "tau" else f"[{column // 3}][{column % 3}]"
    q, v, a = ("[" + ", ".join(f"{x:.17g}" for x in getattr(state, name)[0]) + "]" for name in "qva")
    gravity = ", ".join(f"{x:g}" for x in model.gravity)
    sign = "+" if expected < 0.0 else "-"
    return "\n".join(
        [
            f"def test_{quantity}_of_{_identifier(at)}():",
            f"    # {_in_comment(model.name)}; {_in_comment(_order(model))}; gravity ({gravity}) m/s^2",
            f"    {quantity} = inverse_dynamics(  # {_in_comment(name)}",
            f"        q={q},",
            f"        v={v},",
            f"        a={a},",
            "    )",
            f"    # proven by interval arithmetic; it was {got:.17g}",
            f"    assert abs({quantity}{index} {sign} {abs(expected)!r}) <= {max(abs(expected), abs(got)) * 1e-9:.1e}",
        ]
    )


def _order(model: Model) -> str:
    return f"q, v, a of {', '.join(model.joint_names)}"


def _identifier(name: str) -> str:
    return "".join(x if x.isascii() and x.isalnum() else "_" for x in name)


def _in_comment(name: str) -> str:
    return " ".join(name.split())
