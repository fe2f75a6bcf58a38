"""Rotation matrices, over scalars of any kind."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from rttrr_pin.core.algebra import IDENTITY, Matrix, Scalar, Vector

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
