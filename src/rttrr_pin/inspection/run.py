"""An inspection: the tree, its bodies, the findings, the verdicts; and the repairs that are certain."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any
from xml.parsers import expat

import numpy as np

from rttrr_pin.core.arguments import names_of, path_of
from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.inspection import physics, plausibility, report, structure
from rttrr_pin.inspection.bodies import LinkRow, centre_of_mass, tree
from rttrr_pin.inspection.cases import cases
from rttrr_pin.inspection.causes import cause_of
from rttrr_pin.inspection.checks import Check, Edit, Finding, Severity, Subject
from rttrr_pin.inspection.file_faults import FILE_CHECKS
from rttrr_pin.inspection.merged import merged_links
from rttrr_pin.inspection.parsers import Verdict, verdicts
from rttrr_pin.inspection.telling import OF_PLACEHOLDER, OF_TENSOR, checks_of, told
from rttrr_pin.reporting.results import counted, finite
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.parser import read_document

if TYPE_CHECKING:
    from rttrr_pin.robot import Robot

CHECKS = (*checks_of(physics, plausibility, structure), *FILE_CHECKS)
"""All checks, in the order of their modules and of the lines there, which is that of their ids."""


@dataclass(frozen=True, eq=False, repr=False)
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
        document: the file as it was read.
    """

    robot: str
    links: tuple[LinkRow, ...]
    mass: float
    com: Array
    findings: tuple[Finding, ...]
    verdicts: tuple[Verdict, ...]
    text: str = field(default="", repr=False)
    document: UrdfDocument | None = field(default=None, repr=False)

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
        return finite(report.to_dict(self))

    def __repr__(self) -> str:
        found = ", ".join(counted(count, severity) for severity, count in self.counts.items())
        return f"<Inspection of {self.robot!r}: {found}>"


def inspect(
    robot: Robot | str | os.PathLike[str],
    folder: str | os.PathLike[str] | None = None,
    select: str | Iterable[str] = (),
    ignore: str | Iterable[str] = (),
) -> Inspection:
    """Inspect the file behind a robot: its tree and bodies, what is wrong with it, and what other programs do with it.

    Args:
        robot: a robot that was loaded from a file or a text; or a source of one, as `load` takes it, which is
            inspected as far as it goes also where `load` refuses it. Of a robot that was loaded from an object, the
            text that was written from it, `robot.model.urdf`, is inspected.
        folder: where to look for meshes from; None is the folder that the file was read from.
        select: prefixes of the ids of the checks to run (see docs/inspect.md); none means all.
        ignore: prefixes of ids to leave out.

    Returns:
        The inspection; masses in kg, lengths in m, inertias in kg m^2.

    Raises:
        InputError: the robot was made from numbers and has no file.
        UnknownNameError: a prefix fits no check; or there is no such file.
        UrdfError: the file is no URDF at all.
    """
    if isinstance(robot, str | os.PathLike):
        return inspect_document(read_document(robot, tolerant=True), folder, select, ignore)
    from rttrr_pin.robot import model_of  # of a file alone, no robot is made

    document = model_of(robot).document
    if not isinstance(document, UrdfDocument):
        raise InputError(f"robot {robot.name!r} has no URDF text: inspect looks at files; load the robot from one")
    return inspect_document(document, folder, select, ignore)


def inspect_document(
    document: UrdfDocument,
    folder: str | os.PathLike[str] | None = None,
    select: str | Iterable[str] = (),
    ignore: str | Iterable[str] = (),
) -> Inspection:
    """The same of a file that was read, without the robot that it describes."""
    checks = chosen(names_of("select", select), names_of("ignore", ignore))
    subject = Subject(document, document.folder if folder is None else path_of("folder", folder))
    with np.errstate(all="ignore"):  # 1e308 is a number; what overflows is shown as inf, and no verdict rests on it
        findings = told(_explained(subject, finding) for check in checks for finding in check.findings(subject))
        links = tuple(tree(document))
        mass = sum(link.mass for link in links)
        return Inspection(
            robot=document.name,
            links=links,
            mass=mass,
            com=centre_of_mass(document, links, mass),
            findings=tuple(sorted(findings, key=lambda finding: (finding.line, finding.id))),
            verdicts=verdicts(document),
            text=document.file_text,
            document=document,
        )


