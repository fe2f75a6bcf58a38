"""Splines by least squares: rates and accelerations of sampled motion, and how well they are known.

A quintic spline is fitted to the rows of a window. How far apart its knots are is chosen by generalised
cross-validation (Craven and Wahba, 1979), whose count of parameters is taken 1.4 times against fits that follow the
noise (Kim and Gu, 2004). A fit is a linear operator on the rows, so that the covariance of its error by the noise is
known; of what the spline cannot follow, splines of wider knots tell how much there is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.trajectories.operators import Operator, Window

FEWEST = 40
"""Rows in a row without which nothing is fitted."""

COUNTED = 1.4
"""How often a parameter counts in cross-validation."""

DENSER = 1
"""Steps by which knots are denser than cross-validation has them: what is chosen for x is too smooth for a."""

LEAST = 2.0 * float(np.finfo(np.float64).eps)
"""Relative: numbers have no less noise than by their own rounding."""

SMOOTHEST = 2.0 ** np.array([6.0, 5.0, 4.0])
"""How much more of a smooth motion, its rate and its acceleration knots cannot follow that are twice as far apart."""

MOST = 0.5
"""Of the square of what knots twice as far apart cannot follow, at most."""

CHOSEN = 1.15
"""Times the variance of a fit of given knots: these are chosen by the same rows."""

MULTIPLE = 0.02
"""How far numbers may be from whole ones by rounding and still be multiples of a step."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Signals as splines at the times of their samples.

    Attributes:
        orders: the spline, its first and its second derivative, (N, columns, 3).
        covariance: of their errors, (N, columns, 3, 3).
        noise: standard deviation of the samples from the spline, (columns,).
        knots: distance of knots, (columns,) [s].
        finest: whether knots are as dense as rows allow, (columns,).
    """

    orders: Array
    covariance: Array
    noise: Array
    knots: Array
    finest: NDArray[np.bool_]


def fitted(t: Array, x: Array, cutoff: float | None = None) -> Fit:
    """Splines of signals (N, columns) sampled at increasing times (N,), at least `FEWEST` of them.

    Args:
        t: times [s].
        x: signals.
        cutoff: frequency up to which splines follow [Hz]; None: chosen by the noise.
    """
    window = Window(t)
    spans = window.spans() if cutoff is None else window.at_cutoff(cutoff)
    base = x[0]
    tries = [_try(window.operator(own), x - base) for own in spans]
    scores = np.stack([score for score, _, _ in tries])
    chosen = _chosen(scores, cutoff)
    columns = x.shape[1]
    orders, covariance = np.empty((len(t), columns, 3)), np.zeros((len(t), columns, 3, 3))
    noise, knots = np.empty(columns), np.empty(columns)
    scale = window.step ** -np.arange(3.0)
    grain = np.array([_grain(own) for own in x.T])
    for k in sorted(set(chosen.tolist())):
        own = np.flatnonzero(chosen == k)
        near = [spans.index(half) for half in (spans[k], spans[k] // 2, spans[k] // 4) if half in spans]
        operators = [window.operator(spans[j]) for j in near]
        fits = [_orders(operator, tries[j][2][:, own]) for operator, j in zip(operators, near, strict=True)]
        rounding = LEAST * np.abs(x[:, own]).max(axis=0)
        sigma = np.sqrt(tries[k][1][own] ** 2 + rounding**2)
        sigma = np.maximum(sigma, grain[own])
        if cutoff is not None:
            left = x[:, own] - base[own] - fits[0][..., 0]
            sigma = np.maximum(sigma, _density(left, spans[k]))
        off = _unfollowed(operators, fits, sigma**2)
        off[..., 0] += grain[own] ** 2  # a step of a sensor is no noise while it stands still
        covariance[:, own] = CHOSEN * operators[0].covariance[:, None] * sigma[:, None, None] ** 2
        covariance[:, own[:, None], range(3), range(3)] += off
        orders[:, own] = fits[0] * scale
        noise[own], knots[own] = sigma, operators[0].apart * window.step
    orders[..., 0] += base
    return Fit(orders, covariance * np.outer(scale, scale), noise, knots, chosen == _first(scores))


def _try(operator: Operator, x: Array) -> tuple[Array, Array, Array]:
    """The criterion of cross-validation and the standard deviation of the residual of each column; coefficients."""
    free, counted = len(x) - operator.parameters, len(x) - COUNTED * operator.parameters
    never = np.full(x.shape[1], np.inf)
    if free <= 0 or operator.factor is None:
        return never, never, np.zeros((operator.parameters, x.shape[1]))
    c = operator.coefficients(x)
    squares = ((x - operator.values(c)) ** 2).sum(axis=0)
    return (squares / counted**2 if counted > 0 else never), np.sqrt(squares / free), c


def _chosen(scores: Array, cutoff: float | None) -> NDArray[np.intp]:
    """Which of the tries is taken for each column."""
    first = _first(scores)
    if cutoff is not None:
        return np.full(scores.shape[1], first)
    best: NDArray[np.intp] = np.argmin(scores, axis=0) - DENSER
    return np.maximum(best, first)


def _first(scores: Array) -> int:
    """The densest knots that are possible."""
    return int(np.argmax(np.isfinite(scores).all(axis=1)))


def _orders(operator: Operator, coefficients: Array) -> Array:
    return np.stack([basis @ coefficients for basis in operator.basis], axis=-1)


def _unfollowed(operators: Sequence[Operator], fits: Sequence[Array], variance: Array) -> Array:
    """The square of what a spline cannot follow, about, by what splines of wider knots cannot, (N, columns, 3).

    With knots twice as far apart it is r times as much, where r is at most `SMOOTHEST`, for smooth motion, and 1 at a
    jump; so the difference of both fits is r - 1 times as much.
    """
    if len(fits) < 3:
        return np.zeros(fits[0].shape)
    own, wider = (_beyond_noise(operators[k], operators[k + 1], fits[k] - fits[k + 1], variance) for k in range(2))
    with np.errstate(divide="ignore", invalid="ignore"):
        r = np.sqrt(wider.sum(axis=0) / own.sum(axis=0))
        r = np.where(np.isfinite(r), np.clip(r, 1.0, SMOOTHEST), SMOOTHEST)
        weight = np.minimum(1.0 / (r - 1.0) ** 2, MOST)
    return _most(weight * own, 2.0 * operators[0].apart)


def _beyond_noise(finer: Operator, wider: Operator, difference: Array, variance: Array) -> Array:
    """The mean square of a difference of two fits, less what noise makes of it: one's splines are the other's too."""
    own, other = (np.diagonal(x.covariance, axis1=1, axis2=2) for x in (finer, wider))
    noise = np.maximum(own - other, 0.0)[:, None] * variance[:, None]
    return np.maximum(_mean(difference**2, 2.0 * wider.apart) - noise, 0.0)


def _density(left: Array, spans: int) -> Array:
    """The standard deviation of white noise that is as strong as what is left just above the cut-off, (columns,).

    Filtered noise is stronger below a frequency than all of it says; where knots are chosen by the noise, it is taken
    as independent from row to row.
    """
    power = (np.abs(np.fft.rfft(left, axis=0)) ** 2 / len(left))[spans * 3 // 4 : 2 * spans]
    return np.asarray(np.sqrt(power.mean(axis=0))) if len(power) else np.zeros(left.shape[1])


def _mean(x: Array, width: float) -> Array:
    """Of neighbours, so many in all."""
    from scipy.ndimage import uniform_filter1d

    return np.asarray(np.maximum(uniform_filter1d(x, _odd(width, len(x)), axis=0, mode="reflect"), 0.0))


def _most(x: Array, width: float) -> Array:
    """Among neighbours, so many in all."""
    from scipy.ndimage import maximum_filter1d

    return np.asarray(maximum_filter1d(x, _odd(width, len(x)), axis=0))


def _odd(width: float, most: int) -> int:
    return min(max(int(width), 1), most) | 1


def _grain(x: Array) -> float:
    """The standard deviation of rounding to the steps of a sensor; 0 where samples are no multiples of a step."""
    values = np.unique(x)
    if len(values) < 2:
        return 0.0
    step = float(np.diff(values).min())
    multiples = (values - values[0]) / step
    return step / math.sqrt(12.0) if np.abs(multiples - np.round(multiples)).max() < MULTIPLE else 0.0
