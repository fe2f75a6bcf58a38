"""What a rule of a parser is: what it does with something in a file, where its source says so, and the places.

"Alter" means that the parser's robot has other masses, inertias, degrees of freedom or limits than the file's.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from rttrr_pin.inspection import parser_rules as rules
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint
from rttrr_pin.urdf.faults import Fault
from rttrr_pin.urdf.inertial import UrdfInertial

Places = Callable[[UrdfDocument], Iterable[str]]


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


@dataclass(frozen=True)
class Rule:
    """What a parser does with something in a file.

    Attributes:
        id: stable, such as `"mujoco-triangle"`.
        parsers: those that have the rule.
        behaviour: what they do then.
        reason: the rule in a sentence.
        source: file and function of the parser that says so.
        places: the links or joints where it applies.
        at_worst: what they do at worst, where `behaviour` is "either".
    """

    id: str
    parsers: tuple[str, ...]
    behaviour: Behaviour
    reason: str
    source: str
    places: Places
    at_worst: Behaviour = Behaviour.REFUSE


PINOCCHIO, MUJOCO, DRAKE, GAZEBO, KDL, YOURDFPY = PARSERS = (
    "Pinocchio",
    "MuJoCo",
    "Drake",
    "Gazebo",
    "KDL",
    "yourdfpy",
)

URDFDOM = (PINOCCHIO, GAZEBO, KDL)
"""They parse with urdfdom."""


def joints(holds: Callable[[UrdfJoint], object]) -> Places:
    """The joints of which something holds."""
    return lambda document: (joint.name for joint in document.joints.values() if holds(joint))


def inertials(holds: Callable[[UrdfInertial], object], moving: bool = False) -> Places:
    """The links of whose <inertial> something holds; with `moving`, none that belongs to the world."""
    return lambda document: (name for name, inertial in rules.inertials(document, moving) if holds(inertial))


def faults(kind: str, holds: Callable[[Fault], object] = lambda fault: True) -> Places:
    """The links or joints with such a fault, or the robot."""
    return lambda document: (
        fault.name or document.name for fault in document.faults if fault.kind == kind and holds(fault)
    )


def where(test: Callable[[UrdfDocument], Iterator[tuple[str, str]]], outcome: str) -> Places:
    """The links of which a test comes out so."""
    return lambda document: (name for name, came_out in test(document) if came_out == outcome)
