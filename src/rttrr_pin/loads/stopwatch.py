"""Where the time of a run goes."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

T = TypeVar("T")


class Stopwatch:
    """Seconds by what was done in them."""

    def __init__(self) -> None:
        self._seconds: dict[str, float] = defaultdict(float)

    def timed(self, what: str, work: Callable[[], T]) -> T:
        """Do it."""
        started = time.perf_counter()
        result = work()
        self._seconds[what] += time.perf_counter() - started
        return result

    def each(self, what: str, items: Iterable[T]) -> Iterator[T]:
        """The items; what it takes to make them counts."""
        waiting = iter(items)
        while True:
            item = self.timed(what, lambda: next(waiting, None))
            if item is None:
                return
            yield item

    @property
    def seconds(self) -> dict[str, float]:
        """So far."""
        return dict(self._seconds)
