"""What bounds any kernel: the memory it streams through, and the memory there is."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ARRAYS = 30
"""Arrays of (N, nv) doubles that a run holds at its peak: states, their making, both layouts, Pinocchio's, results."""


def copy(q: Array, v: Array, a: Array, threads: int) -> Callable[[], object]:
    """A function that reads q, v, a and writes as much as tau once, and computes next to nothing."""
    tau = np.zeros_like(v)
    pieces = [tuple(part) for part in zip(*(np.array_split(x, threads) for x in (q, v, a, tau)), strict=True)]

    def piece(q: Array, v: Array, a: Array, tau: Array) -> None:
        np.add(q, v, out=tau)
        a.sum()

    if threads == 1:
        return lambda: piece(*pieces[0])
    pool = ThreadPoolExecutor(threads)
    return lambda: [done.result() for done in [pool.submit(piece, *part) for part in pieces]]


def available_states(wanted: int, nv: int) -> int:
    """As many states as wanted, or as half of the free memory holds."""
    info = Path("/proc/meminfo")
    free = [line.split()[1] for line in info.read_text().splitlines() if line.startswith("MemAvailable")]
    return min(wanted, int(free[0]) * 1024 // 2 // (8 * nv * ARRAYS)) if free else wanted
