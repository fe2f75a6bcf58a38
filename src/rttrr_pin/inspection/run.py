"""An inspection: the tree, its bodies, the findings, the verdicts."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.inspection import report
from rttrr_pin.inspection.bodies import centre_of_mass, tree
from rttrr_pin.inspection.check import Subject
from rttrr_pin.inspection.parsers import verdicts
from rttrr_pin.inspection.results import Finding, LinkRow, Severity, Verdict
from rttrr_pin.inspection.table import chosen
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.document import UrdfDocument


@dataclass(frozen=True, eq=False)
class Inspection:
    """What there is to say of a robot's file.

    Attributes:
        robot: its name.
        links: the tree, parents before children.
        mass: the sum over all links, the root's among them [kg].
        com: centre of mass of the whole robot in the root's frame, all coordinates zero, (3,) [m]; NaN without mass.
        findings: what is wrong or looks wrong, in the order of the file.
        verdicts: what each parser does with the file.
        text: the file's text.
    """

    robot: str
    links: tuple[LinkRow, ...]
    mass: float
    com: Array
    findings: tuple[Finding, ...]
    verdicts: tuple[Verdict, ...]
    text: str = field(default="", repr=False)

    @cached_property
    def counts(self) -> dict[Severity, int]:
        """How many findings of each severity there are."""
        return {severity: sum(finding.severity is severity for finding in self.findings) for severity in Severity}

    @property
    def passed(self) -> bool:
        """Whether no finding is an error."""
        return self.passes()

    def passes(self, strict: bool = False) -> bool:
        """Whether no finding is an error; with `strict`, none a warning either."""
        return not self.counts[Severity.ERROR] and not (strict and self.counts[Severity.WARNING])

    def verdict(self, parser: str) -> Verdict:
        """The verdict of one parser.

        Raises:
            UnknownNameError: there are no rules of that parser.
        """
        verdicts = {verdict.parser: verdict for verdict in self.verdicts}
        if parser not in verdicts:
            raise UnknownNameError("parser", parser, verdicts)
        return verdicts[parser]

    def summary(self, full: bool = False, width: int = 100) -> str:
        """The inspection as text: links, findings, what each parser does, and PASS or FAIL.

        Args:
            full: whether to show every link and every finding.
            width: characters in a line; columns that do not fit are left out, names never.
        """
        return report.summary(self, full, width)

    def to_dict(self) -> dict[str, Any]:
        """The inspection as data for JSON; units as in the attributes."""
        return report.to_dict(self)


def inspect(
    robot: Robot,
    folder: str | os.PathLike[str] | None = None,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> Inspection:
    """Inspect the file behind a robot: its tree and bodies, what is wrong with it, and what other programs do with it.

    Args:
        robot: a robot that was loaded from a file or a text.
        folder: where to look for meshes from; None is the folder that the file was read from.
        select: prefixes of the ids of the checks to run (see docs/inspect.md); none means all.
        ignore: prefixes of ids to leave out.

    Returns:
        The inspection; masses in kg, lengths in m, inertias in kg m^2.

    Raises:
        InputError: the robot was made from numbers and has no file.
        UnknownNameError: a prefix fits no check.
    """
    checks = chosen(select, ignore)
    document = robot.model.document
    if not isinstance(document, UrdfDocument):
        raise InputError(f"robot {robot.name!r} has no URDF text: inspect looks at files; load the robot from one")
    subject = Subject(document, document.folder if folder is None else Path(folder))
    with np.errstate(all="ignore"):  # 1e308 is a number; what overflows is shown as inf, and no verdict rests on it
        findings = [finding for check in checks for finding in check.findings(subject)]
        links = tuple(tree(document))
        mass = sum(link.mass for link in links)
        return Inspection(
            robot=document.name,
            links=links,
            mass=mass,
            com=centre_of_mass(document, links, mass),
            findings=tuple(sorted(findings, key=lambda finding: (finding.line, finding.id))),
            verdicts=verdicts(document),
            text=document.text,
        )
