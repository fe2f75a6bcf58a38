"""Joints that turn about an axis: revolute ones, and continuous ones, whose angle has no limits."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

from rttrr_pin.core.algebra import IDENTITY, Matrix, Scalar, SinCos, Vector, rotation
from rttrr_pin.core.inertia import NOWHERE, SpatialInertia, is_zero
from rttrr_pin.core.joints.base import Body, Coordinate, JointMotion, JointState, JointType, Limited


class Revolute(JointType):
    """A turn by the angle q about the axis u of {i}."""

    name = "revolute"
    coordinates = rates = (Coordinate("rad"),)
    has_axis = True
    limits: ClassVar[Limited] = "required"

    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """R = R_0 R(u, q), w = u v."""
        u, (q,), (v,), (a,) = body.axis, state.q, state.v, state.a
        return JointMotion(R=body.R @ rotation(u, q, sincos), p=body.p, w=u * v, w_dot=u * a)

    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """The moment about the axis, u . n."""
        return [body.axis.dot(n)]

    def origin_shift(self, axis: Vector, offset: Vector) -> Vector:
        """Along the axis."""
        return axis * offset.x

    def regrouped(self, body: Body, first_moment: bool) -> tuple[Body, SpatialInertia] | None:
        """The first moment along u and a tensor d (1 - u u^T) may move: what they describe lies on the axis.

        With them goes the mass of a link whose centre of mass is on the axis. The base parameters of Gautier and
        Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", 1990.
        """
        if body.M == 0.0:
            return None
        u, whole = body.axis, SpatialInertia.of(body.M, body.r_C, body.I)
        distance = u.dot(body.r_C)
        on_axis = all(is_zero(x) for x in body.r_C - u * distance)
        along = u * (distance * body.M) if first_moment else NOWHERE
        if on_axis and not first_moment:
            on_axis = False
        centred = whole - SpatialInertia(h=along)
        tensor = centred.J if on_axis else centred.about_com()[1]
        k = min(range(3), key=lambda k: abs([*u][k]))  # most across the axis: this entry becomes zero
        d = [*tensor.rows[k]][k] / (1.0 - [*u][k] * [*u][k])
        moved = SpatialInertia(body.M if on_axis else 0.0, along, (IDENTITY - Matrix.outer(u, u)) * d)
        return _without(body, whole - moved, k, any(along)), moved


def _without(body: Body, rest: SpatialInertia, k: int, first_moment: bool) -> Body:
    """The link with the rest of its inertia; what was to become zero is zero, and no rounding."""
    com, tensor = rest.about_com()
    rows = [[*row] for row in ((tensor + tensor.T) * 0.5).rows]
    rows[k][k] = 0.0
    if first_moment and sum(not is_zero(x) for x in body.axis) == 1:  # along a coordinate axis
        com = Vector(*(0.0 if x != 0.0 else y for x, y in zip(body.axis, com, strict=True)))
    a, b, c = (Vector(*row) for row in rows)
    return replace(body, M=rest.m, r_C=com, I=Matrix((a, b, c)))


class Continuous(Revolute):
    """A revolute joint that may turn without end."""

    name = "continuous"
    limits = "none"
