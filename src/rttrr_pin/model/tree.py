"""The robot as data: frozen links and joints, in the order in which every array of the package is indexed.

Link i (1-based in prose, i-1 in arrays) is the child of joint i; the root link is no member of `links`, since no
joint carries it and its inertia does not enter the equations of motion.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.errors import InputError, UnknownNameError

Array = NDArray[np.float64]

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""The gravity field [m/s^2] in the base frame that is used unless another is passed (Pinocchio's default)."""


class JointType(enum.StrEnum):
    """How a joint moves; the values are URDF's words."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"

    @property
    def rotates(self) -> bool:
        """Whether the coordinate is an angle [rad]; else, if the joint moves at all, it is a length [m]."""
        return self in (JointType.REVOLUTE, JointType.CONTINUOUS)

    @property
    def unit(self) -> str:
        """The unit of the joint's coordinate."""
        return "rad" if self.rotates else "m"

    @property
    def effort_unit(self) -> str:
        """The unit of the joint's torque or force."""
        return "N m" if self.rotates else "N"


@dataclass(frozen=True, slots=True)
class Limits:
    """What a joint may do; infinite where the file sets no limit.

    Attributes:
        lower: smallest coordinate [rad or m].
        upper: largest coordinate [rad or m].
        velocity: largest rate [rad/s or m/s].
        effort: largest torque or force [N m or N].
    """

    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    effort: float = math.inf


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A rigid body.

    Attributes:
        name: its name in the file.
        mass: [kg]; 0 for a link that is only a frame.
        com: r_C, from the origin of the link frame to the centre of mass, in the link frame, (3,) [m].
        inertia: the tensor about the centre of mass, in the axes of the link frame, (3, 3) [kg m^2], with URDF's
            sign: `inertia[0, 1]` is `ixy`, the paper's J_xy is minus it.
        rotated: whether `inertia` was turned from other axes (a non-zero rpy in the file), so that its entries are
            rounded results and no longer the file's numbers.
    """

    name: str
    mass: float = 0.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))
    rotated: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "com", _frozen(self.com, (3,), f"com of link {self.name!r}"))
        object.__setattr__(self, "inertia", _frozen(self.inertia, (3, 3), f"inertia of link {self.name!r}"))


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A joint, and where it sits on the link that carries it.

    Attributes:
        name: its name in the file.
        type: how it moves.
        parent: index of the parent link in `Model.links`; -1 where the parent is the root link.
        R: R_parent_i at coordinate zero: maps vectors of the joint frame to the parent link frame, (3, 3).
        p: p_parent_i at coordinate zero: from the parent link's origin to the joint's, in the parent frame, (3,) [m].
        axis: the unit vector that the joint turns about or slides along, in {i}, (3,).
        limits: what it may do.
        rotated: whether `R` was computed from a non-zero rpy (else it is exactly the identity).
    """

    name: str
    type: JointType
    parent: int = -1
    R: Array = field(default_factory=lambda: np.eye(3))
    p: Array = field(default_factory=lambda: np.zeros(3))
    axis: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    limits: Limits = Limits()
    rotated: bool = False

    def __post_init__(self) -> None:
        for name, shape in (("R", (3, 3)), ("p", (3,)), ("axis", (3,))):
            object.__setattr__(self, name, _frozen(getattr(self, name), shape, f"{name} of joint {self.name!r}"))
        if self.nv and abs(np.linalg.norm(self.axis) - 1.0) > 1e-9:
            raise InputError(
                f"axis of joint {self.name!r} is {self.axis.tolist()}, of length {np.linalg.norm(self.axis):.6g}; "
                "expected a unit vector: divide it by its length"
            )

    @property
    def nv(self) -> int:
        """The number of its degrees of freedom."""
        return 0 if self.type is JointType.FIXED else 1


@dataclass(frozen=True, eq=False)
class Model:
    """A tree of links and joints; joint i carries link i.

    Attributes:
        name: the robot's name.
        root: the link that carries all others and stands still.
        links: all other links; parents before children, in Pinocchio's order for the same file.
        joints: `joints[i]` carries `links[i]`.
        gravity: the gravity field in the base frame, (3,) [m/s^2]: a free body accelerates by it.
        urdf: the text that the model was read from; empty where it was made from numbers.
    """

    name: str
    root: Link
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    gravity: Array = field(default_factory=lambda: np.array(STANDARD_GRAVITY))
    urdf: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "gravity", _frozen(self.gravity, (3,), "gravity"))
        if len(self.links) != len(self.joints):
            raise InputError(
                f"{len(self.joints)} joints for {len(self.links)} links: expected one joint for each link "
                "but the root, which is passed apart"
            )
        for i, joint in enumerate(self.joints):
            if not -1 <= joint.parent < i:
                raise InputError(
                    f"joint {joint.name!r}, number {i}, names link {joint.parent} as its parent: expected -1 (the "
                    f"root) or a link before it (0 to {i - 1}): list parents before children"
                )

    @cached_property
    def moving(self) -> tuple[Joint, ...]:
        """The joints with a degree of freedom: the last axis of q, v, a and tau."""
        return tuple(joint for joint in self.joints if joint.nv)

    @property
    def nv(self) -> int:
        """The number of degrees of freedom."""
        return len(self.moving)

    @property
    def link_names(self) -> tuple[str, ...]:
        """The names along the links axis of F, N, f, n (the root is not among them)."""
        return tuple(link.name for link in self.links)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The names along the last axis of q, v, a, tau (fixed joints are not among them)."""
        return tuple(joint.name for joint in self.moving)

    def link_index(self, name: str) -> int:
        """The index of a link in `links`.

        Raises:
            UnknownNameError: no link is called so, or it is the root, which no joint carries.
        """
        try:
            return self.link_names.index(name)
        except ValueError:
            fix = f"{name!r} is the root, which no joint carries" if name == self.root.name else ""
            raise UnknownNameError("link", name, self.link_names, fix) from None

    def leaves(self) -> tuple[int, ...]:
        """The links that carry no other."""
        parents = {joint.parent for joint in self.joints}
        return tuple(i for i in range(len(self.links)) if i not in parents)

    def path(self, i: int) -> Iterator[int]:
        """The links from link i inward to the one on the root."""
        while i >= 0:
            yield i
            i = self.joints[i].parent

    def with_gravity(self, gravity: Array) -> Model:
        """The same robot in another gravity field."""
        return replace(self, gravity=gravity)


def _frozen(values: Array, shape: tuple[int, ...], name: str) -> Array:
    """A read-only float64 copy of the wanted shape."""
    array = np.array(values, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise InputError(f"{name} is {np.asarray(values).tolist()}: expected {shape} finite numbers")
    array += 0.0  # -0.0, a by-product of some rotations, becomes 0.0
    array.setflags(write=False)
    return array
