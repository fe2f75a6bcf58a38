"""Checks of the file itself: one for each kind of fault that its reader logs, and one of blanks.

A fault that a number of the model depends on is an error, and its fix says what was read in its place.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rttrr_pin.inspection.checks import Check, Finding, Observation, Severity, Subject, check
from rttrr_pin.inspection.parser_rules import unparsed_inertial, unparsed_joint
from rttrr_pin.urdf.faults import KINDS, Level

SEVERITIES = {
    "declaration": Severity.NOTE, "comment": Severity.NOTE, "behind": Severity.WARNING, "text": Severity.NOTE,
    "namespace": Severity.NOTE, "xacro": Severity.NOTE, "word": Severity.NOTE, "products": Severity.NOTE,
    "twice": Severity.WARNING, "unused": Severity.WARNING, "unnamed": Severity.WARNING,
    "name": Severity.NOTE, "version": Severity.ERROR,
    "quaternion": Severity.ERROR, "rotations": Severity.ERROR, "number": Severity.ERROR, "mass": Severity.ERROR,
    "inertia": Severity.ERROR, "axis": Severity.ERROR, "direction": Severity.ERROR, "range": Severity.ERROR,
    "limit": Severity.ERROR, "dynamics": Severity.ERROR, "mimic": Severity.ERROR, "joint": Severity.ERROR,
    "tree": Severity.ERROR, "loop": Severity.ERROR, "not-modelled": Severity.WARNING, "transmission": Severity.WARNING,
    "material": Severity.WARNING, "asked": Severity.WARNING,
}  # fmt: skip
"""Of a fault of each kind that no number depends on; the others are errors. Their order is that of the ids."""

HARMLESS = "no number of the model depends on it; mend the file for programs that are stricter"


@dataclass(frozen=True)
class FaultCheck(Check):
    """A check that the reader has made.

    Attributes:
        kind: of the faults that it shows.
    """

    kind: str = ""

    def findings(self, subject: Subject) -> Iterator[Finding]:
        """The faults of the kind."""
        for fault in subject.document.faults:
            if fault.kind == self.kind:
                severity = self.severity if fault.level is Level.NOTE else Severity.ERROR
                fix = f"here read as: {fault.assumed}" if fault.assumed else HARMLESS
                name = fault.name or subject.document.name
                yield Finding(self.id, severity, fault.tag, name, fault.line, None, "", fault.message, fix)


def _nothing(_: Subject) -> Iterator[Observation]:
    return iter(())


FAULT_CHECKS = tuple(
    FaultCheck(f"F6{number:02}", SEVERITIES[kind], KINDS[kind], _nothing, kind)
    for number, kind in enumerate(SEVERITIES, start=1)
)


@check("F632", Severity.WARNING)
def blanks(subject: Subject) -> Iterator[Observation]:
    """Numbers have no blank behind them, and vectors neither tabs nor line ends."""
    fix = "remove tabs, line ends and blanks around numbers; one space stands between two"
    for link, inertial in subject.inertials():
        if dropped := unparsed_inertial(inertial):
            yield Observation(link, None, "", f"urdfdom reads no number where a blank stands behind it: {dropped}", fix)
    for joint in subject.document.joints.values():
        if unparsed_joint(joint):
            reason = "urdfdom refuses the file: a blank stands behind a number, or a tab or line end in a vector"
            yield Observation(joint, None, "", reason, fix)


FILE_CHECKS = (*FAULT_CHECKS, blanks)
