"""What changes leave of a difference: distances from what vectors span."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.predictions import Change


def left_by(target: Array, one: Change) -> float:
    """The length of what a change leaves of a difference, its numbers fitted."""
    if not one.fitted:
        return float(np.linalg.norm(target - one.change))
    return distance(target, one.change)


def distance(target: Array, rows: Array) -> float:
    """How far a vector is from the span of some."""
    return float(np.linalg.norm(rest_of(target, rows)))


def rest_of(target: Array, rows: Array) -> Array:
    """What is left of a vector without what lies in the span of some."""
    Q = basis(rows)
    return np.asarray(target - Q @ (Q.T @ target))


def basis(rows: Array) -> Array:
    """An orthonormal basis of what some vectors span, (numbers, rank)."""
    lengths = np.linalg.norm(rows, axis=1)
    U, sigma, _ = np.linalg.svd((rows[lengths > 0.0] / lengths[lengths > 0.0, None]).T, full_matrices=False)
    return np.asarray(U[:, sigma > 1e-10 * sigma.max(initial=0.0)])


def left_by_each(target: Array, rows: Array, fitted: Sequence[int]) -> Array:
    """The same for many changes, (changes, numbers), each as it is or, where one number is fitted, as far as best."""
    along, squares = rows @ target, np.sum(rows * rows, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(np.asarray(fitted) > 0, np.where(squares > 0.0, along / squares, 0.0), 1.0)
    return np.asarray(np.linalg.norm(target - part[:, None] * rows, axis=1))
