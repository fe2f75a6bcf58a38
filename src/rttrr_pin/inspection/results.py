"""What an inspection finds, as data."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from functools import cached_property

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.exact import Shape


class Severity(enum.StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Does(enum.StrEnum):
    """What a consumer does with a file, from best to worst."""

    ACCEPT = "accept"
    WARN = "warn"
    ALTER = "alter"
    EITHER = "either"
    REFUSE = "refuse"


MEANING = {
    Does.ACCEPT: "loads the robot as written",
    Does.WARN: "loads the robot as written, and prints a warning",
    Does.ALTER: "loads another robot than the one written",
    Does.EITHER: "the consumer's version, or its own rounding, decides",
    Does.REFUSE: "does not load the file",
}


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


@dataclass(frozen=True, eq=False)
class LinkRow:
    """A link of the tree and the body that it is.

    Attributes:
        name: its name.
        depth: joints between it and the root.
        joint: the joint that carries it; empty for the root.
        joint_type: URDF's word for it.
        mass: [kg]; 0 for a link without <inertial>.
        com: centre of mass in the link frame, (3,) [m].
        shape: what body has such an inertia, decided exactly.
        moments: principal moments of inertia, ascending, (3,) [kg m^2].
        axes: the principal axes as columns, in the link frame, right-handed, (3, 3).
        semi_axes: of the homogeneous ellipsoid with this mass and inertia, along `axes`, (3,) [m]; NaN where no body
            has them.
        gyration: radii of gyration sqrt(moment / mass), (3,) [m]; NaN where there is no mass.
    """

    name: str
    depth: int
    joint: str
    joint_type: str
    mass: float
    com: Array
    shape: Shape
    moments: Array
    axes: Array
    semi_axes: Array
    gyration: Array


@dataclass(frozen=True)
class Hit:
    """A rule of a consumer that applies.

    Attributes:
        rule: the rule's id.
        does: what the consumer does.
        name: the link or joint.
        reason: the rule in a sentence.
        source: where the consumer says so.
    """

    rule: str
    does: Does
    name: str
    reason: str
    source: str


@dataclass(frozen=True)
class Verdict:
    """What one consumer does with the file.

    Attributes:
        consumer: its name.
        does: the worst of what its rules say.
        hits: the rules that apply, and where.
    """

    consumer: str
    does: Does
    hits: tuple[Hit, ...]


@dataclass(frozen=True, eq=False)
class Inspection:
    """A robot's file, looked at.

    Attributes:
        robot: its name.
        links: the tree, parents before children.
        mass: the sum over all links, the root's among them [kg].
        com: centre of mass of the whole robot in the root's frame, all coordinates zero, (3,) [m]; NaN without mass.
        findings: what was found, in the order of the file.
        verdicts: what each consumer does with the file.
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
        return {severity: sum(found.severity is severity for found in self.findings) for severity in Severity}

    def passes(self, strict: bool = False) -> bool:
        """Whether there is no error; with `strict`, no warning either."""
        return not self.counts[Severity.ERROR] and not (strict and self.counts[Severity.WARNING])

    def verdict(self, consumer: str) -> Verdict:
        """The verdict of one consumer.

        Raises:
            UnknownNameError: there are no rules of that consumer.
        """
        from rttrr_pin.errors import UnknownNameError

        for verdict in self.verdicts:
            if verdict.consumer == consumer:
                return verdict
        raise UnknownNameError("consumer", consumer, [verdict.consumer for verdict in self.verdicts])
