"""A URDF as the file writes it: words, lines and tree, read and checked once; all else is computed from this.

The model (`reader.py`), the exact parameters (`exact/parameters.py`) and an inspection are views of a document. Nothing
is converted before it is asked for: a number is a text that becomes a double or a rational.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.urdf.decimals import Number, NumberList
from rttrr_pin.urdf.faults import Fault, Level
from rttrr_pin.urdf.inertial import Placement, UrdfInertial


@dataclass(frozen=True, eq=False)
class UrdfShape:
    """A <visual> or <collision>.

    Attributes:
        role: `"visual"` or `"collision"`.
        tag: `"box"`, `"cylinder"`, `"sphere"`, `"mesh"`, or another.
        attributes: of that element, as written.
        origin: its frame in the link frame.
    """

    role: str
    tag: str
    attributes: dict[str, str]
    origin: Placement


@dataclass(frozen=True, eq=False)
class UrdfLink:
    """A <link>.

    Attributes:
        name: its name.
        line: its line.
        inertial: mass and tensor; None where it has none.
        shapes: what is drawn and what collides.
    """

    name: str
    line: int
    inertial: UrdfInertial | None
    shapes: tuple[UrdfShape, ...]


@dataclass(frozen=True, eq=False)
class UrdfMimic:
    """A <mimic>: coordinate = multiplier times that of `joint`, plus offset."""

    joint: str
    multiplier: Number
    offset: Number


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A <joint>.

    Attributes:
        name: its name.
        line: its line.
        type: URDF's word.
        parent: the link that carries it.
        child: the link that it carries.
        origin: its frame in the parent link's.
        axis: the vector that it turns about or slides along, of any length; 1 0 0 where none is written.
        limit: the attributes of its <limit> that are there; None where there is no <limit>.
        mimic: the joint that it follows, and how.
        damping: viscous friction; 0 where none is written.
        friction: Coulomb friction; 0 where none is written.
    """

    name: str
    line: int
    type: str
    parent: str
    child: str
    origin: Placement
    axis: NumberList
    limit: dict[str, Number] | None
    mimic: UrdfMimic | None
    damping: Number
    friction: Number

    @property
    def moves(self) -> bool:
        """Whether it has a degree of freedom."""
        return JOINT_TYPES[self.type].nv > 0

    @cached_property
    def limits(self) -> dict[str, float]:
        """The numbers of its <limit> that are there; none where there is no <limit>."""
        return {key: float(number) for key, number in (self.limit or {}).items()}


@dataclass(frozen=True, slots=True)
class UrdfTransmission:
    """A <transmission>.

    Attributes:
        name: its name.
        line: its line.
        type: what kind it is; empty where the file does not say.
        joint: that it drives; empty where none is named.
        actuator: that drives it; empty where none is named.
    """

    name: str
    line: int
    type: str
    joint: str
    actuator: str


@dataclass(frozen=True, eq=False)
class UrdfDocument:
    """A robot as the file writes it.

    Attributes:
        source: what to call the file in messages.
        text: of the robot as it was read, for other programs: the file's, or what was assumed written out.
        file_text: the file's text.
        folder: where the file lies, to find meshes from; None for a text.
        name: the robot's name.
        version: of the format, such as (1, 0).
        names_version: whether the file says it.
        links: by name, in the order of the file.
        joints: by name, in the order of the file.
        transmissions: in the order of the file.
        faults: what is wrong with the file.
        packages: folders of packages that meshes are named by.
        made_from: the class of the object that the text was written from; empty where there is a file.
    """

    source: str
    text: str
    file_text: str
    folder: Path | None
    name: str
    version: tuple[int, int]
    names_version: bool
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]
    transmissions: tuple[UrdfTransmission, ...] = ()
    faults: tuple[Fault, ...] = ()
    packages: Mapping[str, Path] = field(default_factory=dict)
    made_from: str = ""

    @property
    def remarks(self) -> tuple[Fault, ...]:
        """What a user of the model must know: what was assumed, and what is not modelled."""
        return tuple(fault for fault in self.faults if fault.level is not Level.NOTE or fault.kind == "not-modelled")

    def followed(
        self, joint: UrdfJoint, exact: Callable[[Number], Fraction]
    ) -> tuple[UrdfJoint, Fraction, Fraction, int]:
        """Whom a joint follows in the end, with what multiplier and offset, and through how many mimics."""
        multiplier, offset, mimics = Fraction(1), Fraction(0), 0  # exact, so that a chain is rounded once
        while joint.moves and (mimic := joint.mimic) is not None:
            offset += multiplier * exact(mimic.offset)
            multiplier *= exact(mimic.multiplier)
            mimics += 1
            joint = self.joints[mimic.joint]
        return joint, multiplier, offset, mimics

    @cached_property
    def carried_by(self) -> dict[str, UrdfJoint]:
        """The joint of each link but the root."""
        return {joint.child: joint for joint in self.joints.values()}

    @cached_property
    def children(self) -> dict[str, tuple[UrdfJoint, ...]]:
        """The joints on each link, alphabetically."""
        on_link: dict[str, list[UrdfJoint]] = {name: [] for name in self.links}
        for name in sorted(self.joints):
            on_link[self.joints[name].parent].append(self.joints[name])
        return {name: tuple(joints) for name, joints in on_link.items()}

    @cached_property
    def root(self) -> str:
        """The link that no joint carries."""
        return next(name for name in self.links if name not in self.carried_by)

    def walk(self) -> Iterator[tuple[int, str]]:
        """Depth and name of each link in Pinocchio's order: depth first, joints alphabetically at each branch."""
        waiting = [(0, self.root)]
        while waiting:
            depth, name = waiting.pop()
            yield depth, name
            waiting += [(depth + 1, joint.child) for joint in reversed(self.children[name])]

    @cached_property
    def placements(self) -> dict[str, tuple[Array, Array]]:
        """Rotation and origin of each link in the root's frame, all coordinates zero."""
        placed = {self.root: (np.eye(3), np.zeros(3))}
        for _, name in self.walk():
            if name != self.root:
                joint = self.carried_by[name]
                R, p = placed[joint.parent]
                placed[name] = R @ joint.origin.R, p + R @ joint.origin.p
        return placed
