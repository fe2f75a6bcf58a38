"""Faulty programs, made from the catalogue of hypotheses and judged on one set of states for each robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.evidence import Evidence, flat, screened, spread
from rttrr_pin.diagnosis.fitting import Explanation
from rttrr_pin.diagnosis.hypothesis import Hypothesis
from rttrr_pin.diagnosis.predictions import Raw, applied, predicted, raw_changes
from rttrr_pin.diagnosis.run import hypotheses_of
from rttrr_pin.diagnosis.search import Search
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.diagnosis.variant import Variant
from rttrr_pin.implementations import default_allowance
from rttrr_pin.loading import load
from rttrr_pin.robot import Robot
from support.trees import random_tree

Fault = tuple[Hypothesis, tuple[float, ...]]
"""A hypothesis, and the numbers with which a program has it."""

CHAIN = ("revolute", "prismatic", "continuous", "revolute")

TREE = ("revolute", "continuous", "prismatic", "fixed", "revolute")


def bench_robot(seed: int) -> Robot:
    """A random robot: every other one is a chain, some have mimic joints, one in four floats, half have friction."""
    types = CHAIN if seed % 2 else TREE
    base = "floating" if seed % 4 == 2 else "fixed"
    return load(random_tree(seed, 3 + seed % 3, types), base=base, friction=seed % 3 == 0)  # type: ignore[arg-type]


SAME = 100.0
"""Times rounding: results that near are those of one program, whose numbers were fitted to rounded results."""


@dataclass(frozen=True)
class Judged:
    """What came of a planted fault.

    Attributes:
        visible: whether it changes a number by more than rounding can.
        detected: whether it was seen to differ.
        first: whether it is named: as the cause, or as one that no number of these states tells from it.
        same: else, whether what is named gives the same results at other states too, so that no torque can tell.
        explanations: what was found.
    """

    visible: bool
    detected: bool
    first: bool
    same: bool
    explanations: list[Explanation]


class Bench:
    """A robot, its states, and what every hypothesis changes there."""

    def __init__(self, robot: Robot, quantities: tuple[str, ...] = ("tau",), states: int = 72, seed: int = 0) -> None:
        self.model: Model = robot.model
        self.quantities = quantities
        self.batch = sample_states(robot, states, seed).states
        self.base = Variant(self.model)
        self.hypotheses = hypotheses_of(self.model)
        rounding = spread(default_allowance(self.batch), QUANTITIES)
        keep = np.cumsum([0] + [x.reshape(len(x), -1).shape[1] for x in self.base.evaluate(self.batch).values()])
        chosen = np.concatenate(
            [np.arange(keep[QUANTITIES.index(k)], keep[QUANTITIES.index(k) + 1]) for k in quantities]
        )
        self.rounding = rounding[:, chosen]
        self.expected = flat(self.base.evaluate(self.batch), quantities)

    def evidence(self, values: np.ndarray, tolerance: np.ndarray | None = None) -> Evidence:
        """The results of a program."""
        allowed = self.rounding if tolerance is None else tolerance
        return Evidence(self.batch, self.quantities, values, self.expected, allowed, self.rounding)

    @cached_property
    def raw(self) -> list[Raw]:
        """What each hypothesis changes on the sample."""
        rows = screened(self.batch)
        return raw_changes(self.base, self.hypotheses, self.evidence(self.expected).part(rows))

    def values(self, faults: Sequence[Fault], rng: np.random.Generator) -> np.ndarray:
        """What a program with these faults computes, with some rounding of its own."""
        variant = applied(self.base, [own for own, _ in faults], [x for _, numbers in faults for x in numbers])
        exact = predicted(variant, self.evidence(self.expected))
        return exact + self.rounding * rng.uniform(-0.3, 0.3, exact.shape)

    def drawn(self, own: Hypothesis, rng: np.random.Generator) -> Fault:
        """A fault with random numbers, some way from those that say nothing."""
        steps = [(y - x) or 1.0 for x, y in zip(own.neutral, own.start, strict=True)]
        sizes = rng.uniform(0.3, 3.0, len(steps)) * rng.choice([-1.0, 1.0], len(steps))
        return own, tuple(float(x + s * d) for x, s, d in zip(own.neutral, sizes, steps, strict=True))

    def judged(self, faults: Sequence[Fault], rng: np.random.Generator) -> Judged:
        """Plant faults, and look whether they are named."""
        return self.judged_values(self.values(faults, rng), faults)

    def judged_values(self, values: np.ndarray, faults: Sequence[Fault], tolerance: np.ndarray | None = None) -> Judged:
        """The same for results that are there already."""
        evidence = self.evidence(values, tolerance)
        ratio = float(evidence.of_tolerance(self.expected).max())
        if ratio <= 1.0:
            return Judged(ratio > 2.0, False, False, False, [])
        found = Search(evidence, self.base, self.hypotheses, raw=self.raw).run()
        explaining = [own for own in found if own.explains]
        named = any(names(own, faults) for own in explaining)
        return Judged(True, True, named, not named and any(self.same(own, faults) for own in explaining), explaining)

    def same(self, found: Explanation, faults: Sequence[Fault]) -> bool:
        """Whether an explanation is the faulty program itself in other words: it gives the same at other states."""
        batch = sample_states(Robot(self.model), 300, 1).states
        rounding = spread(default_allowance(batch), self.quantities)
        planted = [own for own, _ in faults]
        numbers = [x for _, own in faults for x in own]
        programs = applied(self.base, planted, numbers), applied(self.base, found.hypotheses, found.numbers)
        x, y = (flat(own.evaluate(batch), self.quantities) for own in programs)
        return bool((np.abs(x - y) <= SAME * (rounding + 1e-12 * np.abs(x).max(axis=0))).all())


def names(found: Explanation, faults: Sequence[Fault]) -> bool:
    """Whether an explanation names all faults and nothing else, or what would do the same."""
    planted = [own for own, _ in faults]
    if len(found.hypotheses) != len(planted):
        return False
    slots = [{id(own), *map(id, alike)} for own, alike in zip(found.hypotheses, found.alike, strict=True)]
    return all(any(id(own) in slot for slot in slots) for own in planted)
