"""A robot as joints that move and the bodies they carry: what fixed joints hold together is one body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint, Mimic
from rttrr_pin.core.model import Link, Model
from rttrr_pin.inspection.merged import MergedLink


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A frame in another one: R maps its vectors to the other, p is its origin there [m]."""

    R: Array
    p: Array

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(self.R @ other.R, self.R @ other.p + self.p)

    @property
    def inverse(self) -> Pose:
        """The other frame in this one."""
        return Pose(self.R.T, -self.R.T @ self.p)


AT_ORIGIN = Pose(np.eye(3), np.zeros(3))


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """A link of a body, and where its frame is in that of the body."""

    link: Link
    pose: Pose = AT_ORIGIN

    @property
    def inertia(self) -> MergedLink:
        """In the frame of the body."""
        return inertia_of(self.link).moved(self.pose.R, self.pose.p)

    @property
    def massive(self) -> bool:
        """Whether it has any inertia."""
        return self.link.mass != 0.0 or bool(self.link.inertia.any())


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A joint that moves, and what it carries.

    Attributes:
        joint: with its mimic's leader as an index among the bodies.
        parent: the body that carries the joint; -1 is the base.
        pose: the joint's frame in that of the parent, at zero.
        members: the link of the joint, and all that is fixed to it.
    """

    joint: Joint
    parent: int
    pose: Pose
    members: tuple[Member, ...]

    @property
    def name(self) -> str:
        """Of the link that the joint carries."""
        return self.members[0].link.name

    @property
    def inertia(self) -> MergedLink:
        """Of all members, in the joint's frame."""
        return total(self.members)


@dataclass(frozen=True, slots=True, eq=False)
class RigidTree:
    """Bodies, parents before children, on a base that stands still."""

    name: str
    base: tuple[Member, ...]
    bodies: tuple[Body, ...]
    gravity: Array

    @classmethod
    def of(cls, model: Model) -> RigidTree:
        """The tree of a model."""
        moving = [i for i, joint in enumerate(model.joints) if joint.nv]
        number = {i: k for k, i in enumerate(moving)}
        places: list[tuple[int, Pose]] = []  # by link, the body it belongs to, and where it is in it
        members: dict[int, list[Member]] = {-1: [Member(model.root)]}
        bodies = []
        for i, (joint, link) in enumerate(zip(model.joints, model.links, strict=True)):
            own, pose = (-1, AT_ORIGIN) if joint.parent < 0 else places[joint.parent]
            pose = pose @ Pose(joint.R, joint.p)
            if not joint.nv:
                members[own].append(Member(link, pose))
                places.append((own, pose))
                continue
            members[number[i]] = [Member(link)]
            places.append((number[i], AT_ORIGIN))
            mimic = joint.mimic and replace(joint.mimic, joint=number[joint.mimic.joint])
            bodies.append(Body(replace(joint, mimic=mimic), own, pose, ()))
        whole = [replace(body, members=tuple(members[k])) for k, body in enumerate(bodies)]
        return cls(model.name, tuple(members[-1]), tuple(whole), model.gravity)

    @property
    def model(self) -> Model:
        """The robot with one link for each body."""
        links, joints = [], []
        for body in self.bodies:
            links.append(link_of(body.name, body.inertia))
            joints.append(replace(body.joint, parent=body.parent, R=body.pose.R, p=body.pose.p, lock=None))
        return Model(self.name, Link(self.base[0].link.name), tuple(links), tuple(joints), self.gravity)

    def changed(self, k: int, **numbers: Any) -> RigidTree:
        """The tree with another body k."""
        bodies = list(self.bodies)
        bodies[k] = replace(bodies[k], **numbers)
        return replace(self, bodies=tuple(bodies))

    def changed_joint(self, k: int, **numbers: Any) -> RigidTree:
        """The tree with other numbers of joint k."""
        return self.changed(k, joint=replace(self.bodies[k].joint, **numbers))

    def following(self, k: int, mimic: Mimic | None) -> RigidTree:
        """The tree whose joint k follows another, which moves by itself then, or none; what followed k goes on to."""
        tree = self.changed_joint(k, mimic=mimic)
        if mimic is not None:
            tree = tree.changed_joint(mimic.joint, mimic=None)
            for j, body in enumerate(tree.bodies):
                own = body.joint.mimic
                if own is not None and own.joint == k:
                    m, offset = own.multiplier * mimic.multiplier, own.multiplier * mimic.offset + own.offset
                    tree = tree.changed_joint(j, mimic=replace(own, joint=mimic.joint, multiplier=m, offset=offset))
        return tree

    def changed_link(self, k: int, name: str, pose: Pose | None = None, **numbers: Any) -> RigidTree:
        """The tree with other numbers of a link of body k."""
        members = [
            replace(own, link=replace(own.link, **numbers), pose=own.pose if pose is None else pose)
            if own.link.name == name
            else own
            for own in self.bodies[k].members
        ]
        return self.changed(k, members=tuple(members))

    @property
    def length(self) -> float:
        """The largest distance between joints, a measure of the robot's size [m]."""
        distances = [float(np.linalg.norm(body.pose.p)) for body in self.bodies]
        centres = [float(np.linalg.norm(own.link.com)) for body in self.bodies for own in body.members]
        return max([*distances, *centres], default=0.0)


def inertia_of(link: Link) -> MergedLink:
    """The inertia of one link, in its frame."""
    return MergedLink((link.name,), link.mass, link.mass * link.com, link.inertia)


def total(members: tuple[Member, ...]) -> MergedLink:
    """All together, in the frame of the body."""
    if not members:
        return MergedLink((), 0.0, np.zeros(3), np.zeros((3, 3)))
    return reduce(MergedLink.__add__, (own.inertia for own in members))


def link_of(name: str, inertia: MergedLink) -> Link:
    """A link of that inertia."""
    com = inertia.moment / inertia.mass if inertia.mass else np.zeros(3)
    return Link(name, inertia.mass, com, (inertia.inertia + inertia.inertia.T) / 2)
