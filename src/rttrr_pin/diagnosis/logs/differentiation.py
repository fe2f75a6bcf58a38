"""Rates and accelerations of sampled motion, by splines whose knots are as dense as the noise allows, and their error.

A quintic spline is fitted by least squares. How far apart its knots are is chosen by generalised cross-validation
(Craven and Wahba, 1979), whose count of parameters is taken 1.4 times against fits that follow the noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rttrr_pin.core.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

DEGREE = 5

METHOD = "norm-eq"
"""Fifteen times as fast as QR, and as near with knots so far apart: B-splines are well conditioned."""

FINEST = 6.0
"""Samples between two knots, at least."""

FEWEST = 40
"""Samples in a row without which nothing is fitted."""

COUNTED = 1.4
"""How often a parameter counts in cross-validation (Kim and Gu, 2004)."""

DENSER = 1
"""Steps of `_spacings` by which knots are denser than cross-validation has them, so that the error is that of noise."""

BOTH = math.sqrt(2.0)
"""Times the noise: some of the error is what a spline cannot follow."""


@dataclass(frozen=True, slots=True, eq=False)
class Smoothed:
    """Signals as splines, at the times of their samples.

    Attributes:
        orders: the spline, its first and its second derivative, (N, columns) each.
        others: the same of a spline that was fitted again with noise of twice the variance: their difference is about
            the error of each.
        noise: standard deviation of the samples from the spline, (columns,).
        knots: distance of knots of the densest spline [s].
    """

    orders: tuple[Array, Array, Array]
    others: tuple[Array, Array, Array]
    noise: Array
    knots: float


def smoothed(t: Array, x: Array) -> Smoothed:
    """Signals (N, columns) sampled at increasing times (N,) without a gap; at least `FEWEST` samples."""
    spacings = _spacings(t)
    scores, residuals = zip(*(_score(t, x, spacing) for spacing in spacings), strict=True)
    least = np.argmin(scores, axis=0)
    best = np.maximum(least - DENSER, 0)
    best = np.where(np.isfinite(np.take_along_axis(np.stack(scores), best[None], axis=0)[0]), best, least)
    rng = np.random.default_rng(0)
    orders, others = (tuple(np.zeros_like(x) for _ in range(3)) for _ in range(2))
    noise = np.array([residuals[k][column] for column, k in enumerate(best)])
    for column, k in enumerate(best):
        fitted = _derivatives(t, x[:, column], spacings[k])
        again = _derivatives(t, fitted[0] + BOTH * noise[column] * rng.standard_normal(len(t)), spacings[k])
        for own, other, y, z in zip(orders, others, fitted, again, strict=True):
            own[:, column], other[:, column] = y, z
    densest = min((spacings[k] for k in best), default=spacings[0])
    return Smoothed((orders[0], orders[1], orders[2]), (others[0], others[1], others[2]), noise, densest)


def _spacings(t: Array) -> list[float]:
    """Distances of knots to choose from [s]."""
    finest, widest = FINEST * float(np.median(np.diff(t))), (t[-1] - t[0]) / 2
    count = max(1, math.ceil(2 * math.log2(max(widest / finest, 1.0))))
    return [finest * 2 ** (k / 2) for k in range(count + 1)]


def _score(t: Array, x: Array, spacing: float) -> tuple[Array, Array]:
    """The criterion of generalised cross-validation, and the standard deviation of the residual, of each column."""
    parameters = len(_knots(t, spacing)) - DEGREE - 1
    free = len(t) - parameters
    counted = len(t) - COUNTED * parameters
    never = np.full(x.shape[1], np.inf)
    if counted <= 0:
        return never, never
    try:
        residual = x - _spline(t, x, spacing)(t)
    except (ValueError, np.linalg.LinAlgError):  # too few samples between two knots
        return never, never
    squares = (residual**2).sum(axis=0)
    return squares / counted**2, np.sqrt(squares / free)


def _derivatives(t: Array, x: Array, spacing: float) -> list[Array]:
    spline = _spline(t, x, spacing)
    return [np.asarray(spline.derivative(order)(t) if order else spline(t)) for order in range(3)]


def _spline(t: Array, x: Array, spacing: float) -> BSpline:
    from scipy.interpolate import make_lsq_spline  # half a second, which tables of results do not need

    return make_lsq_spline(t, x, _knots(t, spacing), DEGREE, method=METHOD)


def _knots(t: Array, spacing: float) -> Array:
    """Evenly apart, about as far as wanted, and all at the ends that a spline needs."""
    inner = np.linspace(t[0], t[-1], max(1, round((t[-1] - t[0]) / spacing)) + 1)[1:-1]
    return np.concatenate([[t[0]] * (DEGREE + 1), inner, [t[-1]] * (DEGREE + 1)])
