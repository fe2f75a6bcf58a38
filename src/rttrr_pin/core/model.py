"""The robot as data: frozen links and joints, in the order in which every array of the package is indexed.

Link i (1-based in prose, i-1 in arrays) is the child of joint i; the root link is no member of `links`, since no
joint carries it and its inertia does not enter the equations of motion.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate
from typing import Protocol

import numpy as np

from rttrr_pin.core.arrays import Array, Rebuilt
from rttrr_pin.core.inputs import real
from rttrr_pin.core.joint import Joint, JointEffects, frozen, named
from rttrr_pin.core.joints import FLOATING
from rttrr_pin.errors import InputError, UnknownNameError, shortened

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""The gravity field [m/s^2] in the base frame that is used unless another is passed (Pinocchio's default)."""


@dataclass(frozen=True, slots=True, eq=False)
class Link(Rebuilt):
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
        named("link", self.name)
        object.__setattr__(self, "com", frozen(self.com, (3,), f"com of link {self.name!r}"))
        object.__setattr__(self, "inertia", frozen(self.inertia, (3, 3), f"inertia of link {self.name!r}"))
        mass = real(f"mass of link {self.name!r}", self.mass)
        if mass.ndim or not math.isfinite(mass):
            raise InputError(f"mass of link {self.name!r} is {self.mass}: expected a finite number")
        object.__setattr__(self, "mass", float(mass))
        if not np.array_equal(self.inertia, self.inertia.T):
            raise InputError(f"inertia of link {self.name!r} is not symmetric: {self.inertia.tolist()}")


class Document(Protocol):
    """A robot's file."""

    @property
    def text(self) -> str:
        """The text of the file."""


@dataclass(frozen=True, slots=True)
class Note:
    """What a user must know of how a robot was read.

    Attributes:
        text: one line.
        left_out: whether the source says, or may say, something that would change tau and takes no part in it.
        friction: whether that is damping and friction, so that nothing need be said where they take part.
    """

    text: str
    left_out: bool = False
    friction: bool = False


ROOT_JOINT, UNIVERSE = "root_joint", "universe"
"""Pinocchio's names for the joint of a floating base, and for what it floats in."""


def unused(name: str, taken: Collection[str]) -> str:
    """A name, with _2, _3, ... behind it where it is taken."""
    numbered = (name, *(f"{name}_{n}" for n in range(2, len(taken) + 3)))
    return next(one for one in numbered if one not in taken)


