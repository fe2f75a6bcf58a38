"""The noise of a sampled signal, without a model of it: what divided differences of neighbours do not see is motion."""

from __future__ import annotations

import numpy as np

from rttrr_pin.core.arrays import Array

DIFFERENCES = ((4, 3), (3, 1), (4, 1))
"""Orders of differences, and of which samples each: all give the same noise if it is white and motion is slow."""

ALIKE = 1.25
"""Their ratio at most."""

DEVIATION = 1.4826
"""Of a normal distribution, the standard deviation over the median of absolute values."""


def white_noise(t: Array, x: Array) -> Array:
    """Standard deviation of the noise of each signal, (columns,); NaN where it cannot be told from motion.

    Args:
        t: times, increasing (N,).
        x: signals, (N, columns).
    """
    own = np.stack([_deviation(t[::stride], x[::stride], order) for order, stride in DIFFERENCES])
    small = 1e-12 * np.abs(x).max(axis=0, initial=0.0)
    alike = own.max(axis=0) <= ALIKE * own.min(axis=0) + small
    return np.where(alike, own[-1], np.nan)


def _deviation(t: Array, x: Array, order: int) -> Array:
    """Of differences that are zero for polynomials of lower order, and have the variance of the noise."""
    rows = len(t) - order
    if rows < 10 * order:
        return np.full(x.shape[1], np.nan)
    times = np.stack([t[k : k + rows] for k in range(order + 1)])
    apart = times[:, None] - times[None, :] + np.eye(order + 1)[:, :, None] * np.median(np.diff(t))
    weights = 1.0 / np.prod(apart / np.median(np.diff(t)), axis=1)
    weights /= np.sqrt((weights**2).sum(axis=0))
    z = sum(weight[:, None] * x[k : k + rows] for k, weight in enumerate(weights))
    return np.asarray(DEVIATION * np.median(np.abs(z), axis=0))
