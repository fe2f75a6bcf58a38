"""Joints that do not move."""

from __future__ import annotations

from dataclasses import replace

from rttrr_pin.core.algebra import Scalar, SinCos, Vector
from rttrr_pin.core.inertia import NO_TENSOR, NOWHERE, SpatialInertia
from rttrr_pin.core.joints.base import Body, JointMotion, JointState, JointType


class Fixed(JointType):
    """The link is one body with the link that carries it."""

    name = "fixed"
    coordinates = rates = ()

    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """R = R_0, p = p_0."""
        return JointMotion(R=body.R, p=body.p)

    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """Nothing is driven."""
        return []

    def origin_shift(self, axis: Vector, offset: Vector) -> Vector:
        """Anywhere."""
        return offset

    def regrouped(self, body: Body, first_moment: bool) -> tuple[Body, SpatialInertia]:
        """All of it may move."""
        return replace(body, M=0.0, r_C=NOWHERE, I=NO_TENSOR), SpatialInertia.of(body.M, body.r_C, body.I)