SMALL_SHARE = 0.01
"""Of a body, what hardly changes a torque."""


def _explained(subject: Subject, finding: Finding) -> Finding:
    """With the cause of a tensor's finding, where there is one."""
    case = cases(subject).get(finding.name) if finding.id in OF_TENSOR else None
    cause = None if case is None else cause_of(case)
    if cause is not None:
        repair, reason = cause.repair or finding.repair, f"{finding.reason}; {cause.sentence}"
        finding = replace(finding, reason=reason, cause=cause.name, repair=repair)
    if finding.severity is Severity.WARNING and finding.id in OF_PLACEHOLDER and _negligible(subject, finding.name):
        finding = replace(finding, severity=Severity.NOTE)
    return finding


def _negligible(subject: Subject, name: str) -> bool:
    """Whether mass and tensor of a link are a small share of those of the body that it is fixed to."""
    inertial = subject.document.links[name].inertial
    body = next(body for body in merged_links(subject.document).values() if name in body.members)
    return inertial is not None and bool(
        0.0 < float(inertial.mass) < SMALL_SHARE * body.mass
        and np.abs(inertial.tensor).max() < SMALL_SHARE * np.trace(body.inertia)
    )


def chosen(select: tuple[str, ...], ignore: tuple[str, ...]) -> list[Check]:
    """The checks whose ids begin with one of the prefixes `select`, if there are any, and with none of `ignore`."""
    for prefix in (*select, *ignore):
        if not prefix or not any(check.id.startswith(prefix) for check in CHECKS):
            raise UnknownNameError("check", prefix, [check.id for check in CHECKS])
    left = [check for check in CHECKS if check.id.startswith(select or "") and not check.id.startswith(ignore)]
    if not left:
        raise InputError(f"no check is left to run: {', '.join(ignore)} leaves out all that was selected")
    return left


@dataclass(frozen=True)
class Repaired:
    """A repaired file.

    Attributes:
        text: its text.
        done: the findings that were mended.
        left: the findings that were not.
    """

    text: str
    done: tuple[Finding, ...]
    left: tuple[Finding, ...]


def repair(inspection: Inspection) -> Repaired:
    """Make all repairs that are certain, in the file's own text: only values change, every other byte stays.

    A link with more than one finding is left alone: its numbers have no one certain meaning.
    """
    repairs: dict[str, set[tuple[Edit, ...]]] = {}
    for finding in inspection.findings:
        if finding.repair:
            repairs.setdefault(finding.name, set()).add(finding.repair)
    done = [finding for finding in inspection.findings if finding.repair and len(repairs[finding.name]) == 1]
    return Repaired(
        text=_edited(inspection.text, [edit for finding in done for edit in finding.repair]),
        done=tuple(done),
        left=tuple(finding for finding in inspection.findings if finding not in done),
    )


def _edited(text: str, edits: Iterable[Edit]) -> str:
    """The text of a URDF with new values of attributes that are there."""
    whole = text.encode()
    for start, link, tag in reversed(_inertial_tags(whole)):  # from the end, so that the places before stay
        for edit in edits:
            if (edit.link, edit.tag) == (link, tag):
                whole = whole[:start] + _replaced(whole[start:], edit)
    return whole.decode()


def _replaced(tail: bytes, edit: Edit) -> bytes:
    """The text from a tag on, with one attribute of that tag changed; its quotation marks stay."""
    pattern = rf"(\s{edit.attribute}\s*=\s*)(\"[^\"]*\"|'[^']*')".encode()
    return re.sub(pattern, lambda match: match[1] + match[2][:1] + edit.text.encode() + match[2][-1:], tail, count=1)


def _inertial_tags(text: bytes) -> list[tuple[int, str, str]]:
    """The tags inside the <inertial> of each link: where each begins, in bytes (lxml knows lines only), link, tag."""
    tags, path, link = list[tuple[int, str, str]](), list[str](), ""
    parser = expat.ParserCreate("utf-8")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal link
        if path == ["robot"] and tag == "link":
            link = attributes.get("name", "")
        if path == ["robot", "link", "inertial"]:
            tags.append((parser.CurrentByteIndex, link, tag))
        path.append(tag)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: path.pop()
    parser.Parse(text, True)
    return tags
