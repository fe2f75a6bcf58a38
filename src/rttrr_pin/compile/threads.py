"""Parts of a batch on several threads.

Which thread computes a state has no influence on its bits, so parts are handed out as threads become free.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Iterable
from functools import lru_cache
from queue import SimpleQueue

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.processors import processors

COMPILING = threading.RLock()
"""Held while a program is compiled, loaded or given up. A fork waits for it: a child that was forked in the middle
would inherit the compiler's locks, and nobody who lets go of them."""

os.register_at_fork(before=COMPILING.acquire, after_in_parent=COMPILING.release, after_in_child=COMPILING.release)

PART = 8192
"""States in a part: a millisecond or so, after which Ctrl-C is heard."""

LEAST, ROUND = 512, 64
"""States in the smallest part, and of what their number is a multiple."""

WORTH_A_THREAD = 40_000
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
    """Run a task on all parts of a batch; tells whether one of them said True.

    The calling thread takes parts like the others, so that nothing waits for a thread that is slow to wake.
    """
    turns = -(-rows // (PART * threads))
    size = max(-(-rows // (turns * threads * ROUND)) * ROUND, LEAST)  # as many parts for each thread
    starts = range(0, rows, size)
    if threads == 1 or len(starts) == 1:
        return True in [task(start, min(start + size, rows)) for start in starts]
    batch = _Batch(task, [(start, min(start + size, rows)) for start in starts])
    try:
        _helpers(os.getpid()).ask(batch.take_parts, min(threads, len(starts)) - 1)
        batch.take_parts()
        return batch.result(len(starts))
    finally:
        batch.parts.clear()


class _Batch:
    """Parts that threads take as they become free.

    Attributes:
        parts: those that nobody has taken.
    """

    def __init__(self, task: Callable[[int, int], bool], parts: Iterable[tuple[int, int]]) -> None:
        self._task, self.parts = task, deque(parts)
        self._done: SimpleQueue[bool | BaseException] = SimpleQueue()

    def take_parts(self) -> None:
        """Until none is left."""
        while True:
            try:
                part = self.parts.popleft()
            except IndexError:
                return
            try:
                self._done.put(self._task(*part))
            except BaseException as error:  # also Ctrl-C: whoever called hears it
                self.parts.clear()
                self._done.put(error)

    def result(self, count: int) -> bool:
        """Whether a part said True, once all have answered; what one of them raised is raised."""
        found = False
        for _ in range(count):
            answer = self._done.get()
            if isinstance(answer, BaseException):
                raise answer
            found = found or answer
        return found


class _Helpers:
    """Threads that wait for work."""

    def __init__(self) -> None:
        self._work: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._count, self._lock = 0, threading.Lock()

    def ask(self, work: Callable[[], None], threads: int) -> None:
        """Let so many do the same work."""
        with self._lock:
            while self._count < threads:
                self._count += 1
                threading.Thread(target=self._wait, name=f"rttrr-pin-{self._count}", daemon=True).start()
        for _ in range(threads):
            self._work.put(work)

    def _wait(self) -> None:
        while True:
            self._work.get()()  # no name: what is done is not kept while it waits


@lru_cache(maxsize=1)
def _helpers(process: int) -> _Helpers:
    """Those of a process; a forked one gets its own."""
    return _Helpers()
