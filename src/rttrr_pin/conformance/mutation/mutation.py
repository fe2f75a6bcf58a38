"""The mutation score of a suite of tests: how many of our wrong dynamics of a robot it would let pass, and which."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

from rttrr_pin.conformance.mutation.mutants import SIZE, Mutant, Mutants, mutants
from rttrr_pin.conformance.mutation.suites import Tolerances
from rttrr_pin.core.arguments import whole_number
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot
from rttrr_pin.validation.states import model_of

KINDS = {
    "convention": "conventions: signs, units, order, frames",
    "parameters": "numbers of links and joints",
    "joint": "armature, friction, gears, mimic",
    "mechanics": "terms of the recursion",
}
"""What each kind of hypothesis is called."""


class Suite(Protocol):
    """Tests that see mutants or do not."""

    @property
    def sentence(self) -> str: ...  # noqa: D102
    @property
    def quantities(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def payload(self) -> bool: ...  # noqa: D102

    def sees(self, mutants: Mutants) -> Iterator[bool]:
        """Of each mutant whether a test would fail on it."""
        ...


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class MutationScore(Summarised):
    """How many wrong dynamics of a robot a suite of tests sees.

    Attributes:
        robot: its name.
        suite: what the suite compares, or what was run.
        mutants: wrong dynamics, each of which changes a result by more than rounding.
        passing: those that the suite lets pass, the largest change first.
        equivalent: hypotheses that change no result of this robot, and were not counted.
        alike: hypotheses that give the same results as another, and were not counted either.
        left_out: wrong dynamics that were not drawn, where not all were tried.
        seconds: wall time.
    """

    robot: str
    suite: str
    mutants: tuple[Mutant, ...]
    passing: tuple[Mutant, ...]
    equivalent: int
    alike: int
    left_out: int
    seconds: float

    @property
    def score(self) -> float:
        """The part that the suite sees, from 0 to 1."""
        return 1.0 - len(self.passing) / len(self.mutants)

    @property
    def passed(self) -> bool:
        """Whether it sees all."""
        return not self.passing

    @property
    def kinds(self) -> dict[str, tuple[int, int]]:
        """By kind of hypothesis, how many are seen, of how many."""
        found = {}
        for kind, name in KINDS.items():
            own = [one for one in self.mutants if one.kind == kind]
            if own:
                found[name] = (len(own) - sum(one.kind == kind for one in self.passing), len(own))
        return found

    def summary(self) -> str:
        """The score in one sentence."""
        seen, total = len(self.mutants) - len(self.passing), len(self.mutants)
        return f"SCORE {self.score:.1%}: {seen:,} of {total:,} wrong dynamics of {self.robot} are seen ({self.suite})"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        return finite(
            {
                "schema": 1,
                "passed": self.passed,
                "robot": self.robot,
                "suite": self.suite,
                "score": self.score,
                "mutants": len(self.mutants),
                "kinds": {name: {"seen": seen, "of": total} for name, (seen, total) in self.kinds.items()},
                "passing": [asdict(own) for own in self.passing],
                "equivalent": self.equivalent,
                "alike": self.alike,
                "left_out": self.left_out,
                "seconds": self.seconds,
            }
        )


def mutate(
    robot: Robot,
    suite: Suite = Tolerances(),  # noqa: B008 - frozen
    most: int | None = None,
    size: float = SIZE,
    seed: int = 0,
) -> MutationScore:
    """Find out how many wrong dynamics of a robot a suite of tests would let pass.

    Wrong dynamics are those that `diagnose` names: another sign, unit or order, a number of a link or joint, a term of
    the recursion. Each is in one place, or in the same at every link. Those that change no result of the robot by more
    than rounding are not counted, and of several that give the same results one is.

    Args:
        robot: the robot.
        suite: `Tolerances`, a suite as data; or `PytestSuite`, tests that are run.
        most: how many are tried at most, drawn evenly from the catalogue; None for all.
        size: how far a number that may be any, such as a mass, is from the right one; 1 is where fits begin: twice the
            mass; a tenth is ten percent.
        seed: of the states that tell whether a hypothesis changes anything.

    Raises:
        InputError: an argument cannot be used, or nothing can be wrong with this robot.
        ImplementationError: the suite cannot be run, or fails with right dynamics.
    """
    start = time.perf_counter()
    model_of(robot, "there is nothing that can be wrong")
    if most is not None:
        most = whole_number("most", most, 1, 10**9, "10^9", "--mutants")
    every = mutants(robot, suite.quantities, suite.payload, size, seed)
    chosen = _drawn(every, most)
    if not chosen.found:
        raise InputError(f"no hypothesis changes {', '.join(suite.quantities)} of {robot.name!r}: nothing can be wrong")
    pairs = zip(chosen.found, suite.sees(chosen), strict=True)
    passing = sorted((own for own, seen in pairs if not seen), key=lambda own: -own.relative)
    return MutationScore(
        robot=robot.name,
        suite=suite.sentence,
        mutants=chosen.found,
        passing=tuple(passing),
        equivalent=every.equivalent,
        alike=sum(len(own.others) for own in every.found),
        left_out=len(every.found) - len(chosen.found),
        seconds=time.perf_counter() - start,
    )


def _drawn(every: Mutants, most: int | None) -> Mutants:
    """Some of the mutants, as far from each other in the catalogue as can be."""
    total = len(every.found)
    if most is None or most >= total:
        return every
    rows = [k * total // most for k in range(most)]
    return Mutants(every.robot, every.quantities, tuple(every.found[k] for k in rows), every.equivalent)


def grouped(passing: Sequence[Mutant]) -> list[list[Mutant]]:
    """Mutants of one hypothesis at several places together, in the order of the first of each."""
    found: dict[str, list[Mutant]] = {}
    for own in passing:
        found.setdefault(own.hypothesis, []).append(own)
    return list(found.values())
