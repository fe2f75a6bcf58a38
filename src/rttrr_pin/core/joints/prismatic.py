"""Joints that slide along an axis."""

from __future__ import annotations

from dataclasses import replace

from rttrr_pin.core.algebra import Scalar, SinCos, Vector
from rttrr_pin.core.inertia import NO_TENSOR, SpatialInertia
from rttrr_pin.core.joints.base import Body, Coordinate, JointMotion, JointState, JointType


class Prismatic(JointType):
    """A slide by the length q along the axis u of {i}."""

    name = "prismatic"
    coordinates = rates = (Coordinate("m"),)
    has_axis = True
    limits = "required"

    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """P = p_0 + R_0 u q, v = u v."""
        u, (q,), (v,), (a,) = body.axis, state.q, state.v, state.a
        return JointMotion(R=body.R, p=body.p + body.R @ (u * q), v=u * v, v_dot=u * a)

    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """The force along the axis, u . f."""
        return [body.axis.dot(f)]

    def origin_shift(self, axis: Vector, offset: Vector) -> Vector:
        """Anywhere."""
        return offset

    def regrouped(self, body: Body, first_moment: bool) -> tuple[Body, SpatialInertia]:
        """The link turns as its carrier does: the whole tensor about its centre of mass may move."""
        return replace(body, I=NO_TENSOR), SpatialInertia(J=body.I)
