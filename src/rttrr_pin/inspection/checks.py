"""What a check is: an id, a severity, a statement, and a function that looks for places where that does not hold."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint, UrdfLink
from rttrr_pin.urdf.inertial import UrdfInertial

if TYPE_CHECKING:
    from rttrr_pin.inspection.shapes import Looks


class Severity(enum.StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Edit:
    """A new value for an attribute of a link's <inertia> or <mass>.

    Attributes:
        link: the link.
        tag: `"inertia"` or `"mass"`.
        attribute: such as `"ixx"`.
        text: the new value.
    """

    link: str
    tag: str
    attribute: str
    text: str


@dataclass(frozen=True)
class Finding:
    """Something that is wrong, or looks wrong, or is worth knowing.

    Attributes:
        id: the check's stable id, such as `"P105"`.
        severity: how bad it is.
        kind: `"link"` or `"joint"`, or `"robot"`.
        name: the link's or joint's name.
        line: its line in the file.
        value: the number that was judged; None where there is none.
        unit: its unit; empty for a ratio.
        reason: what is wrong with it.
        fix: what to do about it.
        repair: the edits that mend it, where they are certain.
        cause: the reading of the numbers that explains it, in one word such as `"decimal"`; empty where none is known.
    """

    id: str
    severity: Severity
    kind: str
    name: str
    line: int
    value: float | None
    unit: str
    reason: str
    fix: str
    repair: tuple[Edit, ...] = ()
    cause: str = ""


@dataclass(frozen=True, eq=False)
class Subject:
    """What checks look at.

    Attributes:
        document: the file.
        folder: where the file lies, to find meshes from; None where it is a text.
    """

    document: UrdfDocument
    folder: Path | None
    _looks: dict[str, Looks] = field(default_factory=dict)

    def looks(self, link: UrdfLink) -> Looks:
        """The geometry of a link, loaded once."""
        from rttrr_pin.inspection.shapes import looks_of  # what counts errors alone does without

        if link.name not in self._looks:
            self._looks[link.name] = looks_of(link, self.folder, self.document.packages)
        return self._looks[link.name]

    def inertials(self) -> Iterator[tuple[UrdfLink, UrdfInertial]]:
        """The links that have an <inertial>."""
        return ((link, link.inertial) for link in self.document.links.values() if link.inertial is not None)


@dataclass(frozen=True)
class Observation:
    """What the function of a check saw at one place; the check adds its id and severity."""

    at: UrdfLink | UrdfJoint | UrdfDocument
    value: float | None
    unit: str
    reason: str
    fix: str
    repair: tuple[Edit, ...] = ()
    cause: str = ""


KINDS = {UrdfLink: "link", UrdfJoint: "joint", UrdfDocument: "robot"}


@dataclass(frozen=True)
class Check:
    """A check.

    Attributes:
        id: stable; its letter is the kind of check: P physics, G geometry, T mirrored links, J joints, C conventions.
        severity: of its findings.
        statement: what holds for a file that passes.
        find: what looks for places where it does not.
    """

    id: str
    severity: Severity
    statement: str
    find: Callable[[Subject], Iterator[Observation]]

    def findings(self, subject: Subject) -> Iterator[Finding]:
        """The check's findings in a file."""
        for seen in self.find(subject):
            line = 0 if isinstance(seen.at, UrdfDocument) else seen.at.line
            yield Finding(
                self.id, self.severity, KINDS[type(seen.at)], seen.at.name, line,
                seen.value, seen.unit, seen.reason, seen.fix, seen.repair, seen.cause,
            )  # fmt: skip


def check(id: str, severity: Severity) -> Callable[[Callable[[Subject], Iterator[Observation]]], Check]:
    """Makes a check of a function, whose docstring is the statement."""
    return lambda find: Check(id, severity, find.__doc__ or "", find)
