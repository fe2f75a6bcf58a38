"""Wrong dynamics of a robot: each hypothesis of the catalogue by itself, once, and only where it changes a result.

Where a number may be any, such as a mass, it is a tenth of the way from the right one to where fits begin: ten percent
of a mass, 0.03 rad of a joint's zero, 0.01 kg m^2 of armature.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from rttrr_pin.core.arguments import not_negative
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.engine.evidence import flat, places, rms, spread
from rttrr_pin.diagnosis.engine.side_by_side import evaluate_all
from rttrr_pin.diagnosis.engine.simultaneous import together
from rttrr_pin.diagnosis.run import hypotheses_of
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant
from rttrr_pin.implementations import Batch, default_allowance
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import labels, ratio

SIZE = 0.1
"""Of the way from what is right to where fits of a number begin."""

TELLING = 100
"""States on which it is seen whether a hypothesis changes anything."""

AT_ONCE = 256
"""Programs whose results are held at a time."""

PROJECTIONS, SAME = 4, 1e-9
"""Changes whose projections on so many random directions are as near, relatively, are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Mutant:
    """Wrong dynamics of a robot.

    Attributes:
        index: of the hypothesis in the catalogue of the robot.
        hypothesis: what is wrong.
        numbers: those that it has where they may be any.
        others: hypotheses that give the same results.
        quantity: where it changes most, beside what is expected there: tau, F, N, f or n,
        at: of this joint or link,
        change: by so much [unit],
        unit: N or N m,
        relative: and so much of the root mean square of what is expected.
    """

    index: int
    hypothesis: Hypothesis
    numbers: tuple[float, ...]
    others: tuple[Hypothesis, ...]
    quantity: str
    at: str
    change: float
    unit: str
    relative: float


@dataclass(frozen=True, slots=True, eq=False)
class Mutants:
    """All wrong dynamics of a robot that a suite could see.

    Attributes:
        robot: whose.
        quantities: those in which they differ.
        found: the mutants, in the order of the catalogue.
        equivalent: how many hypotheses change no result by more than rounding, and are no mutants.
    """

    robot: Robot
    quantities: tuple[str, ...]
    found: tuple[Mutant, ...]
    equivalent: int


def mutants(
    robot: Robot,
    quantities: Sequence[str] = ("tau",),
    payload: bool = False,
    size: float = SIZE,
    seed: int = 0,
) -> Mutants:
    """The wrong dynamics of a robot.

    A hypothesis is one if it changes a result by more than rounding in one of the telling states (`sample_states`); of
    several that change the same, the first is.

    Args:
        robot: the robot.
        quantities: those that are looked at.
        payload: whether states with a payload are among them.
        size: how far numbers that may be any are from the right ones; 1 is where fits begin.
        seed: of the states.
    """
    keys = tuple(key for key in QUANTITIES if key in quantities)
    return _mutants(robot, keys, payload, not_negative("size", size), seed)


@lru_cache(maxsize=8)
def _mutants(robot: Robot, keys: tuple[str, ...], payload: bool, size: float, seed: int) -> Mutants:
    """Those of the last calls are kept: several suites are compared on one robot."""
    batch = sample_states(robot, TELLING, seed, RandomPayload() if payload else None).states
    tried = [(own, planted(own, size)) for own in hypotheses_of(robot.model)]
    expected = flat(dict(batch.recursion[0].items()), keys)
    least = 2.0 * spread(default_allowance(batch), keys)
    sizes = rms(expected)
    directions = np.random.default_rng(0).standard_normal((expected.size, PROJECTIONS))
    kept: list[Mutant] = []
    marks: list[Array] = []
    units = [(key, at, unit) for key, at, unit in labels(robot.model) if key in keys]
    named = {(key, at): unit for key, at, unit in units}
    columns = places(robot.model, keys)
    for index, ((own, numbers), values) in enumerate(zip(tried, results(robot, tried, batch), strict=True)):
        with np.errstate(all="ignore"):
            change = np.abs(flat(values, keys) - expected)
            seen = ~(change <= least)
            if not seen.any():
                continue
            part = ratio(np.where(seen, change, 0.0), np.broadcast_to(sizes, change.shape))
            marks.append((flat(values, keys) - expected).ravel() / np.abs(least).ravel().clip(1e-300) @ directions)
        finite = np.where(np.isfinite(change), part, np.inf)
        k, column = np.unravel_index(int(np.argmax(finite)), finite.shape)
        key, at = columns[int(column)]
        kept.append(
            Mutant(index, own, numbers, (), key, at, float(change[k, column]), named[key, at], float(finite[k, column]))
        )
    distinct = _distinct(kept, np.array(marks).reshape(-1, PROJECTIONS))
    return Mutants(robot, keys, tuple(distinct), len(tried) - len(kept))


def planted(own: Hypothesis, size: float) -> tuple[float, ...]:
    """The numbers that a program has under a hypothesis, as far from the right ones."""
    return tuple(x + size * (y - x) for x, y in zip(own.neutral, own.start, strict=True))


def results(robot: Robot, tried: Sequence[tuple[Hypothesis, tuple[float, ...]]], batch: Batch) -> Iterator[Values]:
    """What the program under each hypothesis computes, one after the other."""
    base = Variant(robot.model)
    errors = [own.mutation for own, _ in tried if own.mutation is not None]
    wrong = together(errors, robot.model, batch)
    rest = [own.apply(base, numbers) for own, numbers in tried if own.mutation is None]
    others = _in_parts(rest, batch)
    for own, _ in tried:
        yield next(others if own.mutation is None else wrong)


def _in_parts(variants: Sequence[Variant], batch: Batch) -> Iterator[Values]:
    for first in range(0, len(variants), AT_ONCE):
        yield from evaluate_all(variants[first : first + AT_ONCE], batch)


def _distinct(found: Sequence[Mutant], marks: Array) -> list[Mutant]:
    """One for all that change the same, the first of them."""
    stands: dict[int, list[Hypothesis]] = {}
    order = np.lexsort((np.arange(len(found)), *(x for x in marks.T[::-1]))).tolist()
    groups: list[list[int]] = []
    for k in order:
        if groups and np.isfinite(marks[k]).all() and np.allclose(marks[k], marks[groups[-1][0]], SAME, 0.0):
            groups[-1].append(k)
        else:
            groups.append([k])
    for group in groups:
        first, *others = sorted(group)
        stands[first] = [found[k].hypothesis for k in others]
    return [replace(found[k], others=tuple(stands[k])) for k in sorted(stands)]


def as_data(own: Mutant) -> dict[str, Any]:
    """A mutant as data for JSON."""
    return {
        "hypothesis": own.hypothesis.id,
        "kind": own.hypothesis.kind,
        "sentence": own.hypothesis.sentence,
        "link": own.hypothesis.link,
        "joint": own.hypothesis.joint,
        "values": dict(own.hypothesis.values(own.numbers)) if own.numbers else {},
        "line": own.hypothesis.line,
        "quantity": own.quantity,
        "at": own.at,
        "largest_change": own.change,
        "unit": own.unit,
        "relative_change": own.relative,
        "the_same": [one.sentence for one in own.others],
    }
