"""Which findings of a link are told where several say the same, and how many are errors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from types import ModuleType

import numpy as np

from rttrr_pin.inspection import physics, structure
from rttrr_pin.inspection.checks import Check, Finding, Severity, Subject
from rttrr_pin.inspection.file_faults import FILE_CHECKS, FaultCheck
from rttrr_pin.urdf.document import UrdfDocument

OF_TENSOR = ("P102", "P104", "P105", "G205", "P106", "G201", "G202", "G209", "P108", "P107")
"""Checks of the six numbers of one tensor, the telling ones first."""

OF_LINK = (("P102", "P103", "P110"), ("G205", "G203"), OF_TENSOR)
"""Of each of these groups a link has one finding, the first: no mass, another mass, another tensor than is meant."""

OF_PLACEHOLDER = (*OF_TENSOR, "P103", "P110", "G203", "G204")
"""Of a placeholder there is nothing more to say."""


def checks_of(*modules: ModuleType) -> Iterator[Check]:
    """The checks of modules, in the order of the lines there, which is that of their ids."""
    return (check for module in modules for check in vars(module).values() if isinstance(check, Check))


def told(findings: Iterable[Finding]) -> list[Finding]:
    """Without those of which a telling one of the same group is said of the same link."""
    everything = list(findings)
    ids: dict[str, set[str]] = {finding.name: set() for finding in everything}
    for finding in everything:
        ids[finding.name].add(finding.id)
    placeholders = {finding.name for finding in everything if finding.cause == "placeholder"}

    def covered(finding: Finding) -> bool:
        groups = (OF_PLACEHOLDER,) if finding.name in placeholders else OF_LINK
        before = [group[: group.index(finding.id)] for group in groups if finding.id in group]
        return any(id in ids[finding.name] for group in before for id in group)

    return [finding for finding in everything if not covered(finding)]


def count_errors(document: object) -> int:
    """How many errors `inspect` finds in a robot's file; none where there is no file.

    Meshes are not opened, which can take longer than a comparison of torques: no check that needs them finds errors.
    """
    if not isinstance(document, UrdfDocument):
        return 0
    subject = Subject(document, None)
    checks = (
        check
        for check in (*checks_of(physics, structure), *FILE_CHECKS)
        if check.severity is Severity.ERROR or isinstance(check, FaultCheck)
    )
    with np.errstate(all="ignore"):
        findings = told(finding for check in checks for finding in check.findings(subject))
    return sum(finding.severity is Severity.ERROR for finding in findings)
