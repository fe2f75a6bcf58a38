"""Wrenches at a point of a link, and the driving forces that balance them: tau = J^T w.

By virtual work, as J v is the velocity of the point (Siciliano, Sciavicco, Villani, Oriolo, "Robotics", section 3.8).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arguments import relative_tolerance
from rttrr_pin.core.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class WrenchEstimate:
    """The wrench that driving forces tell of, made by `Robot.wrench_from_torque`.

    Attributes:
        force: what the robot exerts on its surroundings, (..., 3) [N].
        moment: about the point, (..., 3) [N m].
        rank: how many of the six components the joints feel, (...): 6 where all of them.
        resolution: (..., 6, 6), the estimate is resolution times the true (force, moment): the identity where the rank
            is 6, else the projection on what the joints feel.
        residual: tau - J^T w, what no wrench at this point explains, (..., nv) [N m or N].
    """

    force: Array
    moment: Array
    rank: NDArray[np.int64]
    resolution: Array
    residual: Array


def at_point(J: Array, r: Array) -> Array:
    """The Jacobian of the point at r, v + w x r and w, from that of the link's origin, (..., 6, nv); all in {i}."""
    v, w = J[..., :3, :], J[..., 3:, :]
    v = v + np.cross(w, r[..., None], axis=-2)
    return np.concatenate(np.broadcast_arrays(v, w), axis=-2)


def turned(J: Array, R: Array) -> Array:
    """The Jacobian in other axes: both vectors turned by R, (..., 3, 3)."""
    return np.concatenate([R @ J[..., :3, :], R @ J[..., 3:, :]], axis=-2)


def estimate(J: Array, tau: Array, tolerance: float) -> WrenchEstimate:
    """The wrench w of least squares |J^T w - tau|, in N and N m the smallest of those, by singular values.

    Args:
        J: (..., 6, nv).
        tau: (..., nv).
        tolerance: singular values at most this part of the largest count as zero.
    """
    tolerance = relative_tolerance(tolerance)
    A = np.swapaxes(J, -1, -2)
    U, s, V = np.linalg.svd(A, full_matrices=False)
    felt = s > tolerance * s.max(axis=-1, keepdims=True, initial=0.0)
    inverse = np.divide(1.0, s, out=np.zeros_like(s), where=felt)
    w = np.einsum("...ki,...k,...jk,...j->...i", V, inverse, U, tau)
    return WrenchEstimate(
        force=w[..., :3],
        moment=w[..., 3:],
        rank=felt.sum(axis=-1),
        resolution=np.einsum("...ki,...k,...kj->...ij", V, felt.astype(float), V),
        residual=tau - np.einsum("...ji,...i->...j", A, w),
    )
