"""What a difference depends on: coordinates, rates, accelerations, payload, and how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.evidence import Evidence, flat, loaded, places, results, spread
from rttrr_pin.diagnosis.fitting import EQUATIONS
from rttrr_pin.errors import ImplementationError, RttrrError
from rttrr_pin.implementations import Batch, Implementation
from rttrr_pin.implementations.protocol import evaluated
from rttrr_pin.validation.compare import with_allowance
from rttrr_pin.validation.sampling import Sampler

POSES = 4
"""Poses at which programs are asked again."""

CLEAR = 100.0
"""A change of the difference is one if it is so many times what rounding explains."""

ALIKE = 1e-6
"""Relative: ratios as near as that to 2 or 4 are these."""

FULL = 10
"""Numbers of the largest causes: the inertial parameters of a link."""

Differences = Callable[[Batch], tuple[Array, Array]]
"""The difference of two programs, (N, numbers), and what rounding explains of it."""


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
        return (where, *_asked(_differences(programs, evidence.quantities), evidence))
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
    text = _listed([f"{key} of {at}" for key, at in differing])
    return f"it differs in {text}; not in {_listed([f'{key} of {at}' for key, at in agreeing])}"


def _listed(words: Sequence[str], most: int = 6) -> str:
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def _differences(programs: Sequence[Implementation], quantities: Sequence[str]) -> Differences:
    def ask(batch: Batch) -> tuple[Array, Array]:
        found = [with_allowance(batch, evaluated(one, batch)) for one in programs]
        x, y = (flat(dict(one.values), quantities) for one in found)
        first, second = (spread(dict(one.allowance or {}), quantities) for one in found)
        for program, own in zip(programs, (x, y), strict=True):
            if not np.isfinite(own).all():
                raise ImplementationError(f"{program.name} has no number at some of the states it was asked at")
        return x - y, first + second

    return ask


def _asked(ask: Differences, evidence: Evidence) -> list[str]:
    """How the difference changes with rates, accelerations, coordinates and payload."""
    model = evidence.batch.model
    drawn = Sampler(model).draw(0, POSES)
    q, v, a = drawn.q, drawn.v, drawn.a
    still = np.zeros_like(v)
    loads = tuple(map(_largest, evidence.batch.loads))

    def at(q: Array, v: Array, a: Array) -> tuple[Array, Array]:
        return ask(Batch(model, q, v, a))

    whole, again = at(q, v, a), at(q, v, a)
    if (np.abs(whole[0] - again[0]) > whole[1] + again[1]).any():
        return ["it is another one when the same states are asked again: a program is not deterministic"]
    rest, allowed = at(q, still, still)
    lines = ["it is there at rest" if _clear(rest, allowed) else "it is zero at rest"]
    lines += _of_rates(at, q, v, still)
    lines += _of_accelerations(at, q, a, still)
    of_v, of_a = at(q, v, still), at(q, still, a)
    mixed = whole[0] - of_v[0] - of_a[0] + rest
    if _clear(mixed, whole[1] + of_v[1] + of_a[1] + allowed):
        lines.append("rates and accelerations do not simply add up")
    moving = []
    for k, name in enumerate(model.v_names):
        displacement = np.zeros_like(v)
        displacement[:, k] = 0.5
        if model.nq != model.nv:
            break
        moved = at(q + displacement, v, a)
        if _clear(moved[0] - whole[0], moved[1] + whole[1]):
            moving.append(name)
    if model.nq == model.nv:
        lines.append(
            f"it changes with the coordinate of {_listed(moving)}" if moving else "it changes with no coordinate"
        )
    if loads:
        loaded = ask(Batch(model, q, v, a, loads[:1]))
        changes = _clear(loaded[0] - whole[0], loaded[1] + whole[1])
        lines.append("it changes with the payload" if changes else "the payload does not change it")
    return lines


def _largest(load: Load) -> Load:
    """The payload of the state in which it is largest, for all states; in some of a batch there is none."""
    sizes = np.linalg.norm(np.hstack([np.atleast_2d(load.f), np.atleast_2d(load.n)]), axis=-1)
    return load if load.f.ndim == 1 else replace(load, f=load.f[np.argmax(sizes)], n=load.n[np.argmax(sizes)])


def _of_rates(at: Callable[[Array, Array, Array], tuple[Array, Array]], q: Array, v: Array, still: Array) -> list[str]:
    rest, once, twice, back = (at(q, x, still) for x in (still, v, 2 * v, -v))
    first, second, reverse = (x[0] - rest[0] for x in (once, twice, back))
    allowed = once[1] + twice[1] + back[1] + rest[1]
    if not _clear(first, allowed) and not _clear(second, allowed):
        return ["rates do not change it"]
    if _same(second, 4 * first, allowed) and _same(reverse, first, allowed):
        return ["it is quadratic in the rates"]
    if _same(second, 2 * first, allowed) and _same(reverse, -first, allowed):
        return ["it is linear in the rates"]
    if _same(second, first, allowed) and _same(reverse, -first, allowed):
        return ["it has the sign of the rates, whatever their size"]
    return ["it changes with the rates, neither linearly nor as their square"]


def _of_accelerations(
    at: Callable[[Array, Array, Array], tuple[Array, Array]], q: Array, a: Array, still: Array
) -> list[str]:
    rest, once, twice = (at(q, still, x) for x in (still, a, 2 * a))
    first, second = once[0] - rest[0], twice[0] - rest[0]
    allowed = once[1] + twice[1] + rest[1]
    if not _clear(first, allowed) and not _clear(second, allowed):
        return ["accelerations do not change it"]
    return ["it is linear in the accelerations" if _same(second, 2 * first, allowed) else "it is not linear in a"]


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


def _clear(change: Array, allowed: Array) -> bool:
    return bool((np.abs(change) > CLEAR * allowed).any())


def _same(x: Array, y: Array, allowed: Array) -> bool:
    return bool((np.abs(x - y) <= CLEAR * allowed + ALIKE * np.abs(y).max()).all())
