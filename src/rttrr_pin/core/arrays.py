"""The array type of the package, the norm of its vectors, roll, pitch and yaw, and data that holds read-only arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from math import atan2, cos, hypot, prod, sin
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""An array of float64."""


SMALL, LARGE = 2.0**-800, 2.0**800
"""Between them a square has not overflowed, nor lost a bit."""

SCALE = 2.0**600
"""Takes every number whose square is small, or large by its inverse, to one whose square is between them."""


def norm(vectors: Array) -> Array:
    """The Euclidean norm of the last axis; a vector has the same bits alone and in an array of any layout.

    No square of a number that float64 holds overflows or vanishes: vectors whose squares would are multiplied by a
    power of two, which gives the bits of the plain formula. A norm that itself is too large is infinite.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        squares = vectors * vectors
        total = _sum(squares)
        plain: Array = np.sqrt(total)
        if not total.size or (
            total.max() <= LARGE and (total.min() >= SMALL or ((squares < SMALL) == (vectors == 0.0)).all())
        ):
            return plain
        up, down = vectors * SCALE, vectors / SCALE
        small, large = np.sqrt(_sum(up * up)) / SCALE, np.sqrt(_sum(down * down)) * SCALE
        return np.where(total < SMALL, small, np.where(total <= LARGE, plain, large))[()]


def _sum(terms: Array) -> Array:
    """The sum of the last axis."""
    total: Array
    if terms.ndim == 1:
        total = np.add.reduce(terms)
    elif terms.shape[-1] == 3:  # nearly all are
        total = terms[..., 0] + terms[..., 1]
        total += terms[..., 2]
    else:
        total = _added(np.moveaxis(terms, -1, 0))
    return total


def _added(terms: Array) -> Array:
    """The sum of the first axis by columns, which run through memory, in the order that NumPy has for one of them.

    That is eight sums side by side, and halves of what is longer than 128; NumPy itself has another order for each
    layout.
    """
    n = len(terms)
    if n < 8:
        return sum(terms[1:], start=terms[0]) if n else np.zeros(terms.shape[1:])
    if n > 128:
        half = n // 2 - n // 2 % 8
        return _added(terms[:half]) + _added(terms[half:])
    rest = n - n % 8
    side = sum((terms[k : k + 8] for k in range(8, rest, 8)), start=terms[:8])
    pairs = side[0::2] + side[1::2]
    quarters = pairs[0::2] + pairs[1::2]
    total: Array = sum(terms[rest:], start=quarters[0] + quarters[1])
    return total


def flat(x: Array) -> Array:
    """(N, ...) as (N, numbers); where each number of consecutive states lies side by side, it does so still."""
    width = prod(x.shape[1:])
    if x.strides[0] != x.itemsize:
        return x.reshape(len(x), width)
    return np.ascontiguousarray(np.moveaxis(x, 0, -1)).reshape(width, len(x)).T


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