@dataclass(frozen=True, eq=False, repr=False)
class Model(Rebuilt):
    """A tree of links and joints; joint i carries link i.

    Attributes:
        name: the robot's name.
        root: the link that carries all others and stands still.
        links: all other links; parents before children, in Pinocchio's order for the same file.
        joints: `joints[i]` carries `links[i]`.
        gravity: the gravity field in the base frame, (3,) [m/s^2]: a free body accelerates by it.
        document: the file that the model was read from (`urdf/document.py`); None where it was made from numbers.
        floating: whether `with_floating_base` made it, and its base is not locked.
        notes: what its source says beyond this, or was not asked.
    """

    name: str
    root: Link
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    gravity: Array = field(default_factory=lambda: np.array(STANDARD_GRAVITY))
    document: Document | None = None
    floating: bool = False
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "gravity", frozen(self.gravity, (3,), "gravity"))
        for part, kind in (("links", Link), ("joints", Joint)):
            own = getattr(self, part)
            if not isinstance(own, tuple | list) or not all(isinstance(one, kind) for one in own):
                raise InputError(f"{part} is {shortened(repr(own))}: pass a tuple of {kind.__name__} objects")
            object.__setattr__(self, part, tuple(own))
        if len(self.links) != len(self.joints):
            raise InputError(
                f"{len(self.joints)} joints for {len(self.links)} links: expected one joint for each link "
                "but the root, which is passed apart"
            )
        for element, names in (("link", self.link_names), ("joint", tuple(joint.name for joint in self.joints))):
            twice = [name for name in names if names.count(name) > 1] if len(set(names)) < len(names) else []
            if twice:
                raise InputError(f"{element} {twice[0]!r} stands {names.count(twice[0])} times: give each its own name")
        for i, joint in enumerate(self.joints):
            if not -1 <= joint.parent < i:
                raise InputError(
                    f"joint {joint.name!r}, number {i}, names link {joint.parent} as its parent: expected -1 (the "
                    f"root) or a link before it (0 to {i - 1}): list parents before children"
                )
            if joint.mimic is not None and not (
                0 <= joint.mimic.joint < len(self.joints) and self.joints[joint.mimic.joint].independent
            ):
                raise InputError(
                    f"joint {joint.name!r} follows joint number {joint.mimic.joint}, which does not move by itself: "
                    "name the joint at the end of the chain"
                )

    def __repr__(self) -> str:
        return f"<Model {self.name!r}: {len(self.links)} links, nq {self.nq}, nv {self.nv}>"

    @property
    def urdf(self) -> str:
        """The text that the model was read from; empty where it was made from numbers."""
        return "" if self.document is None else self.document.text

    @cached_property
    def independent(self) -> tuple[int, ...]:
        """Indices of the joints that move and follow no other; q, v, a and tau are made of theirs, in this order."""
        return tuple(i for i, joint in enumerate(self.joints) if joint.independent)

    @cached_property
    def moving(self) -> tuple[Joint, ...]:
        """The joints that move and follow no other."""
        return tuple(self.joints[i] for i in self.independent)

    @property
    def nq(self) -> int:
        """The length of q."""
        return sum(joint.nq for joint in self.moving)

    @property
    def nv(self) -> int:
        """The number of degrees of freedom: the length of v, a, tau."""
        return sum(joint.nv for joint in self.moving)

    @cached_property
    def quaternions(self) -> tuple[int, ...]:
        """Where in q each unit quaternion (x, y, z, w) begins."""
        begins = accumulate((joint.nq for joint in self.moving), initial=0)
        return tuple(at + k for at, joint in zip(begins, self.moving, strict=False) for k in joint.type.quaternions)

    def coordinates_at(self, displacement: Array) -> Array:
        """Coordinates, (N, nq), that a displacement from zero along each degree of freedom, (N, nv), leads to."""
        begins = accumulate((joint.nv for joint in self.moving), initial=0)
        own = [
            x.type.coordinates_at(displacement[:, at : at + x.nv]) for at, x in zip(begins, self.moving, strict=False)
        ]
        return np.hstack([np.zeros((len(displacement), 0)), *own])

    @cached_property
    def link_names(self) -> tuple[str, ...]:
        """The names along the links axis of F, N, f, n (the root is not among them)."""
        return tuple(link.name for link in self.links)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that q, v, a and tau are of (fixed joints, and joints that follow others, are not among them)."""
        return tuple(joint.name for joint in self.moving)

    @cached_property
    def q_names(self) -> tuple[str, ...]:
        """The names along the last axis of q."""
        return tuple(label for joint in self.moving for label in joint.q_labels())

    @cached_property
    def v_names(self) -> tuple[str, ...]:
        """The names along the last axis of v, a and tau."""
        return tuple(label for joint in self.moving for label in joint.v_labels())

    @property
    def rotations(self) -> tuple[bool, ...]:
        """Along the last axis of v, whether each rate is of an angle, so that a moment drives it; else a force does."""
        return tuple(rotation for joint in self.moving for rotation in joint.type.rotations)

    def link_index(self, name: str) -> int:
        """The index of a link in `links`.

        Raises:
            UnknownNameError: no link is called so, or it is the root, which no joint carries.
        """
        if isinstance(name, str) and name in self.link_names:
            return self.link_names.index(name)
        of_root = isinstance(name, str) and name == self.root.name
        fix = f"{name!r} is the root, which no joint carries" if of_root else ""
        raise UnknownNameError("link", name, self.link_names, fix)

    def leaves(self) -> tuple[int, ...]:
        """The links that carry no other."""
        parents = {joint.parent for joint in self.joints}
        return tuple(i for i in range(len(self.links)) if i not in parents)

    def path(self, i: int) -> Iterator[int]:
        """The links from link i inward to the one on the root."""
        while i >= 0:
            yield i
            i = self.joints[i].parent

    def with_floating_base(self) -> Model:
        """The same robot, not bolted down: the root link becomes the first link, on a floating joint of its own.

        The joint is called root_joint, or root_joint_2, ... where the robot has a joint of that name. Its coordinates
        are Pinocchio's: position and quaternion (x, y, z, w) of the root link in the world, its rates the twist in the
        root link's frame, linear before angular.
        """
        base = Joint(unused(ROOT_JOINT, {joint.name for joint in self.joints}), FLOATING)
        moved = [
            replace(
                joint, parent=joint.parent + 1, mimic=joint.mimic and replace(joint.mimic, joint=joint.mimic.joint + 1)
            )
            for joint in self.joints
        ]
        world = Link(UNIVERSE)
        return replace(self, root=world, links=(self.root, *self.links), joints=(base, *moved), floating=True)

    def without_joint_effects(self) -> Model:
        """The same robot, whose joints take no torque themselves."""
        return replace(self, joints=tuple(replace(joint, effects=JointEffects()) for joint in self.joints))

    def without_friction(self) -> Model:
        """The same robot, whose joints take only the torque of their armature."""
        kept = [JointEffects(armature=joint.effects.armature) for joint in self.joints]
        return replace(
            self, joints=tuple(replace(joint, effects=own) for joint, own in zip(self.joints, kept, strict=True))
        )

    def with_gravity(self, gravity: Array) -> Model:
        """The same robot in another gravity field."""
        return replace(self, gravity=gravity)
