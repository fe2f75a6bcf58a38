"""What a program's way through the levels comes to, as data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from rttrr_pin.conformance.levels import LEVELS
from rttrr_pin.reporting.results import Summarised, counted, finite

BINS = (0.0, *(2.0**k for k in range(11)))
"""Upper ends of the bins of the histograms, in eps: 0, 1, 2, 4, ..., 1024; the last bin is all beyond."""

Outcome = Literal["pass", "fail", "error", "not offered"]


@dataclass(frozen=True, slots=True)
class Value:
    """One number that a program gave.

    Attributes:
        at: name of the link (of the joint for tau).
        state: its index in the case.
        eps: error in eps of the norm of the true vector, which for tau is the n of its joint (the f, where it slides);
            NaN where that is no more than rounding itself.
        of_allowance: the error as a part of what rounding can explain.
        error: the error in the unit of the quantity; infinite for what is no number.
        unit: N or N m.
    """

    at: str
    state: int
    eps: float
    of_allowance: float
    error: float
    unit: str


@dataclass(frozen=True, slots=True)
class QuantityResult:
    """One quantity in one case.

    Attributes:
        quantity: tau, F, N, f or n.
        count: numbers (of vectors their norms) that were compared: each joint or link in each state.
        failures: those that rounding cannot explain.
        not_finite: those of them that are no numbers.
        near_zero: those within rounding of a true value that is no more than rounding itself, so that eps say nothing.
        histogram: how many of the others have an error of up to each of `BINS`, and more.
        median: error in eps; NaN where eps say nothing.
        worst: the number with the largest error / allowance.
        farthest: the number with the largest error in eps; None where eps say nothing.
        digits: the fewest true decimal digits of any number that is more than rounding itself; NaN where there is none.
    """

    quantity: str
    count: int
    failures: int
    not_finite: int
    near_zero: int
    histogram: tuple[int, ...]
    median: float
    worst: Value
    farthest: Value | None
    digits: float


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LevelResult(Summarised):
    """One level, asked with one robot.

    Attributes:
        level: its id.
        robot: its name.
        outcome: "pass"; "fail": numbers that rounding cannot explain; "error": the program failed, and gave none;
            "not offered": it refused.
        n_states: how many states it was asked.
        precision: whose rounding it is judged in, "float64" or "float32"; empty where it gave no numbers.
        quantities: what was seen of each.
        message: why it gave no numbers.
        cause: what it does otherwise, by `diagnose`; empty where that was not asked for.
    """

    level: str
    robot: str
    outcome: Outcome
    n_states: int
    precision: str = ""
    quantities: tuple[QuantityResult, ...] = ()
    message: str = ""
    cause: str = ""

    @property
    def id(self) -> str:
        """Of both, such as `gravity-arm6`."""
        return f"{self.level}-{self.robot}"

    @property
    def passed(self) -> bool:
        """Whether the program gave all that was asked, within rounding."""
        return self.outcome == "pass"

    @property
    def failed(self) -> bool:
        """Whether it gave what rounding cannot explain, or failed."""
        return self.outcome in ("fail", "error")

    @property
    def worst(self) -> tuple[str, Value] | None:
        """The quantity and number with the largest error / allowance; None where there are no numbers."""
        pairs = [(own.quantity, own.worst) for own in self.quantities]
        return max(pairs, key=lambda pair: pair[1].of_allowance) if pairs else None

    @property
    def farthest(self) -> tuple[str, Value] | None:
        """The quantity and number with the largest error in eps; None where eps say nothing."""
        pairs = [(own.quantity, own.farthest) for own in self.quantities if own.farthest is not None]
        return max(pairs, key=lambda pair: pair[1].eps) if pairs else None

    @property
    def digits(self) -> float:
        """The fewest true decimal digits of any number; NaN where there is none to tell."""
        return min((own.digits for own in self.quantities if not math.isnan(own.digits)), default=math.nan)

    def summary(self) -> str:
        """The outcome in one sentence."""
        told = f"{self.outcome.upper()} {self.id}"
        if self.worst is None:
            return f"{told}: {self.message}"
        quantity, value = self.worst
        count = sum(own.failures for own in self.quantities)
        beyond = f"{count:,} of {sum(own.count for own in self.quantities):,} numbers beyond rounding, "
        where = f"{quantity} of {value.at} in state {value.state}"
        part = f"worst {where}, {value.of_allowance:.2g} times what rounding can explain"
        return f"{told}: {beyond if count else ''}{part}{f': {self.cause}' if self.cause else ''}"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        return finite({"schema": 1, "id": self.id, "passed": self.passed} | asdict(self))


@dataclass(frozen=True, slots=True)
class Standing:
    """The levels by their outcome, ids in their order. A level that is asked with several robots has the worst of them.

    Attributes:
        passed: all robots of it that were asked, passed.
        failed: one failed, or the program did.
        not_offered: one was refused, and none failed.
        not_asked: not part of this run.
    """

    passed: tuple[str, ...]
    failed: tuple[str, ...]
    not_offered: tuple[str, ...]
    not_asked: tuple[str, ...]

    @classmethod
    def of(cls, results: Sequence[LevelResult]) -> Standing:
        """That of a run."""
        outcomes: dict[str, set[str]] = {}
        for own in results:
            outcomes.setdefault(own.level, set()).add(own.outcome)
        kinds: dict[str, list[str]] = {"passed": [], "failed": [], "not offered": [], "not asked": []}
        for level in LEVELS:
            seen = outcomes.get(level.id, set())
            kind = "failed" if seen & {"fail", "error"} else "not offered" if "not offered" in seen else "passed"
            kinds[kind if seen else "not asked"].append(level.id)
        return cls(*map(tuple, kinds.values()))

    @property
    def whole(self) -> bool:
        """Whether all levels were passed."""
        return len(self.passed) == len(LEVELS)

    @property
    def reached(self) -> int:
        """The number of the last passed level before which none failed and each was asked; 0 where there is none."""
        reached = 0
        for level in LEVELS:
            if level.id in self.failed or level.id in self.not_asked:
                break
            if level.id in self.passed:
                reached = level.number
        return reached

    def sentence(self, most: int = len(LEVELS)) -> str:
        """What was shown and no more: `14 of 14`; else the level reached, and what was not passed.

        Args:
            most: of more levels that failed, or were not asked, it is said how many they are.
        """
        total = len(LEVELS)
        if self.whole:
            return f"{total} of {total}"
        parts = {"not offered": self.not_offered, "failed": self.failed}
        if 0 < self.reached < total:
            head = f"level {self.reached} of {total} ({LEVELS[self.reached - 1].id})"
            before = {level.id for level in LEVELS[: self.reached]}
            also = tuple(own for own in self.passed if own not in before) if self.not_asked else ()
            parts = {"also passed": also} | parts | {"not asked": self.not_asked}
        else:
            names = f" ({', '.join(self.passed)})" if self.passed and self.not_asked else ""
            head = f"{len(self.passed)} of {total} levels{names}"
        told = {kind: ", ".join(ids) for kind, ids in parts.items() if ids}
        for kind in ("failed", "not asked"):
            if len(parts.get(kind, ())) > most:
                told[kind] = f"{len(parts[kind])} levels"
        return "; ".join([head, *(f"{kind}: {ids}" for kind, ids in told.items())])


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Conformance(Summarised):
    """How far a program gets.

    Attributes:
        subject: name and version of the program.
        results: level by level, robot by robot.
        precision: whose rounding it is judged in, "float64" or "float32".
        printed: the significant digits that it prints, at which it is judged; None where no digit was cut off.
        own_robots: whether it was asked with robots of the user's, and not with those of the levels.
        n_states: states of each case.
        seed: of the states.
        notes: what a reader must know.
        seconds: wall time.
        versions: of what took part.
    """

    subject: str
    results: tuple[LevelResult, ...]
    precision: str
    printed: int | None
    own_robots: bool
    n_states: int
    seed: int
    notes: tuple[str, ...]
    seconds: float
    versions: dict[str, str]

    @property
    def passed(self) -> bool:
        """Whether every level that the program offers was passed."""
        return not any(own.failed for own in self.results)

    @property
    def standing(self) -> Standing:
        """The levels by their outcome."""
        return Standing.of(self.results)

    @property
    def robots(self) -> tuple[str, ...]:
        """The names of the robots, each once."""
        return tuple(dict.fromkeys(own.robot for own in self.results))

    def claim(self, most: int = len(LEVELS)) -> str:
        """What was shown, and no more: `Standing.sentence`, on robots of the user's by name, how precisely, of what."""
        robots = f"{', '.join(self.robots)}: " if self.own_robots else ""
        single = " in float32" if self.precision == "float32" else ""
        printed = "" if self.printed is None else f" at {counted(self.printed, 'digit')}"
        given = {part.quantity for own in self.results for part in own.quantities}
        alone = ", tau alone" if given == {"tau"} and self.standing.passed else ""
        head, mark, rest = self.standing.sentence(most).partition("; ")
        return f"{robots}{head}{single}{printed}{alone}{mark}{rest}"

    def summary(self) -> str:
        """How far the program gets; then a line for each case that was not passed."""
        head = f"{'PASS' if self.passed else 'FAIL'} {self.subject}: {self.claim()}"
        return "\n".join([head, *(own.summary() for own in self.results if not own.passed)])

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        standing = asdict(self.standing) | {"reached": self.standing.reached, "sentence": self.standing.sentence()}
        return finite(
            {
                "schema": 1,
                "passed": self.passed,
                "subject": self.subject,
                "claim": self.claim(),
                "standing": standing,
                "precision": self.precision,
                "printed": self.printed,
                "own_robots": self.own_robots,
                "n_states": self.n_states,
                "seed": self.seed,
                "bins_eps": [*BINS, None],
                "results": [own.to_dict() for own in self.results],
                "notes": list(self.notes),
                "versions": self.versions,
                "seconds": self.seconds,
            }
        )
