"""Fits in the largest error: what printing leaves open is a bound, and least squares overshoot it by some percent."""

from __future__ import annotations

import numpy as np

from rttrr_pin.core.arrays import Array


def minimax(J: Array, rest: Array, bound: Array) -> Array | None:
    """The step of fitted numbers that makes the largest error over its bound smallest.

    Args:
        J: change of each result with each number, (fitted, results).
        rest: what is left of each result, (results,).
        bound: what rounding and printing explain of it, (results,); above zero.

    Returns:
        The step, (fitted,); None where there is none.
    """
    from scipy.optimize import linprog

    A, b = (J / bound).T, rest / bound
    sizes = np.abs(A).max(axis=0)
    if not (np.isfinite(A).all() and np.isfinite(b).all() and sizes.all()):
        return None
    A = A / sizes
    ones = np.ones((len(b), 1))
    found = linprog(
        np.append(np.zeros(len(sizes)), 1.0),
        A_ub=np.block([[A, -ones], [-A, -ones]]),
        b_ub=np.concatenate([b, -b]),
        bounds=[(None, None)] * (len(sizes) + 1),
    )
    return np.asarray(found.x[:-1] / sizes) if found.success else None
