"""A state in which two programs differ, with as few numbers as can be, as a test to paste."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.engine.evidence import Evidence, joined, loaded, places
from rttrr_pin.diagnosis.engine.gathering import asked
from rttrr_pin.errors import RttrrError
from rttrr_pin.exact.enclosures import enclose
from rttrr_pin.implementations import Batch, Implementation
from rttrr_pin.validation.comparison import true_parameters

KEPT = 1e-3
"""A simpler state is taken if this part of the error / tolerance is still there."""

ROUND = (1.0, -1.0, 0.5, -0.5)
"""What numbers of a state become, if they cannot become 0."""


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
    found = evidence.part(failing[order[:1]])
    if not any(hasattr(one, "states") for one in programs):
        try:
            found = _simplest(replace(found, batch=_bare(found.batch)), programs)
        except RttrrError:  # a program that refuses a simpler state
            return ""
    k = int(np.argmax(found.of_tolerance(found.expected)[0]))
    got = [("your program", float(found.values[0, k])), (programs[1].name, float(found.expected[0, k]))]
    return _as_test(_bare(found.batch), places(batch.model, evidence.quantities), k, got)


def _bare(batch: Batch) -> Batch:
    return Batch(batch.model, batch.q, batch.v, batch.a)


def _simplest(found: Evidence, programs: Sequence[Implementation]) -> Evidence:
    """Zeros where they may be, then round numbers, number by number, as long as the difference stays clear."""
    model = found.batch.model
    least = max(1.0, KEPT * float(found.of_tolerance(found.expected).max()))
    fixed = {first + k for first in model.quaternions for k in range(4)}
    steps: list[tuple[str, int | None]] = [(name, None) for name in "vaq"]
    steps += [
        (name, k) for name in "vaq" for k in range(getattr(found.batch, name).shape[1]) if name != "q" or k not in fixed
    ]
    for name, k in steps:
        options = _options(found.batch, name, k)
        if options:
            seen = asked(programs, joined(options), found.quantities)
            good = np.flatnonzero(seen.of_tolerance(seen.expected).max(axis=1) >= least)
            found = seen.part(good[:1]) if len(good) else found
    return found


def _options(state: Batch, name: str, k: int | None) -> list[Batch]:
    """The state with simpler numbers in q, v or a, in one place or in all, the simplest first."""
    own = getattr(state, name)
    if k is None:
        zero = np.zeros((1, state.model.nv))
        return [_with(state, name, state.model.coordinates_at(zero) if name == "q" else zero)]
    x = float(own[0, k])
    simpler = [y for y in (0.0, *ROUND, float(f"{x:.1g}"), float(f"{x:.2g}")) if abs(y) <= abs(x)]
    at_k = np.arange(own.shape[1]) == k
    return [_with(state, name, np.where(at_k, y, own)) for y in simpler] if x else []


def _with(state: Batch, name: str, x: Array) -> Batch:
    """The state with other numbers in q, v or a."""
    q, v, a = (x if own == name else getattr(state, own) for own in "qva")
    return Batch(state.model, q, v, a)


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
