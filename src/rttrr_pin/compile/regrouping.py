"""Inertia that can be moved from link to link without a change of any driving force.

Where only driving forces are asked for, single links do not matter, and three things make the program shorter:

- A link on a fixed joint is one body with the link that carries it.
- About a revolute joint with axis u, the link's first moment along u and a tensor d (1 - u u^T) may as well belong
  to the link that carries it: what they describe lies on the axis and does not turn (the base parameters of Gautier
  and Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", 1990).
- Along a prismatic joint the link turns as its carrier does: the whole tensor about its centre of mass may move.

Inertias are added up as mass, first moment and tensor about a common origin, in the robot's own numbers: floats, or
such that know their error (`ConstantWithError`), so that moving inertia counts in the kernel's bounds like any other
rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rttrr_pin.compile.constants import exactly
from rttrr_pin.core.algebra import IDENTITY, Matrix, Vector
from rttrr_pin.core.joint import JointType
from rttrr_pin.core.joint_motion import Body
from rttrr_pin.core.model import Model

NOWHERE = Vector(0.0, 0.0, 0.0)

NOTHING = Matrix((NOWHERE, NOWHERE, NOWHERE))


@dataclass(frozen=True, slots=True, eq=False)
class Inertia:
    """Mass, first moment and tensor about the origin, in one frame; they add up.

    Attributes:
        m: mass [kg].
        h: first moment, mass times centre of mass [kg m].
        J: tensor about the origin [kg m^2].
    """

    m: float
    h: Vector
    J: Matrix

    @classmethod
    def of(cls, body: Body) -> Inertia:
        """That of a link (parallel axes)."""
        return cls(body.M, body.r_C * body.M, body.I + _around(body.r_C) * body.M)

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(self.m + other.m, self.h + other.h, self.J + other.J)

    def __sub__(self, other: Inertia) -> Inertia:
        return Inertia(self.m - other.m, self.h - other.h, self.J - other.J)

    def seen_from(self, R: Matrix, p: Vector) -> Inertia:
        """The same body in a frame in which this one stands at p, turned by R."""
        h, J = R @ self.h, R @ self.J @ R.T
        shift = IDENTITY * (h.dot(p) * 2) - Matrix.outer(h, p) - Matrix.outer(p, h) + _around(p) * self.m
        return Inertia(self.m, h + p * self.m, J + shift)

    def about_com(self) -> tuple[Vector, Matrix]:
        """The centre of mass, and the tensor about it; those of the origin where there is no mass."""
        if self.m == 0.0:
            return NOWHERE, self.J
        com = Vector(*(x / self.m for x in self.h))
        return com, self.J - _around(com) * self.m

    def as_body(self, body: Body) -> Body:
        """The link with this inertia."""
        com, tensor = self.about_com()
        return replace(body, M=self.m, r_C=com, I=(tensor + tensor.T) * 0.5)


def regroup(model: Model, links: Sequence[Body]) -> tuple[Model, list[Body]]:
    """The robot with the same driving forces at every motion, and fewer numbers that are not zero.

    Args:
        model: the robot.
        links: its links and joints, as scalars that are floats.

    Returns:
        As many links and joints, in the same order: the tree, in which no joint stands on a fixed one, and its links,
        which single are no longer those of the file. The numbers in the model are, and are not to be used.
    """
    model, bodies = _carried_by_moving_links(model, list(links))
    for i in reversed(range(len(bodies))):
        parent = model.joints[i].parent
        carrier = bodies[parent] if parent >= 0 else None
        moved = _movable(bodies[i], carrier)
        if moved is None:
            continue
        R, p = bodies[i].R, bodies[i].p
        bodies[i] = _without(bodies[i], moved)
        if carrier is not None:
            bodies[parent] = (Inertia.of(carrier) + moved.seen_from(R, p)).as_body(carrier)
    return model, bodies


def _carried_by_moving_links(model: Model, bodies: list[Body]) -> tuple[Model, list[Body]]:
    """Joints on fixed links moved to the links that carry those, with their inertia."""
    joints = list(model.joints)
    for i, joint in enumerate(joints):
        at, body = joint.parent, bodies[i]
        if at >= 0 and joints[at].type is JointType.FIXED:
            R, p = bodies[at].R, bodies[at].p
            joints[i] = replace(joint, parent=joints[at].parent)
            bodies[i] = replace(body, R=R @ body.R, p=p + R @ body.p)
    for i in reversed(range(len(joints))):
        parent, body = joints[i].parent, bodies[i]
        if body.type is JointType.FIXED and (body.M != 0.0 or not _zero(body.I)):
            if parent >= 0:
                seen = Inertia.of(body).seen_from(body.R, body.p)
                bodies[parent] = (Inertia.of(bodies[parent]) + seen).as_body(bodies[parent])
            bodies[i] = replace(body, M=0.0, r_C=NOWHERE, I=NOTHING)
    return replace(model, joints=tuple(joints)), bodies


LIGHT = 1 / 16
"""A carrier with less than this of the link's mass keeps its first moment: divided by so small a mass, another's would
put its centre of mass far away, where its tensor drowns; without mass it has none."""


def _movable(body: Body, carrier: Body | None) -> Inertia | None:
    """What of a link's inertia may belong to its carrier; None for the root, which keeps nothing."""
    if body.type is JointType.PRISMATIC:
        return Inertia(0.0, NOWHERE, body.I)
    if not body.type.rotates or body.M == 0.0:
        return None
    u = body.axis
    distance = u.dot(body.r_C)
    on_axis = all(exactly(x, 0.0) for x in body.r_C - u * distance)
    heavy = carrier is None or on_axis or carrier.M >= LIGHT * body.M
    along = u * (distance * body.M) if heavy else NOWHERE
    centred = Inertia.of(body) - Inertia(0.0, along, NOTHING)
    k = _across(u)
    tensor = centred.J if on_axis else centred.about_com()[1]
    d = _entry(tensor, k) / (1.0 - [*u][k] * [*u][k])
    return Inertia(body.M if on_axis else 0.0, along, (IDENTITY - Matrix.outer(u, u)) * d)


def _without(body: Body, moved: Inertia) -> Body:
    """What is left of a link; what was to become zero is zero and no rounding."""
    if body.type is JointType.PRISMATIC:
        return replace(body, I=NOTHING)
    rest = (Inertia.of(body) - moved).as_body(body)
    k = _across(body.axis)
    rows = [[*row] for row in rest.I.rows]
    rows[k][k] = 0.0
    com = [*rest.r_C]
    if any(moved.h) and _along_one(body.axis):
        com = [0.0 if x != 0.0 else y for x, y in zip(body.axis, com, strict=True)]
    a, b, c = (Vector(*row) for row in rows)
    return replace(rest, r_C=Vector(*com), I=Matrix((a, b, c)))


def _along_one(u: Vector) -> bool:
    """Whether an axis is a coordinate axis."""
    return sum(not exactly(x, 0.0) for x in u) == 1


def _across(u: Vector) -> int:
    """The coordinate axis that is most across an axis: its entry in the tensor is to become zero."""
    return min(range(3), key=lambda k: abs([*u][k]))


def _entry(tensor: Matrix, k: int) -> float:
    """An entry of the diagonal."""
    entry: float = [*tensor.rows[k]][k]
    return entry


def _around(r: Vector) -> Matrix:
    """The tensor about the origin of a mass of 1 kg at r: r^2 1 - r r^T."""
    tensor: Matrix = IDENTITY * r.dot(r) - Matrix.outer(r, r)
    return tensor


def _zero(tensor: Matrix) -> bool:
    return not any(x != 0.0 for row in tensor.rows for x in row)
