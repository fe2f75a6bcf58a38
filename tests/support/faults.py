"""Faulty programs, made from the catalogue of hypotheses and judged on one set of states for each robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.engine.evidence import Evidence, flat, screened, spread
from rttrr_pin.diagnosis.engine.fitting import Explanation
from rttrr_pin.diagnosis.engine.predictions import Raw, applied, predicted, raw_changes
from rttrr_pin.diagnosis.engine.search import Search
from rttrr_pin.diagnosis.run import diagnose
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.implementations import Batch, Evaluation, Implementation, default_allowance, make_implementation
from rttrr_pin.implementations.allowance import of_printed
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
        self.rounding = spread(default_allowance(self.batch), quantities)
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

    @cached_property
    def seen(self) -> list[Hypothesis]:
        """The hypotheses that change a number of the sample by twice what rounding explains, at some numbers."""
        least = 2.0 * self.rounding[screened(self.batch)].ravel()
        return [own for own, change in self.raw if (np.abs(change) > least).any()]

    def visible(self, size: int, rng: np.random.Generator, tries: int = 50) -> list[Fault]:
        """So many different faults, each of which can be seen by itself."""
        faults: list[Fault] = []
        for k in rng.permutation(len(self.seen)).tolist():
            for _ in range(tries):
                fault = self.drawn(self.seen[k], rng)
                change = np.abs(self.values([fault], rng) - self.expected)
                if np.isfinite(change).all() and (change > 2.0 * self.rounding).any():
                    faults.append(fault)
                    break
            if len(faults) == size:
                break
        return faults

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


def clean_results(robot: Robot, states: int, seed: int) -> tuple[int, int]:
    """How many right results were judged, and how many diagnoses called some of them wrong.

    Those of Pinocchio and of the recursion, as they are and printed to six digits.
    """
    judged = false = 0
    for source in ("pinocchio", "recursion"):
        program = make_implementation(source, robot.model)
        for digits in (17, 6):
            result = diagnose(robot, Printed(program, digits), n_states=states, seed=seed)
            judged += result.n_states
            false += not result.passed
    return judged, false


class Printed:
    """A program whose torques are printed, as a table of results is judged."""

    def __init__(self, program: Implementation, digits: int) -> None:
        self.program, self.digits = program, digits
        self.name, self.version, self.quantities = f"{program.name} printed", program.version, ("tau",)

    def evaluate(self, batch: Batch) -> Evaluation:
        """Driving forces; half a unit in the last digit is allowed beside their rounding."""
        result = self.program.evaluate(batch)
        if self.digits >= 17:
            return Evaluation(
                {"tau": result.values["tau"]}, {"tau": result.allowance["tau"]} if result.allowance else None
            )
        texts = [f"{x:.{self.digits - 1}e}" for x in result.values["tau"].ravel()]
        shape = result.values["tau"].shape
        halves = np.array([0.5 * 10.0 ** (int(text.partition("e")[2]) - self.digits + 1) for text in texts])
        return Evaluation(
            {"tau": np.array(texts, float).reshape(shape)}, of_printed(batch, {"tau": halves.reshape(shape)})
        )
