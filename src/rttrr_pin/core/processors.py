"""How many processors this process uses at once."""

from __future__ import annotations

import os

_most: int | None = None


def use_at_most(processors: int) -> None:
    """Share the machine: one of several processes that work side by side uses no more than its part."""
    global _most
    _most = processors


def processors() -> int:
    """How many processors this process may use, by what the system grants it and by what it was told."""
    granted = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return granted if _most is None else min(granted, _most)
