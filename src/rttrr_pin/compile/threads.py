"""Parts of a batch on several threads.

Which thread computes a state has no influence on its bits, so parts are handed out as threads become free.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.processors import processors

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

COMPILING = threading.RLock()
"""Held while a program is compiled, loaded or given up. A fork waits for it: a child that was forked in the middle
would inherit the compiler's locks, and nobody who lets go of them."""

os.register_at_fork(before=COMPILING.acquire, after_in_parent=COMPILING.release, after_in_child=COMPILING.release)

PART = 8192
"""States in a part: a millisecond or so, after which Ctrl-C is heard."""

WORTH_A_THREAD = 100_000
"""Numbers in and out below which a second thread costs more than it brings."""


MOST = 4096
"""Threads that may be asked for."""


def count(threads: int | None, numbers: int) -> int:
    """How many threads to use.

    Args:
        threads: as the user asks; None for as many as pay.
        numbers: numbers in and out of the batch.

    Raises:
        InputError: threads is no positive whole number.
    """
    if threads is not None:
        return whole_number("threads", threads, 1, MOST)
    return max(1, min(processors(), numbers // WORTH_A_THREAD))


def run(task: Callable[[int, int], bool], rows: int, threads: int) -> bool:
    """Run a task on all parts of a batch; tells whether one of them said True."""
    starts = range(0, rows, PART)
    if threads == 1 or len(starts) == 1:
        return True in [task(start, min(start + PART, rows)) for start in starts]
    pool = _pool(threads, os.getpid())
    parts: list[Future[bool]] = [pool.submit(task, start, min(start + PART, rows)) for start in starts]
    try:
        return True in [part.result() for part in parts]
    finally:
        for part in parts:
            part.cancel()


@lru_cache(maxsize=4)
def _pool(threads: int, process: int) -> ThreadPoolExecutor:
    """Threads that wait for work; a forked process gets its own."""
    from concurrent.futures import ThreadPoolExecutor  # not needed where one thread does

    return ThreadPoolExecutor(threads, thread_name_prefix="rttrr-pin")
