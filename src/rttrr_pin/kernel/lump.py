"""Inertia that can be moved from link to link without a change of any driving force.

Where only driving forces are asked for, single links do not matter, and three things make the program shorter:

- A link on a fixed joint is one body with the link that carries it.
- About a revolute joint with axis u, the link's first moment along u and a tensor d (1 - u u^T) may as well belong
  to the link that carries it: what they describe lies on the axis and does not turn (the base parameters of Gautier
  and Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", 1990).
- Along a prismatic joint the link turns as its carrier does: the whole tensor about its centre of mass may move.

Inertias are added up as mass, first moment and tensor about a common origin, in float64.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.model import Joint, JointType, Link, Model

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Inertia:
    """Mass, first moment and tensor about the origin, in one frame; they add up.

    Attributes:
        m: mass [kg].
        h: first moment, mass times centre of mass, (3,) [kg m].
        J: tensor about the origin, (3, 3) [kg m^2].
    """

    m: float
    h: Array
    J: Array

    @classmethod
    def of(cls, link: Link) -> Inertia:
        """That of a link (parallel axes)."""
        return cls(link.mass, link.mass * link.com, link.inertia + link.mass * _around(link.com))

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(self.m + other.m, self.h + other.h, self.J + other.J)

    def __sub__(self, other: Inertia) -> Inertia:
        return Inertia(self.m - other.m, self.h - other.h, self.J - other.J)

    def seen_from(self, R: Array, p: Array) -> Inertia:
        """The same body in a frame in which this one stands at p, turned by R."""
        h, J = R @ self.h, R @ self.J @ R.T
        shift = np.dot(h, p) * 2 * np.eye(3) - np.outer(h, p) - np.outer(p, h) + self.m * _around(p)
        return Inertia(self.m, h + self.m * p, J + shift)

    def as_link(self, link: Link) -> Link:
        """The link with this inertia, about the centre of mass again."""
        if self.m == 0.0:
            return replace(link, mass=0.0, com=np.zeros(3), inertia=_symmetric(self.J))
        com = self.h / self.m
        return replace(link, mass=self.m, com=com, inertia=_symmetric(self.J - self.m * _around(com)))


def lump(model: Model) -> Model:
    """The robot with the same driving forces at every motion, and fewer numbers that are not zero.

    Args:
        model: the robot.

    Returns:
        A robot with as many links and joints, in the same order. Its single links are no longer those of the file.
    """
    model = _carried_by_moving_links(model)
    links = list(model.links)
    for i in reversed(range(len(links))):
        joint = model.joints[i]
        carrier = links[joint.parent] if joint.parent >= 0 else None
        moved = _movable(joint, links[i], carrier)
        if moved is None:
            continue
        links[i] = _without(links[i], moved, joint)
        if carrier is not None:
            links[joint.parent] = (Inertia.of(carrier) + moved.seen_from(joint.R, joint.p)).as_link(carrier)
    return replace(model, links=tuple(links))


def _carried_by_moving_links(model: Model) -> Model:
    """Joints on fixed links moved to the links that carry those, with their inertia."""
    joints, links = list(model.joints), list(model.links)
    for i, joint in enumerate(joints):
        parent = joints[joint.parent] if joint.parent >= 0 else None
        if parent is not None and parent.type is JointType.FIXED:
            joints[i] = replace(
                joint, parent=parent.parent, R=parent.R @ joint.R, p=parent.p + parent.R @ joint.p, rotated=True
            )
    for i in reversed(range(len(joints))):
        joint = joints[i]
        if joint.type is JointType.FIXED and (links[i].mass != 0.0 or links[i].inertia.any()):
            inertia = Inertia.of(links[i]).seen_from(joint.R, joint.p)
            if joint.parent >= 0:
                links[joint.parent] = (Inertia.of(links[joint.parent]) + inertia).as_link(links[joint.parent])
            links[i] = replace(links[i], mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))
    return replace(model, joints=tuple(joints), links=tuple(links))


LIGHT = 1 / 16
"""A carrier with less than this of the link's mass keeps its first moment: divided by so small a mass, another's would
put its centre of mass far away, where its tensor drowns; without mass it has none."""


def _movable(joint: Joint, link: Link, carrier: Link | None) -> Inertia | None:
    """What of a link's inertia may belong to its carrier; None for the root, which keeps nothing."""
    if joint.type is JointType.PRISMATIC:
        return Inertia(0.0, np.zeros(3), link.inertia)
    if not joint.type.rotates or link.mass == 0.0:
        return None
    u = joint.axis
    on_axis = not (link.com - float(u @ link.com) * u).any()
    heavy = carrier is None or on_axis or carrier.mass >= LIGHT * link.mass
    along = float(u @ link.com) * link.mass * u if heavy else np.zeros(3)
    centred = Inertia.of(link) - Inertia(0.0, along, np.zeros((3, 3)))
    k = int(np.argmin(np.abs(u)))  # the entry to become zero
    tensor = centred.J if on_axis else _about_com(centred)
    d = tensor[k, k] / (1.0 - u[k] ** 2)
    return Inertia(link.mass if on_axis else 0.0, along, d * (np.eye(3) - np.outer(u, u)))


def _about_com(inertia: Inertia) -> Array:
    com = inertia.h / inertia.m
    tensor: Array = inertia.J - inertia.m * _around(com)
    return tensor


def _without(link: Link, moved: Inertia, joint: Joint) -> Link:
    """What is left of a link; what was to become zero is zero and no rounding."""
    rest = (Inertia.of(link) - moved).as_link(link)
    if joint.type is JointType.PRISMATIC:
        return replace(link, inertia=np.zeros((3, 3)))
    k = int(np.argmin(np.abs(joint.axis)))
    inertia, com = rest.inertia.copy(), rest.com.copy()
    inertia[k, k] = 0.0
    if moved.h.any() and np.count_nonzero(joint.axis) == 1:
        com[np.argmax(np.abs(joint.axis))] = 0.0
    return replace(rest, inertia=inertia, com=com)


def _around(r: Array) -> Array:
    """The tensor about the origin of a mass of 1 kg at r: r^2 1 - r r^T."""
    tensor: Array = np.dot(r, r) * np.eye(3) - np.outer(r, r)
    return tensor


def _symmetric(tensor: Array) -> Array:
    return (tensor + tensor.T) / 2
