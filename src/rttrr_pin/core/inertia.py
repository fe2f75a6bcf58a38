"""The spatial inertia of a body, over scalars of any kind.

As mass, first moment and tensor about the origin of one frame, inertias of bodies that move as one add up
(Featherstone, "Rigid Body Dynamics Algorithms", section 2.13). Nothing but `about_com` divides, so masses may have any
sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rttrr_pin.core.algebra import IDENTITY, Matrix, Scalar, Vector

NOWHERE = Vector(0.0, 0.0, 0.0)

NO_TENSOR = Matrix((NOWHERE, NOWHERE, NOWHERE))


@dataclass(frozen=True, slots=True, eq=False)
class SpatialInertia:
    """Mass, first moment and tensor about the origin, in one frame.

    Attributes:
        m: mass [kg].
        h: first moment, mass times centre of mass [kg m].
        J: tensor about the origin [kg m^2].
    """

    m: Scalar = 0.0
    h: Vector = NOWHERE
    J: Matrix = NO_TENSOR

    @classmethod
    def of(cls, mass: Scalar, com: Vector, tensor: Matrix) -> SpatialInertia:
        """From the centre of mass [m] and the tensor about it [kg m^2]: J = I + m (c.c 1 - c c^T) (parallel axes)."""
        return cls(mass, com * mass, tensor + point_tensor(com) * mass)

    @classmethod
    def of_parameters(cls, parameters: Sequence[Scalar]) -> SpatialInertia:
        """From the ten numbers of `parameters`."""
        m, x, y, z, xx, xy, yy, xz, yz, zz = parameters
        return cls(m, Vector(x, y, z), Matrix((Vector(xx, xy, xz), Vector(xy, yy, yz), Vector(xz, yz, zz))))

    @property
    def parameters(self) -> tuple[Scalar, ...]:
        """m, h and the entries xx, xy, yy, xz, yz, zz of J: the order of the regressor."""
        x, y, z = self.J.rows
        return (self.m, *self.h, x.x, x.y, y.y, x.z, y.z, z.z)

    def __add__(self, other: SpatialInertia) -> SpatialInertia:
        return SpatialInertia(self.m + other.m, self.h + other.h, self.J + other.J)

    def __sub__(self, other: SpatialInertia) -> SpatialInertia:
        return SpatialInertia(self.m - other.m, self.h - other.h, self.J - other.J)

    def moved(self, R: Matrix, p: Vector) -> SpatialInertia:
        """The same body in a frame in which this one stands at p [m], turned by R."""
        h, J = R @ self.h, R @ self.J @ R.T
        shift = IDENTITY * (h.dot(p) * 2) - Matrix.outer(h, p) - Matrix.outer(p, h) + point_tensor(p) * self.m
        return SpatialInertia(self.m, h + p * self.m, J + shift)

    def about_com(self) -> tuple[Vector, Matrix]:
        """The centre of mass h / m [m], and the tensor about it [kg m^2]; without mass, the origin and J.

        The tensor is a difference of tensors about the origin: the farther the centre of mass, the more it is rounded.
        """
        m: Any = self.m  # of a kind that can be divided, as scalars need not be
        if m == 0.0:
            return NOWHERE, self.J
        com = Vector(*(x / m for x in self.h))
        return com, self.J - point_tensor(com) * m


def point_tensor(r: Vector) -> Matrix:
    """The tensor about the origin of a mass of 1 kg at r [m]: r.r 1 - r r^T."""
    return IDENTITY * r.dot(r) - Matrix.outer(r, r)


def is_zero(x: Scalar) -> bool:
    """Whether a number of the robot is 0, and not only rounded to it."""
    return bool(x == 0.0) and not getattr(x, "error", 0.0)
