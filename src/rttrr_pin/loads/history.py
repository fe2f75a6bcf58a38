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
        self._low, self._high, self._time = (np.zeros((0, 0)),) * 3  # by number, and bucket; first and last time

    def add(self, rows: Block, tau: Array, half_width: Array | None) -> None:
        """Block more.

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
        if inside:
            low[:, 0] = np.minimum(low[:, 0], self._low[:, -1])
            high[:, 0] = np.maximum(high[:, 0], self._high[:, -1])
            time[0, 0] = self._time[0, -1]
        self._low, self._high, self._time = (
            np.concatenate([old[:, : old.shape[1] - bool(inside)].reshape(len(new), -1), new], axis=1)
            for old, new in ((self._low, low), (self._high, high), (self._time, time))
        )
        self._rows += len(rows)
        while self._time.shape[1] > MOST_BUCKETS:
            self._merge()

    def _merge(self) -> None:
        pairs = np.arange(0, self._time.shape[1], 2)
        self._low = np.minimum.reduceat(self._low, pairs, axis=1)
        self._high = np.maximum.reduceat(self._high, pairs, axis=1)
        last = np.minimum(pairs + 1, self._time.shape[1] - 1)
        self._time = np.array([self._time[0, pairs], self._time[1, last]])
        self._size *= 2

    def history(self, nv: int) -> History:
        """What there is so far."""
        banded = len(self._low) > nv
        low, high = self._low.T, self._high.T
        return History(
            time=self._time[0] + (self._time[1] - self._time[0]) / 2,
            low=low[:, :nv].copy(),
            high=high[:, :nv].copy(),
            band_low=low[:, nv:].copy() if banded else None,
            band_high=high[:, nv:].copy() if banded else None,
            rows=self._size,
        )


class Sampling:
    """Every 2^k-th row; k grows by one whenever there are too many."""

    def __init__(self) -> None:
        self._step, self._count = 1, 0
        self._parts: list[tuple[NDArray[Any], ...]] = []

    def add(self, rows: Block, tau: Array) -> None:
        """Block more, with tau (N, nv)."""
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
