"""Joints that slide in the x y plane of their frame at zero and turn about z."""

from __future__ import annotations

from collections.abc import Sequence

from rttrr_pin.core.algebra import Scalar, SinCos, Vector, rotation
from rttrr_pin.core.dual import Dual
from rttrr_pin.core.joints.base import Body, Coordinate, JointMotion, JointState, JointType


class Planar(JointType):
    """A place (x, y) in the plane and an angle theta about z; the rates are a twist in {i}, as Pinocchio has it."""

    name = "planar"
    coordinates = rates = (Coordinate("m", "x"), Coordinate("m", "y"), Coordinate("rad", "theta"))
    axis_direction = (0.0, 0.0, 1.0)

    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """R = R_0 R(z, theta), p = p_0 + R_0 (x, y, 0)."""
        (x, y, theta), (v_x, v_y, w_z), (a_x, a_y, w_dot_z) = state.q, state.v, state.a
        return JointMotion(
            R=body.R @ rotation(body.axis, theta, sincos),
            p=body.p + body.R @ Vector(x, y, 0),
            w=Vector(0, 0, w_z),
            w_dot=Vector(0, 0, w_dot_z),
            v=Vector(v_x, v_y, 0),
            v_dot=Vector(a_x, a_y, 0),
        )

    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """The force in the plane and the moment about z."""
        return [f.x, f.y, n.z]

    def tangent(self, q: Sequence[Scalar], first: int, sincos: SinCos) -> list[Dual]:
        """The derivatives x' = c v_x - s v_y, y' = s v_x + c v_y, theta' = w_z."""
        x, y, theta = q
        k = first
        s, c = sincos(theta)
        return [Dual(x, {k: c, k + 1: -s}), Dual(y, {k: s, k + 1: c}), Dual(theta, {k + 2: 1.0})]

    def gyroscopic(self, v: Sequence[Scalar], p: Sequence[Scalar]) -> Sequence[Scalar]:
        """Kirchhoff's terms in the plane: w x P, and the z component of v x P."""
        (v_x, v_y, w_z), (P_x, P_y, _) = v, p
        return [-(w_z * P_y), w_z * P_x, v_x * P_y - v_y * P_x]
