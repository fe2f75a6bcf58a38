"""What a diagnosis comes to, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from rttrr_pin.reporting.results import Summarised, finite

Verdict = Literal["agrees", "explained", "unexplained"]


@dataclass(frozen=True, slots=True)
class Cause:
    """One thing that a program does otherwise.

    Attributes:
        hypothesis: what it is called in the catalogue, such as "gravity missing".
        sentence: what the program does.
        repair: what to do about it.
        program: which program does it.
        link: the link it is about; None where it is about none, or about all.
        joint: the joint, likewise.
        values: the numbers that were fitted, beside those of the robot's file.
        equation: of the paper, where the error is in one; else empty.
        line: the line of the recursion or of the robot's file to look at; else empty.
        alternatives: causes that would give the same results, in each of the states.
    """

    hypothesis: str
    sentence: str
    repair: str
    program: str
    link: str | None = None
    joint: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    equation: str = ""
    line: str = ""
    alternatives: tuple[Cause, ...] = ()


@dataclass(frozen=True, slots=True)
class Residual:
    """The differences at one joint or link, before and after the causes are taken into account.

    Attributes:
        quantity: tau, F, N, f or n.
        at: the joint or link.
        unit: of the quantity.
        size: root mean square of what is expected there.
        before: largest difference, in that unit.
        after: the same with the causes; where there are none, as before.
        of_tolerance_before: largest difference over what rounding and printing explain.
        of_tolerance_after: the same with the causes.
    """

    quantity: str
    at: str
    unit: str
    size: float
    before: float
    after: float
    of_tolerance_before: float
    of_tolerance_after: float


@dataclass(frozen=True, slots=True)
class NearMiss:
    """A hypothesis that explains a part of the difference.

    Attributes:
        sentence: what it says.
        explains: the part of the difference, root mean square, each joint on its own scale; 1 is all.
    """

    sentence: str
    explains: float


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Diagnosis(Summarised):
    """Why a program differs from a reference.

    Attributes:
        robot: its name.
        subject: name and version of the program.
        reference: name and version of what it is compared with.
        verdict: "agrees" where all differences are rounding; "explained" where causes bring them down to that; else
            "unexplained".
        causes: the smallest set.
        others: other sets, as small, that explain these states as well; at most ten.
        residuals: by quantity and joint or link.
        residual_before: the largest difference over what rounding and printing explain.
        residual_after: the same with the causes.
        dependence: sentences, what the difference depends on; where it is unexplained.
        near_misses: what comes nearest, best first; where it is unexplained.
        counterexample: a test to paste, of a state as simple as could be found; empty where there is none.
        n_states: how many states were compared.
        sampling: "telling", "table" or "given".
        tried: how many hypotheses were.
        notes: what a reader must know.
        seconds: wall time.
    """

    robot: str
    subject: str
    reference: str
    verdict: Verdict
    causes: tuple[Cause, ...]
    others: tuple[tuple[Cause, ...], ...]
    residuals: tuple[Residual, ...]
    residual_before: float
    residual_after: float
    dependence: tuple[str, ...]
    near_misses: tuple[NearMiss, ...]
    counterexample: str
    n_states: int
    sampling: str
    tried: int
    notes: tuple[str, ...]
    seconds: float

    @property
    def passed(self) -> bool:
        """Whether the program agrees."""
        return self.verdict == "agrees"

    def summary(self) -> str:
        """The verdict; then a line for each cause."""
        compared = f"{self.subject} against {self.reference} on {self.n_states:,} states of {self.robot}"
        if self.passed:
            return f"AGREES {compared}: all differences are rounding"
        if self.verdict == "unexplained":
            return f"UNEXPLAINED {compared}: no set of up to four causes explains the difference"
        return "\n".join([f"EXPLAINED {compared}:", *(cause.sentence for cause in self.causes)])

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        return finite({"schema": 1, "passed": self.passed} | asdict(self))
