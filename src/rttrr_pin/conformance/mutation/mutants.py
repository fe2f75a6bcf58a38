"""Wrong dynamics of a robot: each hypothesis of the catalogue by itself, once, and only where it changes a result.

Where a number may be any, such as a mass, it is a tenth of the way from the right one to where fits begin: ten percent
of a mass, 0.03 rad of a joint's zero, 0.01 kg m^2 of armature.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np

from rttrr_pin.core.arguments import not_negative
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.engine.evidence import flat, places, rms, spread
from rttrr_pin.diagnosis.engine.side_by_side import evaluate_all
from rttrr_pin.diagnosis.engine.simultaneous import together
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

TINY = 1e-300
"""What is divided by at least."""

PROJECTIONS, SAME = 4, 1e-9
"""Changes whose projections on so many random directions are as near, relatively, are the same."""


Planted: TypeAlias = tuple[int, tuple[float, ...]]
"""A hypothesis by its index in the catalogue of a robot, and the numbers that it has."""


@dataclass(frozen=True, slots=True, eq=False)
class Mutant:
    """Wrong dynamics of a robot.

    Attributes:
        index: of the hypothesis in the catalogue of the robot.
        numbers: those that it has where they may be any.
        hypothesis: what it is called, the same for each link or joint.
        kind: convention, parameters, joint or mechanics.
        sentence: what is wrong.
        link: the link that it is about; None where it is about none, or about all.
        joint: the joint, likewise.
        values: the numbers by name, beside those of the robot's file.
        line: the line of the recursion or of the robot's file to look at; else empty.
        others: other hypotheses that give the same results, in sentences.
        quantity: where it changes most, beside what is expected there: tau, F, N, f or n,
        at: of this joint or link,
        change: by so much [unit],
        unit: N or N m,
        relative: and so much of the root mean square of what is expected.
    """

    index: int
    numbers: tuple[float, ...]
    hypothesis: str
    kind: str
    sentence: str
    link: str | None
    joint: str | None
    values: Mapping[str, Any]
    line: str
    others: tuple[str, ...]
    quantity: str
    at: str
    change: float
    unit: str
    relative: float

    @property
    def planted(self) -> Planted:
        """The hypothesis by its index, and its numbers."""
        return self.index, self.numbers


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
    hypotheses = catalogue(robot.model)
    tried = [(index, planted(own, size)) for index, own in enumerate(hypotheses)]
    expected = flat(dict(batch.recursion[0].items()), keys)
    least = 2.0 * spread(default_allowance(batch), keys)
    sizes = rms(expected)
    directions = np.random.default_rng(0).standard_normal((expected.size, PROJECTIONS))
    kept: list[Mutant] = []
    marks: list[Array] = []
    units = [(key, at, unit) for key, at, unit in labels(robot.model) if key in keys]
    named = {(key, at): unit for key, at, unit in units}
    columns = places(robot.model, keys)
    with np.errstate(all="ignore"):  # what overflows is wrong, and no warning
        for (index, numbers), values in zip(tried, results(robot.model, tried, batch), strict=True):
            change = flat(values, keys) - expected
            seen = ~(np.abs(change) <= least)
            if not seen.any():
                continue
            part = ratio(np.where(seen, np.abs(change), 0.0), np.broadcast_to(sizes, change.shape))
            part = np.where(np.isfinite(change), part, np.inf)
            k, column = np.unravel_index(int(np.argmax(part)), part.shape)
            key, at = columns[int(column)]
            where = key, at, float(abs(change[k, column])), named[key, at], float(part[k, column])
            kept.append(_mutant(hypotheses[index], index, numbers, where))
            marks.append(change.ravel() / least.ravel().clip(TINY) @ directions)
    distinct = _distinct(kept, np.array(marks).reshape(-1, PROJECTIONS))
    return Mutants(robot, keys, tuple(distinct), len(tried) - len(kept))


@lru_cache(maxsize=8)
def catalogue(model: Model) -> tuple[Hypothesis, ...]:
    """All hypotheses about a robot."""
    return tuple(hypotheses_of(model))


def _mutant(
    own: Hypothesis, index: int, numbers: tuple[float, ...], where: tuple[str, str, float, str, float]
) -> Mutant:
    values = dict(own.values(numbers)) if numbers else {}
    return Mutant(index, numbers, own.id, own.kind, own.sentence, own.link, own.joint, values, own.line, (), *where)


def planted(own: Hypothesis, size: float) -> tuple[float, ...]:
    """The numbers that a program has under a hypothesis, as far from the right ones."""
    return tuple(x + size * (y - x) for x, y in zip(own.neutral, own.start, strict=True))


def results(model: Model, tried: Sequence[Planted], batch: Batch) -> Iterator[Values]:
    """What the program under each hypothesis computes, one after the other."""
    base, hypotheses = Variant(model), catalogue(model)
    found = [(hypotheses[index], numbers) for index, numbers in tried]
    errors = [own.mutation for own, _ in found if own.mutation is not None]
    wrong = together(errors, model, batch)
    others = _in_parts([own.apply(base, numbers) for own, numbers in found if own.mutation is None], batch)
    for own, _ in found:
        yield next(others if own.mutation is None else wrong)


def _in_parts(variants: Sequence[Variant], batch: Batch) -> Iterator[Values]:
    for first in range(0, len(variants), AT_ONCE):
        yield from evaluate_all(variants[first : first + AT_ONCE], batch)


def _distinct(found: Sequence[Mutant], marks: Array) -> list[Mutant]:
    """One for all that change the same, the first of them."""
    stands: dict[int, list[str]] = {}
    order = np.lexsort((np.arange(len(found)), *(x for x in marks.T[::-1]))).tolist()
    groups: list[list[int]] = []
    for k in order:
        if groups and np.isfinite(marks[k]).all() and np.allclose(marks[k], marks[groups[-1][0]], SAME, 0.0):
            groups[-1].append(k)
        else:
            groups.append([k])
    for group in groups:
        first, *others = sorted(group)
        stands[first] = [found[k].sentence for k in others]
    return [replace(found[k], others=tuple(stands[k])) for k in sorted(stands)]
