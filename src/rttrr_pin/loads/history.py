"""What a picture of a trajectory needs, in a memory that does not grow with it: buckets of rows, and every k-th row."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.loads.results import History, Samples
from rttrr_pin.trajectories import Block

MOST_BUCKETS = 1024
"""Beyond it they are merged in pairs."""

MOST_SAMPLES = 2048
"""Beyond it every other one is dropped."""


class Buckets:
    """tau over time, in buckets of 2^k rows each; k grows by one whenever there are too many of them."""

    def __init__(self) -> None:
        self._size, self._rows = 1, 0
        self._kept: tuple[Array, Array, Array] | None = None
        """Lowest and highest of each number in each bucket, (n, B); first and last time, (2, B)."""

    def add(self, rows: Block, tau: Array, half_width: Array | None) -> None:
        """Rows more.

        Args:
            rows: theirs is the time.
            tau: (N, nv).
            half_width: of the band of 95 percent, (N, nv); None where there is none, then in all blocks.
        """
        inside = -self._rows % self._size  # rows that the last bucket still takes
        starts = np.arange(inside, len(rows), self._size)
        starts = np.concatenate([[0], starts]) if inside else starts
        lows, highs = [tau.T], [tau.T]
        if half_width is not None:
            lows.append((tau - half_width).T)
            highs.append((tau + half_width).T)
        low = np.minimum.reduceat(np.concatenate(lows), starts, axis=1)
        high = np.maximum.reduceat(np.concatenate(highs), starts, axis=1)
        time = np.array([rows.time[starts], rows.time[np.append(starts[1:], len(rows)) - 1]])
        if self._kept is not None:
            before = self._kept
            if inside:
                low[:, 0] = np.minimum(low[:, 0], before[0][:, -1])
                high[:, 0] = np.maximum(high[:, 0], before[1][:, -1])
                time[0, 0] = before[2][0, -1]
            kept = slice(None, -1 if inside else None)
            pairs = zip(before, (low, high, time), strict=True)
            low, high, time = (np.concatenate([x[:, kept], y], axis=1) for x, y in pairs)
        self._rows += len(rows)
        while time.shape[1] > MOST_BUCKETS:
            low, high, time = _merged(low, high, time)
            self._size *= 2
        self._kept = low, high, time

    def history(self, nv: int) -> History:
        """What there is so far."""
        assert self._kept is not None
        low, high, (first, last) = self._kept[0].T, self._kept[1].T, self._kept[2]
        banded = low.shape[1] > nv
        return History(
            time=first + (last - first) / 2,
            low=low[:, :nv].copy(),
            high=high[:, :nv].copy(),
            band_low=low[:, nv:].copy() if banded else None,
            band_high=high[:, nv:].copy() if banded else None,
            rows=self._size,
        )


def _merged(low: Array, high: Array, time: Array) -> tuple[Array, Array, Array]:
    """Buckets in pairs; the last may stay alone."""
    count = time.shape[1]
    pairs = np.arange(0, count, 2)
    last = np.minimum(pairs + 1, count - 1)
    return (
        np.minimum.reduceat(low, pairs, axis=1),
        np.maximum.reduceat(high, pairs, axis=1),
        np.array([time[0, pairs], time[1, last]]),
    )


class Sampling:
    """Every 2^k-th row; k grows by one whenever there are too many."""

    def __init__(self) -> None:
        self._step, self._count = 1, 0
        self._parts: list[tuple[NDArray[Any], ...]] = []

    def add(self, rows: Block, tau: Array) -> None:
        """Rows more, with tau (N, nv)."""
        every = slice(-rows.start % self._step, None, self._step)
        part = tuple(x[every].copy() for x in (rows.rows, rows.time, rows.q, rows.v, tau))
        self._parts.append(part)
        self._count += len(part[0])
        while self._count > MOST_SAMPLES:
            self._parts = [tuple(x[::2] for x in self._joined())]
            self._step *= 2
            self._count = len(self._parts[0][0])

    def _joined(self) -> list[NDArray[Any]]:
        return [np.concatenate(parts) for parts in zip(*self._parts, strict=True)]

    def samples(self) -> Samples:
        """What there is so far."""
        row, *others = self._joined()
        return Samples(row, *others)
