"""The array type of the package, the norm of its vectors, roll, pitch and yaw, and data that holds read-only arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from math import atan2, cos, hypot, sin
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""An array of float64."""


def norm(vectors: Array) -> Array:
    """The Euclidean norm of the last axis.

    Each vector is divided by a power of two before its numbers are squared: no square of a number that float64 holds
    overflows or vanishes, and the bits are those of the plain formula. A norm that itself is too large is infinite.
    """
    size = np.abs(vectors).max(axis=-1, initial=0.0)
    exponent = np.frexp(np.where(np.isfinite(size), size, 0.0))[1]
    scaled = np.ldexp(vectors, -exponent[..., None])
    with np.errstate(over="ignore"):
        return np.ldexp(np.sqrt(np.add.reduce(scaled * scaled, axis=-1)), exponent)


def product(matrix: Array, vectors: Array) -> Array:
    """Matrices times vectors, (..., 3, 3) and (..., 3), whose leading axes broadcast.

    Written out, since a matrix product of the whole batch rounds by its size, and a state must give the same bits in
    any batch.
    """
    x, y, z = (vectors[..., k, None] for k in range(3))
    return matrix[..., :, 0] * x + matrix[..., :, 1] * y + matrix[..., :, 2] * z


def rotation(rpy: Sequence[float]) -> Array:
    """URDF's roll, pitch, yaw about fixed x, y, z [rad] as R = R_z(yaw) R_y(pitch) R_x(roll), (3, 3).

    R maps vectors of the turned frame to the fixed frame.
    """
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    return np.array(
        [
            [cp * cy, sp * (sr * cy) - cr * sy, sp * (cr * cy) + sr * sy],
            [cp * sy, sp * (sr * sy) + cr * cy, sp * (cr * sy) - sr * cy],
            [-sp, cp * sr, cp * cr],
        ]
    )


def angles_of(R: Array) -> tuple[float, float, float]:
    """Roll, pitch, yaw with R_z(yaw) R_y(pitch) R_x(roll) = R, accurate at pitch +-pi/2 too.

    Near there roll and yaw are ill-conditioned one by one; yaw is taken from R R_x(roll)^T, so that it makes up for
    whatever roll came out as.
    """
    roll = atan2(R[2, 1], R[2, 2])
    pitch = atan2(-R[2, 0], hypot(R[2, 1], R[2, 2]))
    c, s = cos(roll), sin(roll)
    yaw = atan2(s * R[0, 2] - c * R[0, 1], c * R[1, 1] - s * R[1, 2])
    return roll, pitch, yaw


class Rebuilt:
    """Frozen data that is copied and unpickled by its own arguments, since NumPy forgets that an array is read-only."""

    __slots__ = ()

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), tuple(getattr(self, own.name) for own in fields(self))  # type: ignore[arg-type]
