"""A robot as a table of frames, with a number for each symbol: `[[link]]` entries as a model."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np

from rttrr_pin.core.arrays import rotation
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.core.model import STANDARD_GRAVITY, Link, Model
from rttrr_pin.derivation.numbers import exact_number
from rttrr_pin.derivation.symbolic_robot import AXES, Slot
from rttrr_pin.derivation.tables import Table, shown

Number = Callable[[Slot], float]
"""The number that stands in a slot; 0 where the table says nothing."""

ENTRIES: Sequence[tuple[int, int]] = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""Indices in the tensor, in the order of a link's `inertia`: xx, xy, xz, yy, yz, zz."""

LARGEST = 1e100
"""Of any number of a robot: its powers are doubles too."""

MOTIONS = (("revolute", "about"), ("prismatic", "along"))


@dataclass(frozen=True, slots=True)
class WrittenUrdf:
    """The text of a model as a URDF, for Pinocchio, which builds from nothing else."""

    text: str


def link_names(links: Sequence[Table]) -> list[str]:
    """The name of each link; link_1, link_2, ... where the table has none."""
    return [link.get("name", str, f"link_{i + 1}") for i, link in enumerate(links)]


def joint_motion(link: Table) -> tuple[str, tuple[float, ...]]:
    """Type and axis of a joint, from words such as "revolute about z"."""
    words = link.get("joint", str).split()
    if words == ["fixed"]:
        return "fixed", (0.0, 0.0, 0.0)
    if len(words) == 3 and (words[0], words[1]) in MOTIONS and words[2].lstrip("+-") in ("x", "y", "z"):
        sign = -1.0 if words[2].startswith("-") else 1.0
        return words[0], tuple(sign if axis in words[2] else 0.0 for axis in AXES)
    raise link.error(
        f"joint is {shown(link.entries['joint'])}: expected 'revolute about z', 'prismatic along -y', 'fixed', ..."
    )


def model_of(links: Sequence[Table], number: Number, has_gravity: bool) -> Model:
    """The model of a table of frames, from the base outwards; slots have links by their position in the table.

    Raises:
        EquationError: names, parents, joints or masses do not make a robot.
    """
    names = link_names(links)
    number = _finite(links, number)
    bodies, joints = [], []
    for i, link in enumerate(links):
        if names[i] in ("base", *names[:i]):
            raise link.error(f"name is {shown(names[i])}, which another link has: give each its own")
        mass = number(("mass", i))
        if mass < 0:
            raise link.error(f"mass is {mass} with the numbers of the symbols: expected 0 or more")
        parent = link.get("parent", str, names[i - 1] if i else "base")
        if parent not in ("base", *names[:i]):
            raise link.error(f"parent is {shown(parent)}: expected base or a link above: {', '.join(names[:i])}")
        inertia = np.zeros((3, 3))
        for x, y in ENTRIES:
            inertia[x, y] = inertia[y, x] = number(("inertia", i, x, y))
        com = np.array([number(("com", i, x)) for x in range(3)])
        bodies.append(Link(names[i], mass, com, inertia))
        joints.append(_joint(link, i, -1 if parent == "base" else names.index(parent), number))
    gravity = np.array([number(("gravity", x)) for x in range(3)] if has_gravity else STANDARD_GRAVITY)
    urdf = WrittenUrdf(_urdf(bodies, joints, [_angles(link) for link in links]))
    return Model("equations", Link("base"), tuple(bodies), tuple(joints), gravity, urdf)


def _finite(links: Sequence[Table], number: Number) -> Number:
    """The same numbers, refused where they are none that can be computed with."""

    def checked(slot: Slot) -> float:
        value = number(slot)
        if not abs(value) <= LARGEST:
            table = links[int(slot[1])] if slot[0] != "gravity" else links[0]
            raise table.error(f"{slot[0]} is {value} with the numbers of the symbols: expected at most {LARGEST:g}")
        return value

    return checked


def _joint(link: Table, i: int, parent: int, number: Number) -> Joint:
    motion, axis = joint_motion(link)
    turn, p = _angles(link), np.array([number(("origin", i, x)) for x in range(3)])
    R = rotation(turn) if any(turn) else np.eye(3)
    direction = np.array(axis if any(axis) else (1.0, 0.0, 0.0))
    return Joint(f"joint_{i + 1}", JOINT_TYPES[motion], parent, R, p, direction, rotated=any(turn))


def _angles(link: Table) -> tuple[float, ...]:
    """Roll, pitch and yaw of a joint's frame [rad]."""
    angles = []
    for text in link.texts("rpy_degrees", 3, ("0", "0", "0")):
        try:
            numerator, _, denominator = text.partition("/")
            angles.append(math.radians(float(exact_number(numerator) / exact_number(denominator or "1"))))
        except (ArithmeticError, ValueError) as error:
            raise link.error(f"rpy_degrees has {shown(text)}: expected a number of degrees") from error
    return tuple(angles)


def _urdf(links: Sequence[Link], joints: Sequence[Joint], turns: Sequence[Sequence[float]]) -> str:
    """The same robot as the text of a URDF."""

    def row(values: Iterable[float]) -> str:
        return " ".join(repr(float(x)) for x in values)

    parts = ['<robot name="equations"><link name="base"/>']
    for link, joint, turn in zip(links, joints, turns, strict=True):
        tensor = " ".join(f'i{AXES[x]}{AXES[y]}="{float(link.inertia[x, y])!r}"' for x, y in ENTRIES)
        massless = not link.mass and not link.inertia.any()
        body = f'<origin xyz="{row(link.com)}"/><mass value="{link.mass!r}"/><inertia {tensor}/>'
        parts.append(f"<link name={quoteattr(link.name)}>{'' if massless else f'<inertial>{body}</inertial>'}</link>")
        parent = links[joint.parent].name if joint.parent >= 0 else "base"
        moving = f'<axis xyz="{row(joint.axis)}"/><limit lower="-1" upper="1" effort="100" velocity="1"/>'
        parts.append(
            f'<joint name="{joint.name}" type="{joint.type.name}"><origin xyz="{row(joint.p)}" rpy="{row(turn)}"/>'
            f"<parent link={quoteattr(parent)}/><child link={quoteattr(link.name)}/>"
            f"{moving if joint.nv else ''}</joint>"
        )
    return "".join([*parts, "</robot>"])
