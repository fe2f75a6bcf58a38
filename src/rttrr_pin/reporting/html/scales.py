"""Scales of charts: from numbers to places on the paper, and where the ticks stand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arrays import Array

LEAST = 2e-3
"""Of the size of the numbers: what half a scale spans at least, so that its ticks differ in four digits."""


@dataclass(frozen=True, slots=True)
class Scale:
    """A straight or logarithmic scale.

    Attributes:
        low, high: the numbers at its ends.
        start, end: their places.
        log: whether equal lengths are equal ratios.
    """

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def __call__(self, values: ArrayLike) -> Array:
        """The places of numbers; NaN and infinities have none."""
        x = np.asarray(values, dtype=np.float64)
        low, high = self.low, self.high
        if self.log:
            with np.errstate(divide="ignore", invalid="ignore"):
                x, low, high = np.log10(x), math.log10(low), math.log10(high)
        size = max(abs(low), abs(high), 1e-300)
        share = (x / size - low / size) / (high / size - low / size)
        return self.start + share * (self.end - self.start)

    def at(self, value: float) -> float:
        """The place of one number."""
        return float(self(value))

    def ticks(self, most: int = 6) -> list[float]:
        """Round numbers on the scale."""
        if not self.log:
            return ticks(self.low, self.high, most)
        first, last = math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9)
        step = max(1, math.ceil((last - first + 1) / most))
        return [10.0**k for k in range(first, last + 1) if k % step == 0]


def ticks(low: float, high: float, most: int = 6) -> list[float]:
    """Round numbers from low to high: multiples of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / most
    if not 0.0 < rough < math.inf:
        return [low]
    power = 10.0 ** math.floor(math.log10(rough))
    step = next((k * power for k in (1, 2, 5, 10) if k * power >= rough * (1 - 1e-9)), 10 * power)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def linear(values: Sequence[ArrayLike], start: float, end: float, margin: float = 0.06) -> Scale:
    """A scale on which all finite numbers fit, with a margin on both sides."""
    low, high = span(values)
    size = max(abs(low), abs(high)) or 1.0
    half = max((high - low) * (0.5 + margin), size * LEAST)
    middle = low / 2 + high / 2
    return Scale(max(middle - half, -1.7e308), min(middle + half, 1.7e308), start, end)


def span(values: Sequence[ArrayLike]) -> tuple[float, float]:
    """The least and the largest finite number; 0 and 1 where there is none."""
    low, high = math.inf, -math.inf
    for own in values:
        x = np.asarray(own, dtype=np.float64)
        x = x[np.isfinite(x)]
        if x.size:
            low, high = min(low, float(x.min())), max(high, float(x.max()))
    return (low, high) if low <= high else (0.0, 1.0)


def label(value: float) -> str:
    """A number beside a tick, a bar or a name."""
    words = f"{value:.4g}"
    mantissa, e, exponent = words.partition("e")
    return f"{mantissa}e{int(exponent)}" if e else words.replace("-0", "0") if words == "-0" else words


def power(value: float) -> str:
    """A power of ten beside a tick of a logarithmic scale."""
    exponent = round(math.log10(value))
    return label(10.0**exponent) if -3 <= exponent <= 4 else f"1e{exponent}"
