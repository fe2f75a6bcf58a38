"""What an inspection is made of: links, findings, and the verdicts of parsers."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.exact import Shape


class Severity(enum.StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Behaviour(enum.StrEnum):
    """What a parser does with a file, from best to worst."""

    ACCEPT = "accept"
    WARN = "warn"
    ALTER = "alter"
    EITHER = "either"
    REFUSE = "refuse"


MEANING = {
    Behaviour.ACCEPT: "loads the robot as written",
    Behaviour.WARN: "loads the robot as written, and prints a warning",
    Behaviour.ALTER: "loads another robot than the one written",
    Behaviour.EITHER: "the parser's version, or its own rounding, decides",
    Behaviour.REFUSE: "does not load the file",
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
class RuleMatch:
    """A rule of a parser that applies.

    Attributes:
        rule: the rule's id.
        behaviour: what the parser does.
        name: the link or joint.
        reason: the rule in a sentence.
        source: where the parser's source says so.
    """

    rule: str
    behaviour: Behaviour
    name: str
    reason: str
    source: str


@dataclass(frozen=True)
class Verdict:
    """What one parser does with the file.

    Attributes:
        parser: its name.
        behaviour: the worst of what its rules say.
        matches: the rules that apply, and where.
    """

    parser: str
    behaviour: Behaviour
    matches: tuple[RuleMatch, ...]
