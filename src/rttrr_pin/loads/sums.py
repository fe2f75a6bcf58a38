"""Peaks and sums over a trajectory, block by block, of columns whose powers no float64 may hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.loads.parts import Level, Peak
from rttrr_pin.loads.rows import alone
from rttrr_pin.trajectories import Block

LOWEST = -1000
"""An exponent so low that no power of what is smaller vanishes, once divided by two to it."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A value and the row where it was seen.

    Attributes:
        value: the number.
        at: the row, alone in its block.
    """

    value: float
    at: Block


class Peaks:
    """The largest of each of several columns, and where it was first."""

    def __init__(self, count: int) -> None:
        self._places: list[Place | None] = [None] * count
        self._largest = np.full(count, -np.inf)

    def add(self, sizes: Array, values: Array, rows: Block) -> None:
        """Rows more.

        Args:
            sizes: by which one is larger than another, (n, N); what is no number is the largest.
            values: to remember, (n, N).
            rows: theirs.
        """
        if not sizes.size:
            return
        at = sizes.argmax(axis=1)  # of the first NaN, where there is one
        own = sizes[np.arange(len(sizes)), at]
        beyond = (own > self._largest) | (np.isnan(own) & ~np.isnan(self._largest))
        for k in np.flatnonzero(beyond):
            row = int(at[k])
            self._largest[k] = own[k]
            self._places[k] = Place(float(values[k, row]), alone(rows, row))

    def seen(self) -> list[Place]:
        """By column; after a row was added. A value of zero is that of the first row, and no reason to remember it."""
        assert None not in self._places
        return [place for place in self._places if place is not None]


class Scale:
    """The power of two that each of several columns is divided by, so that none is larger than 1."""

    def __init__(self, count: int) -> None:
        self.exponents = np.full(count, LOWEST)

    def add(self, sizes: Array) -> tuple[Array, Array]:
        """Sizes, (n, N), that are not negative, divided; and what sums of earlier ones must be multiplied by, (n,)."""
        _, exponents = np.frexp(sizes.max(axis=1, initial=0.0))
        larger = np.maximum(self.exponents, exponents)
        shrink = np.ldexp(1.0, self.exponents - larger)
        self.exponents = larger
        return sizes * np.ldexp(1.0, -larger)[:, None], shrink


class Means:
    """Root mean squares and cubic means of columns, weighted by time and, if there are rates, by those too."""

    def __init__(self, count: int) -> None:
        self._scale, self._rate_scale = Scale(count), Scale(count)
        self._squares, self._cubes, self._driven, self._rates = np.zeros((4, count))
        self._time = 0.0

    def add(self, sizes: Array, weights: Array, rates: Array | None = None) -> None:
        """Rows more.

        Args:
            sizes: magnitudes, (n, N).
            weights: the time of each row, (N,).
            rates: magnitudes of the rates that belong to them, (n, N).
        """
        own, shrink = self._scale.add(sizes)
        squares = own * own
        cubes = squares * own
        self._time += float(weights.sum())
        self._squares = self._squares * shrink**2 + _sums(squares, weights)
        self._cubes = self._cubes * shrink**3 + _sums(cubes, weights)
        if rates is not None:
            moved, slower = self._rate_scale.add(rates)
            self._rates = self._rates * slower + _sums(moved, weights)
            cubes *= moved
            self._driven = self._driven * shrink**3 * slower + _sums(cubes, weights)

    def level(self, k: int, unit: str, peak: Peak) -> Level:
        """The size of a column."""
        return Level(unit, peak, float(self.rms[k]), float(self.cubic[k]))

    @property
    def rms(self) -> Array:
        """(sum w x^2 / sum w)^(1/2)."""
        return np.asarray(np.ldexp(np.sqrt(self._squares / self._time), self._scale.exponents))

    @property
    def cubic(self) -> Array:
        """(sum w |x|^3 / sum w)^(1/3)."""
        return np.asarray(np.ldexp(np.cbrt(self._cubes / self._time), self._scale.exponents))

    @property
    def cubic_by_rate(self) -> Sequence[float | None]:
        """(sum w |v x^3| / sum w |v|)^(1/3); None where all rates are zero."""
        with np.errstate(invalid="ignore", divide="ignore"):
            means = np.ldexp(np.cbrt(self._driven / self._rates), self._scale.exponents)
        return [float(x) if rate else None for x, rate in zip(means, self._rates, strict=True)]

    @property
    def mean_rates(self) -> Array:
        """Sum w |v| / sum w."""
        return np.asarray(np.ldexp(self._rates / self._time, self._rate_scale.exponents))


class Integral:
    """The integral over time of columns, row by row, by the trapezoidal rule."""

    def __init__(self) -> None:
        self._time, self._rates, self._total = 0.0, np.zeros(0), np.zeros(0)

    def add(self, time: Array, rates: Array) -> Array:
        """The integral up to each of some rows more, (N, n); zero in the first of all."""
        if not self._rates.size:
            self._time, self._rates, self._total = float(time[0]), rates[0], np.zeros(rates.shape[1])
        steps = np.diff(time, prepend=self._time)
        means = (rates + np.concatenate([self._rates[None], rates[:-1]])) / 2
        with np.errstate(over="ignore", invalid="ignore"):
            grown = np.cumsum(np.concatenate([self._total[None], means * steps[:, None]]), axis=0)[1:]
        self._time, self._rates, self._total = float(time[-1]), rates[-1].copy(), grown[-1].copy()
        return grown


def _sums(terms: Array, weights: Array) -> Array:
    total: Array = (terms * weights).sum(axis=1)
    return total
