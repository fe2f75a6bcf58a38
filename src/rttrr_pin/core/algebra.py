"""Three-vectors, 3x3 matrices and rotations over scalars of any kind.

A scalar is anything with +, - and *: a float, a NumPy array (of one number for each state of a batch), a value with its
error bound, an interval, a polynomial. The integer 0 serves as the zero of every kind.

NumPy object arrays would not do: an array-valued scalar broadcasts wrongly in them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arrays import Array


class Scalar(Protocol):
    """Anything with +, - and *; the algebra never asks what it is.

    With what it can be added and multiplied is each kind's own affair, and so is what else it can do: code that makes
    scalars of one kind, or takes them apart, knows it and says `Any`.
    """

    def __add__(self, other: Any, /) -> Scalar: ...
    def __radd__(self, other: Any, /) -> Scalar: ...
    def __sub__(self, other: Any, /) -> Scalar: ...
    def __rsub__(self, other: Any, /) -> Scalar: ...
    def __mul__(self, other: Any, /) -> Scalar: ...
    def __rmul__(self, other: Any, /) -> Scalar: ...
    def __neg__(self) -> Scalar: ...


Lift: TypeAlias = Callable[[float], Scalar]
"""Turns a float of the model into a scalar."""


@dataclass(slots=True, eq=False)
class Vector:
    """A vector (x, y, z) in some frame."""

    x: Scalar
    y: Scalar
    z: Scalar

    @classmethod
    def of(cls, values: ArrayLike, lift: Lift = float) -> Vector:
        """The vector of three numbers, each lifted to a scalar."""
        x, y, z = np.asarray(values, dtype=float)
        return cls(lift(float(x)), lift(float(y)), lift(float(z)))

    def __iter__(self) -> Iterator[Scalar]:
        return iter((self.x, self.y, self.z))

    def __add__(self, other: Vector) -> Vector:
        return Vector(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.x - other.x, self.y - other.y, self.z - other.z)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y, -self.z)

    def __mul__(self, s: Scalar) -> Vector:
        return Vector(self.x * s, self.y * s, self.z * s)

    def cross(self, other: Vector) -> Vector:
        """The vector product self x other."""
        return Vector(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )

    def dot(self, other: Vector) -> Scalar:
        """The scalar product."""
        return self.x * other.x + self.y * other.y + self.z * other.z


@dataclass(slots=True, eq=False)
class Matrix:
    """A 3x3 matrix, by its rows."""

    rows: tuple[Vector, Vector, Vector]

    @classmethod
    def of(cls, values: ArrayLike, lift: Lift = float) -> Matrix:
        """The matrix of 3x3 numbers, each lifted to a scalar."""
        a, b, c = np.asarray(values, dtype=float)
        return cls((Vector.of(a, lift), Vector.of(b, lift), Vector.of(c, lift)))

    @classmethod
    def outer(cls, a: Vector, b: Vector) -> Matrix:
        """The dyadic product a b^T."""
        return cls((b * a.x, b * a.y, b * a.z))

    @classmethod
    def skew(cls, a: Vector) -> Matrix:
        """The matrix [a]x with [a]x b = a x b."""
        return cls((Vector(0, -a.z, a.y), Vector(a.z, 0, -a.x), Vector(-a.y, a.x, 0)))

    @property
    def T(self) -> Matrix:
        """The transpose; for a rotation, its inverse."""
        a, b, c = self.rows
        return Matrix((Vector(a.x, b.x, c.x), Vector(a.y, b.y, c.y), Vector(a.z, b.z, c.z)))

    def __add__(self, other: Matrix) -> Matrix:
        a, b, c = (x + y for x, y in zip(self.rows, other.rows, strict=True))
        return Matrix((a, b, c))

    def __sub__(self, other: Matrix) -> Matrix:
        a, b, c = (x - y for x, y in zip(self.rows, other.rows, strict=True))
        return Matrix((a, b, c))

    def __mul__(self, s: Scalar) -> Matrix:
        a, b, c = self.rows
        return Matrix((a * s, b * s, c * s))

    @overload
    def __matmul__(self, other: Vector) -> Vector: ...
    @overload
    def __matmul__(self, other: Matrix) -> Matrix: ...
    def __matmul__(self, other: Vector | Matrix) -> Vector | Matrix:
        """The product with a vector or a matrix."""
        if isinstance(other, Vector):
            return Vector(*(row.dot(other) for row in self.rows))
        columns = other.T.rows
        a, b, c = (Vector(*(row.dot(column) for column in columns)) for row in self.rows)
        return Matrix((a, b, c))

    @property
    def array(self) -> Array:
        """A matrix of plain numbers as an array, (3, 3)."""
        return np.array([[*row] for row in self.rows], dtype=np.float64)


ZERO = Vector(0, 0, 0)
IDENTITY = Matrix((Vector(1, 0, 0), Vector(0, 1, 0), Vector(0, 0, 1)))

SinCos: TypeAlias = Callable[[Any], tuple[Scalar, Scalar]]
"""Sine and cosine of one kind of scalar."""


def rotation(axis: Vector, q: Scalar, sincos: SinCos) -> Matrix:
    """The rotation by q about a unit axis u: u u^T + cos q (1 - u u^T) + sin q [u]x (Rodrigues)."""
    s, c = sincos(q)
    along = Matrix.outer(axis, axis)
    across = IDENTITY - along
    return along + across * c + Matrix.skew(axis) * s


def quaternion_rotation(x: Scalar, y: Scalar, z: Scalar, w: Scalar) -> Matrix:
    """The rotation of a unit quaternion with vector part (x, y, z) and real part w."""
    return Matrix(
        (
            Vector(1 - (y * y + z * z) * 2, (x * y - w * z) * 2, (x * z + w * y) * 2),
            Vector((x * y + w * z) * 2, 1 - (x * x + z * z) * 2, (y * z - w * x) * 2),
            Vector((x * z - w * y) * 2, (y * z + w * x) * 2, 1 - (x * x + y * y) * 2),
        )
    )
