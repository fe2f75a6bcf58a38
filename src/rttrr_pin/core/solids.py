"""Mass, centre of mass and inertia of simple solids, and of bodies made of them.

Formulas: F. P. Beer, E. R. Johnston et al., *Vector Mechanics for Engineers: Dynamics*, the table "Mass moments of
inertia of common geometric shapes" and the section on the parallel-axis theorem; the same stand in every textbook of
mechanics. Inertias are about the centre of mass, with URDF's sign: off the diagonal stand the matrix elements.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, pi

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array, rotation
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.errors import InputError

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    """A cuboid.

    Attributes:
        size: its edges along x, y and z [m].
    """

    size: Triple

    def __post_init__(self) -> None:
        _check_positive("Box.size", self.size)

    @property
    def volume(self) -> float:
        """Volume x y z [m^3]."""
        x, y, z = self.size
        return x * y * z

    def specific_inertia(self) -> Array:
        """I_xx / m = (y^2 + z^2) / 12, and so on in a circle (Beer and Johnston: rectangular prism)."""
        x, y, z = self.size
        return np.diag([y * y + z * z, z * z + x * x, x * x + y * y]) / 12.0


@dataclass(frozen=True)
class Cylinder:
    """A circular cylinder about its own z axis.

    Attributes:
        radius: its radius [m].
        length: its length along z [m].
    """

    radius: float
    length: float

    def __post_init__(self) -> None:
        _check_positive("Cylinder.(radius, length)", (self.radius, self.length))

    @property
    def volume(self) -> float:
        """Volume pi r^2 l [m^3]."""
        return pi * self.radius**2 * self.length

    def specific_inertia(self) -> Array:
        """I_zz / m = r^2 / 2 and I_xx / m = I_yy / m = (3 r^2 + l^2) / 12 (Beer and Johnston: circular cylinder)."""
        across = (3.0 * self.radius**2 + self.length**2) / 12.0
        return np.diag([across, across, self.radius**2 / 2.0])


@dataclass(frozen=True)
class Sphere:
    """A ball.

    Attributes:
        radius: its radius [m].
    """

    radius: float

    def __post_init__(self) -> None:
        _check_positive("Sphere.radius", (self.radius,))

    @property
    def volume(self) -> float:
        """Volume 4/3 pi r^3 [m^3]."""
        return 4.0 / 3.0 * pi * self.radius**3

    def specific_inertia(self) -> Array:
        """I / m = 2/5 r^2 about every axis (Beer and Johnston: sphere)."""
        return np.eye(3) * (0.4 * self.radius**2)


@dataclass(frozen=True)
class Capsule:
    """A cylinder about its own z axis with half a ball on each end.

    Attributes:
        radius: its radius [m].
        length: of the cylinder alone, along z [m].
    """

    radius: float
    length: float

    def __post_init__(self) -> None:
        _check_positive("Capsule.(radius, length)", (self.radius, self.length))

    @property
    def volume(self) -> float:
        """Volume pi r^2 l + 4/3 pi r^3 [m^3]."""
        return Cylinder(self.radius, self.length).volume + Sphere(self.radius).volume

    def specific_inertia(self) -> Array:
        """Those of cylinder and ball by their shares; the half balls, whose centres lie 3/8 r beyond the ends, moved.

        Parallel axes, for half a ball: I_xx / m = 2/5 r^2 + l^2 / 4 + 3/8 r l.
        """
        r, l = self.radius, self.length
        cylinder, ball = Cylinder(r, l), Sphere(r)
        away = np.diag([1.0, 1.0, 0.0]) * (l * l / 4.0 + 3.0 / 8.0 * r * l)
        share = ball.volume / self.volume
        return (1.0 - share) * cylinder.specific_inertia() + share * (ball.specific_inertia() + away)


Solid = Box | Cylinder | Sphere | Capsule
"""A homogeneous solid, in a frame at its own centre."""


@dataclass(frozen=True, eq=False)
class RigidBody:
    """The ten numbers of a rigid body.

    Attributes:
        mass: mass [kg].
        com: centre of mass, (3,) [m], in the body's frame.
        inertia: inertia about the centre of mass, (3, 3) [kg m^2], in the axes of the body's frame.
    """

    mass: float
    com: Array
    inertia: Array

    @classmethod
    def of(cls, solid: Solid, density: float) -> RigidBody:
        """The body that a solid of one density [kg/m^3] is, in a frame at its centre.

        Raises:
            InputError: the density is not a positive finite number.
        """
        _check_positive("density", (density,))
        mass = density * solid.volume
        return cls(mass, np.zeros(3), mass * solid.specific_inertia())

    def placed(self, xyz: Sequence[float], rpy: Sequence[float] = (0.0, 0.0, 0.0)) -> RigidBody:
        """The same body seen from another frame: com' = p + R com, I' = R I R^T.

        Args:
            xyz: p, the origin of the body's frame in the other frame [m].
            rpy: the angles of R, which maps vectors of the body's frame to the other frame [rad]; see `rotation`.
        """
        R = rotation(rpy)
        return RigidBody(self.mass, np.asarray(xyz) + R @ self.com, R @ self.inertia @ R.T)


@dataclass(frozen=True)
class Material:
    """What a solid is made of.

    Attributes:
        name: its name.
        density: mass over the solid's outer volume [kg/m^3]; a hollow part has the density that its filling leaves.
        rgba: colour and opacity, 0 to 1.
        note: what it stands for.
    """

    name: str
    density: float
    rgba: tuple[float, float, float, float]
    note: str


@dataclass(frozen=True)
class Part:
    """A solid of a material at a place.

    Attributes:
        name: what it is, unique among the parts of a module.
        solid: its shape.
        material: what it is made of.
        xyz, rpy: its centre [m] and axes [rad] in the frame that the owner of the part names, as in `rotation`.
    """

    name: str
    solid: Solid
    material: Material
    xyz: Triple
    rpy: Triple = (0.0, 0.0, 0.0)

    def body(self) -> RigidBody:
        """The part as a rigid body in its owner's frame."""
        return RigidBody.of(self.solid, self.material.density).placed(self.xyz, self.rpy)


def combine(bodies: Iterable[RigidBody]) -> RigidBody:
    """The one rigid body that several bodies in one frame make together.

    M = sum m_k; M c = sum m_k c_k; with d = c_k - c, I = sum I_k + m_k (d.d 1 - d d^T) (parallel axes).
    Where bodies overlap, both masses count.

    Raises:
        InputError: there is no body.
    """
    parts = tuple(bodies)
    if not parts:
        raise InputError("combine() got no body, wanted at least one: pass the bodies that the link is made of")
    mass = sum(part.mass for part in parts)
    com = sum((part.mass * part.com for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        inertia += part.inertia + part.mass * point_tensor(Vector.of(part.com - com)).array
    return RigidBody(mass, com, inertia)


def _check_positive(what: str, values: Iterable[float]) -> None:
    got = tuple(values)
    if not all(0.0 < value < inf for value in got):
        shown = got[0] if len(got) == 1 else got
        raise InputError(f"{what} is {shown}, wanted positive finite numbers in SI units: mend the dimension")
