"""Which parameters the driving forces are linear in, and which of them motion can tell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.inertia import SpatialInertia
from rttrr_pin.core.inputs import Coordinates
from rttrr_pin.core.joint import EFFECTS
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.robot.dynamics import Dynamics

if TYPE_CHECKING:
    from rttrr_pin.core.identification import BaseParameters


class Identification(Dynamics):
    """The regressor, and its parameters."""

    def regressor(self, q: Coordinates, v: Coordinates, a: Coordinates, joint_effects: bool = False) -> Array:
        """Y(q, v, a), (..., nv, 10 links), by which the driving forces are linear: tau - tau_joint = Y pi.

        pi is `inertial_parameters()`: of each link m, m c_x, m c_y, m c_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz with the
        tensor about the origin of {i} (Pinocchio's order). Fixed links have columns of their own. With `joint_effects`
        three columns follow for each joint that moves, those that follow others included: a, v and sign(v), which its
        armature, damping and Coulomb friction multiply; then tau = Y pi.
        """
        Y = cast("Array", self._kernel("regressor")(q, v, a))
        if not joint_effects:
            return Y
        return np.concatenate([Y, cast("Array", self._kernel("joint_regressor")(q, v, a))], axis=-1)

    def inertial_parameters(self, joint_effects: bool = False) -> Array:
        """The parameters that `regressor` multiplies, ten for each link, and three for each joint that moves."""
        parameters: list[Any] = []
        for body in bodies(self.model, FLOAT):
            parameters += SpatialInertia.of(body.M, body.r_C, body.I).parameters
        if joint_effects:
            moving = (joint.effects for joint in self.model.joints if joint.nv)
            parameters += [getattr(own, name) for own in moving for name in EFFECTS]
        return np.array(parameters, dtype=np.float64)

    def base_parameters(self, joint_effects: bool = False, tolerance: float = 1e-9) -> BaseParameters:
        """The parameters that motion can tell: a basis of the regressor's columns, and the map to it from all.

            tau - tau_joint = Y pi = Y_b pi_b,   pi_b = B pi      (Gautier and Khalil, 1990; by QR, Gautier, 1991)

        A trajectory is judged by `base.condition(robot.regressor(q, v, a))`.

        Args:
            joint_effects: whether armature, damping and Coulomb friction are parameters too; then tau = Y_b pi_b.
            tolerance: how far a column may be from the span of those before it to depend on them, relative to the
                largest of its kind (`BaseParameters.tolerance`).
        """
        from rttrr_pin.core.exciting import as_forces, random_motion
        from rttrr_pin.core.identification import base_parameters, parameter_names

        names = parameter_names(self.model, joint_effects)
        Y = self.regressor(*random_motion(self.model, len(names)), joint_effects)
        return base_parameters(names, as_forces(self.model, Y), tolerance)
