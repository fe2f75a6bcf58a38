"""Why a program fails a level: `diagnose` on the case's own states, each kind of failure once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from rttrr_pin.conformance.judging import allowed, answered
from rttrr_pin.conformance.levels import Case
from rttrr_pin.conformance.results import LevelResult
from rttrr_pin.diagnosis.report import told
from rttrr_pin.diagnosis.results import Diagnosis
from rttrr_pin.diagnosis.run import diagnose_at
from rttrr_pin.errors import RttrrError
from rttrr_pin.implementations import Batch, Evaluation, Implementation
from rttrr_pin.implementations.allowance import Precision

LARGEST = 24
"""Links up to which all hypotheses are tried, some hundreds for each; beyond, those that explain failures elsewhere."""

SEARCHED = 2
"""Robots on which all hypotheses were tried in vain, before they are tried on no other."""

UNEXPLAINED = "unexplained"

Failing = tuple[Case, Implementation, LevelResult]


class InPrecision:
    """A program whose allowance is that of the precision it computes in."""

    def __init__(self, program: Implementation, precision: Precision) -> None:
        self.program, self.precision = program, precision
        self.name, self.version, self.quantities = program.name, program.version, program.quantities

    def evaluate(self, batch: Batch) -> Evaluation:
        """The program's numbers."""
        return allowed(batch, answered(self.program, batch), self.precision)


def with_causes(
    failing: Sequence[Failing], precision: Precision, progress: Callable[[], None] | None = None
) -> list[LevelResult]:
    """The outcomes with what the program does otherwise.

    What explains one case is tried first in the next, and only where that does not do, all of the catalogue. So a fault
    that shows in each level is looked for once. On a robot where a failure stayed unexplained there is no further look,
    and on no other robot after `SEARCHED` of them.

    Args:
        failing: case, program, and outcome of each case whose numbers failed.
        precision: that the program is judged in.
        progress: called after each case.
    """
    known, given_up, results = set[str](), set[str](), list[LevelResult]()
    for case, program, result in failing:
        few = len(case.robot.model.links) <= LARGEST
        whole = few and case.name not in given_up and len(given_up) < SEARCHED
        found = _found(case, InPrecision(program, precision), known, whole)
        if isinstance(found, Diagnosis) and found.verdict == "explained":
            known |= {cause.hypothesis for cause in found.causes}
            sentence = "; ".join(map(told, found.causes))
        elif isinstance(found, Diagnosis):
            given_up |= {case.name} if whole else set()
            sentence = "; ".join([UNEXPLAINED, *found.dependence[:1]])
        else:
            sentence = found
        results.append(replace(result, cause=sentence))
        if progress is not None:
            progress()
    return results


def _found(case: Case, program: InPrecision, known: set[str], whole: bool) -> Diagnosis | str:
    """The diagnosis of a case, by what is known or the whole catalogue; or why there is none."""
    try:
        first = diagnose_at(case.batch, program, ids=known) if known else None
        if first is not None and first.verdict == "explained":
            return first
        if not whole:
            return f"{UNEXPLAINED} by what explains other levels; all hypotheses were not tried once more"
        return diagnose_at(case.batch, program)
    except RttrrError as error:
        return f"{UNEXPLAINED}: {error}"
