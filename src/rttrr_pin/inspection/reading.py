"""What inspection reads of a URDF: numbers as written, lines, shapes; held apart from the model, which has floats."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.solids import Triple, rotation
from rttrr_pin.inspection.exact import (
    Matrix,
    Shape,
    rank_if_positive,
    second_moments,
    shape_of,
    symmetric,
    within_rounding,
)
from rttrr_pin.urdf.checks import INERTIA_ENTRIES
from rttrr_pin.urdf.decimals import Number
from rttrr_pin.urdf.document import parse_xml
from rttrr_pin.urdf.sources import Source

LIMITS = ("lower", "upper", "velocity", "effort")


@dataclass(frozen=True)
class Mass:
    """An <inertial>.

    Attributes:
        line: its line in the file.
        mass: [kg].
        entries: the six entries of the tensor about the centre of mass, by name, in the inertial frame [kg m^2].
        com: from the link's origin to the centre of mass, in the link frame [m].
        rpy: the angles of the inertial frame [rad].
    """

    line: int
    mass: Number
    entries: dict[str, Number]
    com: Triple
    rpy: Triple

    @cached_property
    def exact(self) -> Matrix:
        """The tensor in the inertial frame, in rationals."""
        return symmetric({name: number.exact for name, number in self.entries.items()})

    @cached_property
    def positive(self) -> bool:
        """Whether the tensor is positive semidefinite, exactly."""
        return rank_if_positive(self.exact) is not None

    @cached_property
    def rank(self) -> int | None:
        """The rank of the second moments about the centre of mass; None where they are not positive semidefinite."""
        return rank_if_positive(second_moments(self.exact))

    @property
    def shape(self) -> Shape:
        """What body has this mass and inertia, exactly."""
        return shape_of(self.mass.exact, self.rank)

    @cached_property
    def mended(self) -> dict[str, Fraction] | None:
        """Entries of a tensor that a body can have and that rounds to the ones written, if there is one."""
        return within_rounding(self.entries)

    @cached_property
    def written(self) -> Array:
        """The tensor in the inertial frame, (3, 3) [kg m^2], each entry the nearest float."""
        return np.array(self.exact, dtype=np.float64)

    @cached_property
    def inertia(self) -> Array:
        """The tensor in the axes of the link frame, (3, 3) [kg m^2]."""
        R = rotation(self.rpy)
        return np.asarray(R @ self.written @ R.T) if any(self.rpy) else self.written


@dataclass(frozen=True)
class Geometry:
    """A <visual> or <collision> of a link.

    Attributes:
        role: `"visual"` or `"collision"`.
        kind: `"box"`, `"cylinder"`, `"sphere"`, `"mesh"`, or another tag.
        attributes: of that tag, as written.
        xyz: its origin in the link frame [m].
        rpy: its angles [rad].
    """

    role: str
    kind: str
    attributes: dict[str, str]
    xyz: Triple
    rpy: Triple


@dataclass(frozen=True)
class Body:
    """A link as the file writes it.

    Attributes:
        name: its name.
        line: its line.
        inertial: mass and tensor; None where it has none.
        geometry: what it looks like.
    """

    name: str
    line: int
    inertial: Mass | None
    geometry: tuple[Geometry, ...]


@dataclass(frozen=True)
class Connection:
    """A joint as the file writes it.

    Attributes:
        name: its name.
        line: its line.
        type: URDF's word.
        parent: the link that carries it.
        child: the link that it carries.
        xyz: its origin in the parent frame [m].
        rpy: its angles [rad].
        limit: the attributes of its <limit> that are there; None where there is no <limit>.
        mimics: the joint that it follows, or None.
    """

    name: str
    line: int
    type: str
    parent: str
    child: str
    xyz: Triple
    rpy: Triple
    limit: dict[str, float] | None
    mimics: str | None

    @property
    def moves(self) -> bool:
        """Whether it has a degree of freedom."""
        return self.type != "fixed"


@dataclass(frozen=True)
class Document:
    """A robot as the file writes it.

    Attributes:
        name: the robot's name.
        links: by name, in the order of the file.
        joints: in the order of the file.
    """

    name: str
    links: dict[str, Body]
    joints: tuple[Connection, ...]

    @cached_property
    def carried_by(self) -> dict[str, Connection]:
        """The joint of each link but the root."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def children(self) -> dict[str, tuple[Connection, ...]]:
        """The joints on each link, alphabetically (Pinocchio's order)."""
        found: dict[str, list[Connection]] = {name: [] for name in self.links}
        for joint in self.joints:
            found[joint.parent].append(joint)
        return {name: tuple(sorted(joints, key=lambda joint: joint.name)) for name, joints in found.items()}

    @cached_property
    def root(self) -> str:
        """The link that no joint carries."""
        return next(name for name in self.links if name not in self.carried_by)

    def walk(self) -> Iterator[tuple[int, str]]:
        """Depth and name of each link, parents before children."""
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
                placed[name] = R @ rotation(joint.rpy), p + R @ np.array(joint.xyz)
        return placed


