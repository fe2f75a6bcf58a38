"""Jacobians, and the wrenches that driving forces stand for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import choice
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import common_shape
from rttrr_pin.core.inputs import Coordinates, coordinates, vectors
from rttrr_pin.core.payload import load_of, payload_link
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.robot.dynamics import Dynamics

if TYPE_CHECKING:
    from rttrr_pin.core.statics import WrenchEstimate


class Statics(Dynamics):
    """What holds at rest."""

    def jacobian(
        self,
        q: Coordinates,
        link: str | None = None,
        point: ArrayLike = (0.0, 0.0, 0.0),
        expressed_in: Literal["link", "base"] = "link",
    ) -> Array:
        """J(q), (..., 6, nv), by which a point of a link moves: (velocity of the point, angular velocity) = J v.

        Args:
            q: coordinates.
            link: the link; None: the tool, that is the robot's only last link.
            point: from the origin of the link's frame, in the link's axes, (..., 3) [m].
            expressed_in: the axes of both velocities: `"link"` or `"base"`.

        Raises:
            InputError: there are no such axes; or several last links and no name.
        """
        from rttrr_pin.core import statics

        choice("expressed_in", expressed_in, "link", "base")
        i = payload_link(self.model, link)
        parts = self._kernel(("link_jacobians", "link_placements"))(q)
        J, r = parts["link_jacobians"][..., i, :, :], vectors("point", point)
        common_shape({"q": J.shape[:-2], "point": r.shape[:-1]})
        J = statics.at_point(J, r)
        return statics.turned(J, parts["link_placements"][..., i, :, :3]) if expressed_in == "base" else J

    def wrench_torque(self, q: Coordinates, wrench: Wrench, point: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
        """The driving forces that a wrench at a point of a link takes, to be added to tau: J^T w, (..., nv) [N m or N].

        A wrench is what the robot exerts on its surroundings, also here: of what acts on the robot, pass the opposite.

        Args:
            q: coordinates.
            wrench: force, and moment about the point.
            point: from the origin of the link's frame, in the link's axes, (..., 3) [m].
        """
        load = load_of(self.model, wrench)
        J = self.jacobian(q, wrench.link, point, wrench.expressed_in)
        common_shape({"q and point": J.shape[:-2], "force": load.f.shape[:-1], "moment": load.n.shape[:-1]})
        w = np.concatenate(np.broadcast_arrays(load.f, load.n), axis=-1)
        return np.asarray(np.einsum("...ij,...i->...j", J, w))

    def wrench_from_torque(
        self,
        q: Coordinates,
        tau: Coordinates,
        link: str | None = None,
        point: ArrayLike = (0.0, 0.0, 0.0),
        expressed_in: Literal["link", "base"] = "link",
        tolerance: float = 1e-9,
    ) -> WrenchEstimate:
        """The wrench at a point of a link that explains driving forces best, by least squares; its rank is told.

        Args:
            q: coordinates.
            tau: what the wrench adds to the driving forces, (..., nv) [N m or N]: measured ones less those of
                `inverse_dynamics`.
            link: as in `jacobian`.
            point: the same.
            expressed_in: the axes of force and moment.
            tolerance: singular values of J at most this part of the largest count as zero.

        Returns:
            What the robot exerts on its surroundings; where joints do not feel all six components, of the wrenches that
            explain tau the smallest.
        """
        from rttrr_pin.core import statics

        J = self.jacobian(q, link, point, expressed_in)
        driving = coordinates("tau", tau, self.model.moving)
        common_shape({"q and point": J.shape[:-2], "tau": driving.shape[:-1]})
        return statics.estimate(J, driving, tolerance)
