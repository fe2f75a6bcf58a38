"""What a difference depends on: coordinates, rates, accelerations, payload, and how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.engine.evidence import Evidence, loaded, places, results
from rttrr_pin.diagnosis.engine.fitting import EQUATIONS
from rttrr_pin.diagnosis.engine.gathering import asked
from rttrr_pin.errors import ImplementationError, RttrrError, listed
from rttrr_pin.implementations import Batch, Implementation
from rttrr_pin.validation.sampling import Sampler

POSES = 4
"""Poses at which programs are asked again."""

CLEAR = 100.0
"""A change of the difference is one if it is so many times what rounding explains."""

ALIKE = 1e-6
"""Relative: ratios as near as that to 2 or 4 are these."""

FULL = 10
"""Numbers of the largest causes: the inertial parameters of a link."""

Ask = Callable[[Array, Array, Array], Evidence]
"""Two programs at q, v, a, without payload."""


def dependence(programs: Sequence[Implementation], evidence: Evidence) -> tuple[str, ...]:
    """Sentences: where the difference is, and how it changes with the state.

    Programs are asked at new states; of a table only its own rows can be looked at.
    """
    where = _where(evidence)
    count = results(evidence)
    tried = count // EQUATIONS
    if tried < FULL:
        where += f"; {count} results are too few for a cause with more than {tried} fitted numbers"
    if any(hasattr(one, "states") for one in programs):
        return (where, *_of_rows(evidence))
    try:
        return (where, *_asked(programs, evidence))
    except RttrrError as error:
        return (where, f"how it changes with the state could not be asked: {error}")


def _where(evidence: Evidence) -> str:
    """The joints and links at which the programs differ."""
    bad = evidence.of_tolerance(evidence.expected).max(axis=0) > 1.0
    labels = places(evidence.batch.model, evidence.quantities)
    differing = list(dict.fromkeys(place for place, own in zip(labels, bad, strict=True) if own))
    agreeing = [place for place in dict.fromkeys(labels) if place not in differing]
    if not agreeing:
        return "it differs at every joint and link"
    text, others = (listed(f"{key} of {at}" for key, at in own) for own in (differing, agreeing))
    return f"it differs in {text}; not in {others}"


def _asked(programs: Sequence[Implementation], evidence: Evidence) -> list[str]:
    """How the difference changes with rates, accelerations, coordinates and payload."""
    model = evidence.batch.model
    drawn = Sampler(model).draw(0, POSES)
    q, v, a, still = drawn.q, drawn.v, drawn.a, np.zeros_like(drawn.v)

    def ask(batch: Batch) -> Evidence:
        found = asked(programs, batch, evidence.quantities)
        for program, own in zip(programs, (found.values, found.expected), strict=True):
            if not np.isfinite(own).all():
                raise ImplementationError(f"{program.name} has no number at some of the states it was asked at")
        return found

    def at(q: Array, v: Array, a: Array) -> Evidence:
        return ask(Batch(model, q, v, a))

    whole, again = at(q, v, a), at(q, v, a)
    if (np.abs(whole.difference - again.difference) > whole.tolerance + again.tolerance).any():
        return ["it is another one when the same states are asked again: a program is not deterministic"]
    rest, of_v, of_a = at(q, still, still), at(q, v, still), at(q, still, a)
    lines = ["it is there at rest" if _clear(rest) else "it is zero at rest"]
    lines.append(_of_rates(rest, of_v, at(q, 2 * v, still), at(q, -v, still)))
    lines.append(_of_accelerations(rest, of_a, at(q, still, 2 * a)))
    if _clear(_sum((1, whole), (-1, of_v), (-1, of_a), (1, rest))):
        lines.append("rates and accelerations do not simply add up")
    if model.nq == model.nv:
        steps = zip(model.v_names, 0.5 * np.eye(model.nv), strict=True)
        moving = [name for name, step in steps if _clear(_sum((1, at(q + step, v, a)), (-1, whole)))]
        lines.append(f"it changes with {f'the coordinate of {listed(moving)}' if moving else 'no coordinate'}")
    if evidence.batch.loads:
        changes = _clear(_sum((1, ask(Batch(model, q, v, a, (_largest(evidence.batch.loads[0]),)))), (-1, whole)))
        lines.append("it changes with the payload" if changes else "the payload does not change it")
    return lines


def _largest(load: Load) -> Load:
    """The payload of the state in which it is largest, for all states; in some of a batch there is none."""
    sizes = np.linalg.norm(np.hstack([np.atleast_2d(load.f), np.atleast_2d(load.n)]), axis=-1)
    return load if load.f.ndim == 1 else replace(load, f=load.f[np.argmax(sizes)], n=load.n[np.argmax(sizes)])


def _of_rates(rest: Evidence, once: Evidence, twice: Evidence, back: Evidence) -> str:
    first, second, reverse = (_sum((1, own), (-1, rest)) for own in (once, twice, back))
    if not _clear(first) and not _clear(second):
        return "rates do not change it"
    if _same(second, 4, first) and _same(reverse, 1, first):
        return "it is quadratic in the rates"
    if _same(second, 2, first) and _same(reverse, -1, first):
        return "it is linear in the rates"
    if _same(second, 1, first) and _same(reverse, -1, first):
        return "it has the sign of the rates, whatever their size"
    return "it changes with the rates, neither linearly nor as their square"


def _of_accelerations(rest: Evidence, once: Evidence, twice: Evidence) -> str:
    first, second = (_sum((1, own), (-1, rest)) for own in (once, twice))
    if not _clear(first) and not _clear(second):
        return "accelerations do not change it"
    return "it is linear in the accelerations" if _same(second, 2, first) else "it is not linear in a"


def _of_rows(evidence: Evidence) -> list[str]:
    """What the rows of a table tell."""
    batch, bad = evidence.batch, evidence.of_tolerance(evidence.expected).max(axis=1) > 1.0
    v, a = ((getattr(batch, name) != 0.0).any(axis=1) for name in "va")
    with_load = loaded(batch)
    kinds = {
        "at rest": ~v & ~a & ~with_load,
        "with rates alone": v & ~a & ~with_load,
        "with accelerations alone": ~v & a & ~with_load,
        "with both": v & a & ~with_load,
        "with a payload": with_load,
    }
    lines = [
        f"{int(bad[rows].sum())} of {int(rows.sum())} states {kind} differ"
        for kind, rows in kinds.items()
        if rows.any()
    ]
    missing = [kind for kind, rows in kinds.items() if not rows.any()]
    if missing:
        lines.append(f"the table has no states {' or '.join(missing)}: rttrr-pin sample writes some of each kind")
    return lines


Difference = tuple[Array, Array]
"""Of two programs, and what rounding explains of it, (N, numbers) each."""


def _sum(*terms: tuple[int, Evidence]) -> Difference:
    """The differences at several states, added up, (N, numbers), and what rounding explains of it."""
    return sum(sign * own.difference for sign, own in terms), sum(own.tolerance for _, own in terms)  # type: ignore[return-value]


def _clear(found: Evidence | Difference) -> bool:
    change, allowed = found if isinstance(found, tuple) else _sum((1, found))
    return bool((np.abs(change) > CLEAR * allowed).any())


def _same(own: Difference, times: int, other: Difference) -> bool:
    """Whether one is so many times another."""
    x, y = own[0], times * other[0]
    return bool((np.abs(x - y) <= CLEAR * (own[1] + other[1]) + ALIKE * np.abs(y).max()).all())
