"""Joints that hold nothing: a place and a unit quaternion, as Pinocchio's free-flyer has them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rttrr_pin.core.algebra import Scalar, SinCos, Vector, quaternion_rotation
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dual import Dual
from rttrr_pin.core.joints.base import Body, Coordinate, JointMotion, JointState, JointType

PLACE = tuple(Coordinate("m", name) for name in ("x", "y", "z"))


class Floating(JointType):
    """A place and a unit quaternion (x, y, z, w); the rates are the twist in {i}, linear before angular."""

    name = "floating"
    coordinates = PLACE + tuple(Coordinate("", name) for name in ("qx", "qy", "qz", "qw"))
    rates = PLACE + tuple(Coordinate("rad", name) for name in ("rx", "ry", "rz"))
    quaternions = (3,)

    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """R = R_0 R(quaternion), p = p_0 + R_0 (x, y, z)."""
        q, v, a = state.q, state.v, state.a
        return JointMotion(
            R=body.R @ quaternion_rotation(*q[3:]),
            p=body.p + body.R @ Vector(*q[:3]),
            w=Vector(*v[3:]),
            w_dot=Vector(*a[3:]),
            v=Vector(*v[:3]),
            v_dot=Vector(*a[:3]),
        )

    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """All of f and n."""
        return [*f, *n]

    def tangent(self, q: Sequence[Scalar], first: int, sincos: SinCos) -> list[Dual]:
        """The derivatives p' = R v and (x, y, z, w)' = (x, y, z, w) (w_x, w_y, w_z, 0) / 2."""
        k = first
        x, y, z, w = q[3:]
        R = quaternion_rotation(x, y, z, w)
        position = [Dual(p, {k + i: r for i, r in enumerate(row)}) for p, row in zip(q[:3], R.rows, strict=True)]
        turns = ((w, -z, y), (z, w, -x), (-y, x, w), (-x, -y, -z))
        quaternion = [
            Dual(c, {k + 3 + i: t * 0.5 for i, t in enumerate(turn)})
            for c, turn in zip((x, y, z, w), turns, strict=True)
        ]
        return position + quaternion

    def gyroscopic(self, v: Sequence[Scalar], p: Sequence[Scalar]) -> Sequence[Scalar]:
        """Kirchhoff's terms: force w x P, moment w x L + v x P."""
        linear, w, P, L = Vector(*v[:3]), Vector(*v[3:]), Vector(*p[:3]), Vector(*p[3:])
        return [*w.cross(P), *(w.cross(L) + linear.cross(P))]

    def coordinates_at(self, displacement: Array) -> Array:
        """The place as it is, and the unit quaternion of the rotation vector behind it [rad]."""
        turn = displacement[:, 3:]
        half = np.linalg.norm(turn, axis=1, keepdims=True) / 2
        quaternion = np.hstack([turn / 2 * np.sinc(half / np.pi), np.cos(half)])
        return np.hstack([displacement[:, :3], quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)])
