"""What changes leave of a difference: distances from what vectors span."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.engine.predictions import Change


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


Pair = tuple[float, tuple[Change, Change]]
"""The length of what is left of a difference, and the changes."""


def pairs(target: Array, changes: Sequence[Change], most: int) -> Iterator[Pair]:
    """What sums of two changes leave of a difference; of two without fitted numbers the best ones, so many."""
    fixed = [own for own in changes if not own.fitted]
    free = [own for own in changes if own.fitted]
    rows = np.array([own.change for own in fixed]).reshape(len(fixed), len(target))
    yield from _fixed_pairs(target, fixed, rows, most)
    for n, own in enumerate(free):
        Q = basis(own.change)
        left = target - Q @ (Q.T @ target)
        lengths = np.linalg.norm(left - (rows - (rows @ Q) @ Q.T), axis=1)
        for k in np.argsort(lengths)[:4].tolist():
            yield float(lengths[k]), (own, fixed[k])
        for other in free[n + 1 :]:
            yield distance(left, other.change - (other.change @ Q) @ Q.T), (own, other)


def _fixed_pairs(target: Array, fixed: Sequence[Change], rows: Array, most: int) -> Iterator[Pair]:
    """Of two without fitted numbers, by the squares of lengths: all at once."""
    gram, along = rows @ rows.T, rows @ target
    lengths = np.diag(gram)
    squares = float(target @ target) - 2 * (along[:, None] + along) + 2 * gram + lengths + lengths[:, None]
    squares[np.tril_indices(len(fixed))] = np.inf
    for k in np.argsort(squares, axis=None)[:most].tolist():
        i, j = divmod(k, len(fixed))
        if np.isfinite(squares[i, j]):
            yield float(np.sqrt(max(squares[i, j], 0.0))), (fixed[i], fixed[j])