def read_document(text: str, name: str) -> Document:
    """Read the text of a robot that the strict reader has let pass.

    Args:
        text: the URDF.
        name: what to call it in messages.
    """
    root = parse_xml(Source(name, text.encode()))
    return Document(
        name=root.get("name"),
        links={link.get("name"): _body(link) for link in root.findall("link")},
        joints=tuple(_connection(joint) for joint in root.findall("joint")),
    )


def _body(link: Any) -> Body:
    inertial = link.find("inertial")
    shapes = [_geometry(xml) for role in ("visual", "collision") for xml in link.findall(role)]
    return Body(
        name=link.get("name"),
        line=link.sourceline,
        inertial=None if inertial is None else _mass(inertial),
        geometry=tuple(shape for shape in shapes if shape is not None),
    )


def _mass(inertial: Any) -> Mass:
    tensor = inertial.find("inertia")
    xyz, rpy = _placement(inertial)
    return Mass(
        line=inertial.sourceline,
        mass=Number.of(inertial.find("mass").get("value")),
        entries={name: Number.of(tensor.get(name)) for name in INERTIA_ENTRIES},
        com=xyz,
        rpy=rpy,
    )


def _geometry(xml: Any) -> Geometry | None:
    """A shape; None where its element is empty or its placement is no placement, which dynamics do not depend on."""
    tags = [tag for tag in xml.findall("geometry/*") if isinstance(tag.tag, str)]
    if not tags:
        return None
    try:
        xyz, rpy = _placement(xml)
    except ValueError:
        return None
    return Geometry(str(xml.tag), str(tags[0].tag), dict(tags[0].attrib), xyz, rpy)


def _connection(joint: Any) -> Connection:
    xyz, rpy = _placement(joint)
    limit, mimic = joint.find("limit"), joint.find("mimic")
    if joint.get("type") in ("fixed", "floating"):  # there the strict reader lets any text stand
        limit = None
    return Connection(
        name=joint.get("name"),
        line=joint.sourceline,
        type=joint.get("type"),
        parent=joint.find("parent").get("link"),
        child=joint.find("child").get("link"),
        xyz=xyz,
        rpy=rpy,
        limit=None if limit is None else {key: float(limit.get(key)) for key in LIMITS if key in limit.attrib},
        mimics=None if mimic is None else mimic.get("joint"),
    )


def _placement(xml: Any) -> tuple[Triple, Triple]:
    """The numbers of its <origin>, zeros where there is none."""
    origin = xml.find("origin")
    x, y, z = (float(word) for word in _attribute(origin, "xyz").split())
    roll, pitch, yaw = (float(word) for word in _attribute(origin, "rpy").split())
    return (x, y, z), (roll, pitch, yaw)


def _attribute(xml: Any, name: str) -> str:
    return "0 0 0" if xml is None else str(xml.get(name, "0 0 0"))
