"""The bodies of a file beside what is drawn of them and where their joints are: what plausibility is judged by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.bodies import principal, semi_axes
from rttrr_pin.inspection.checks import Subject
from rttrr_pin.inspection.exact import rank
from rttrr_pin.inspection.shapes import Filled, Looks
from rttrr_pin.urdf.document import UrdfLink
from rttrr_pin.urdf.inertial import UrdfInertial

LARGEST_GYRATION = 1.5
"""Radius of gyration over the distance of the farthest point drawn. No mass inside the drawing gives more than 1."""

SMALLEST_GYRATION = 0.1
"""The same over that from the middle of the drawing; a homogeneous ball has 0.63, a rod about its middle 0.58, a heavy
core in a wide cover seldom 0.15."""

DENSITIES = (5.0, 25_000.0)
"""Mass over the volume of a hull or ellipsoid [kg/m^3]: an open frame, and above osmium (22,590)."""

LONGEST = 10.0
"""Radius of gyration over the size of the robot, for a body that may be flat."""

FAR, SURE_FAR = 0.5, 0.02
"""Distances |I - solid| / |solid| from which a tensor is not that of a hull, or of a box, cylinder or ball."""


@dataclass(frozen=True, eq=False)
class Case:
    """A link with a tensor.

    Attributes:
        link: the link.
        inertial: its <inertial>.
        looks: its geometry.
        extent: how far the robot's joints and centres of mass lie from each other, all coordinates zero [m].
    """

    link: UrdfLink
    inertial: UrdfInertial
    looks: Looks
    extent: float

    @cached_property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self.inertial.mass)

    @cached_property
    def moments(self) -> Array:
        """Principal moments, ascending, (3,) [kg m^2]."""
        return principal(self.inertial.tensor)[0]

    @cached_property
    def gyration(self) -> float:
        """The largest radius of gyration [m], of a body with mass."""
        return float(np.sqrt(max(self.moments[-1], 0.0) / self.mass))

    @cached_property
    def reach(self) -> float:
        """From the centre of mass to the farthest point drawn [m]."""
        return float(np.linalg.norm(self.looks.points - self.inertial.origin.p, axis=1).max())

    @cached_property
    def radius(self) -> float:
        """From the middle of the drawing to the farthest point drawn [m]."""
        points = self.looks.points
        middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
        return float(np.linalg.norm(points - middle, axis=1).max())

    @property
    def drawn(self) -> bool:
        """Whether there is a mass, and a geometry that could be read."""
        return self.mass > 0.0 and self.looks.known

    @cached_property
    def solids(self) -> tuple[Filled, ...]:
        """What the link would be if its shapes were filled."""
        return self.looks.solids if self.drawn else ()

    @cached_property
    def distances(self) -> tuple[float, ...]:
        """|I - solid| / |solid| for each of them."""
        return tuple(distance(self.inertial.inertia, solid.inertia(self.mass)) for solid in self.solids)

    @property
    def unlike(self) -> bool:
        """Whether the tensor is far from all solids, or off one that is drawn exactly."""
        exact = [solid.exact for solid in self.solids]
        return bool(exact) and min(self.distances) > (SURE_FAR if any(exact) else FAR)

    @property
    def wide(self) -> bool:
        """Whether the mass would have to lie where nothing is drawn; without drawing, be lighter than things are."""
        if self.drawn:
            return self.gyration > LARGEST_GYRATION * self.reach
        return self.mass > 0.0 and (
            self.gyration > LONGEST * self.extent > 0.0 or ellipsoid_density(self.mass, self.moments) < DENSITIES[0]
        )

    @property
    def narrow(self) -> bool:
        """Whether nearly all mass would sit in the middle; without drawing, be denser than any metal."""
        if self.drawn:
            return self.gyration < SMALLEST_GYRATION * self.radius
        return self.mass > 0.0 and ball_density(self.mass, self.moments) > DENSITIES[1]

    @cached_property
    def possible(self) -> bool:
        """Whether a body can have the tensor, with some mass."""
        return rank(self.inertial) is not None

    @property
    def suspect(self) -> bool:
        """Whether the tensor asks for another reading."""
        return not self.possible or self.mass == 0.0 or self.wide or self.narrow or self.unlike


def ellipsoid_density(mass: float, moments: Array) -> float:
    """Of the homogeneous ellipsoid [kg/m^3]: a part of any body with this mass and inertia is as dense, or denser.

    NaN where no body with thickness has the inertia.
    """
    axes = semi_axes(mass, moments)
    return float(mass / (4.0 / 3.0 * np.pi * axes.prod())) if axes.all() else np.nan


def ball_density(mass: float, moments: Array) -> float:
    """Of the homogeneous ball with the largest of the moments [kg/m^3]: flat and thin bodies count as balls."""
    radius = np.sqrt(2.5 * max(moments[-1], 0.0) / mass)
    return float(mass / (4.0 / 3.0 * np.pi * np.float64(radius) ** 3)) if radius > 0.0 else np.nan


def distance(x: Array, wanted: Array) -> float:
    """|x - wanted| / |wanted|."""
    return float(np.linalg.norm(x - wanted) / np.linalg.norm(wanted))


@lru_cache(maxsize=1)  # all checks of a file look at the same cases
def cases(subject: Subject) -> dict[str, Case]:
    """The links that have a tensor, by name, in the order of the file."""
    extent = _extent(subject)
    return {
        link.name: Case(link, inertial, subject.looks(link), extent)
        for link, inertial in subject.inertials()
        if not inertial.is_zero
    }


def _extent(subject: Subject) -> float:
    """The diagonal of the box around all joints and centres of mass [m]."""
    placements = subject.document.placements
    points = [p for _, p in placements.values()]
    for link, inertial in subject.inertials():
        R, p = placements[link.name]
        points.append(p + R @ inertial.origin.p)
    return float(np.linalg.norm(np.ptp(points, axis=0)))
