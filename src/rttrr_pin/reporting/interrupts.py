"""Ctrl-C and SIGTERM: wherever one arrives, the program ends with its exit code and a true sentence.

A signal becomes an exception in the middle of whatever runs. Two places must not see it. An import, since libraries
catch BaseException while they import, so that the signal would be lost, or a module stay half made; and the few lines
that put a file, or a process, in its place. There it waits until they are over. A second signal does not wait.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

ENDING: dict[int, str] = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
"""The signals that end a program, and what that is called."""

SHELL = 128
"""What a shell adds to the number of the signal that ended a program."""

POLL = 0.02
"""Seconds after which it is looked again whether a signal that waits can be delivered."""

LONGEST_IMPORT = 20.0
"""Seconds that an import may hold up a signal: a user's own module may never come back."""


class Interrupted(KeyboardInterrupt):
    """A signal that ends the program."""


class _Run:
    """The signals of a run of the program, and what it has put in place."""

    def __init__(self) -> None:
        self.received: list[int] = []
        self.written: list[str] = []
        self.holding = 0
        self.deadline = 0.0

    def arrived(self, number: int, frame: FrameType | None) -> None:
        """The handler of a signal: raise, or look again soon."""
        self.received.append(number)
        self.deadline = time.monotonic() + LONGEST_IMPORT
        if len(self.received) > 1:
            signal.setitimer(signal.ITIMER_REAL, 0)
            raise Interrupted(number)
        self.deliver(number, frame)

    def deliver(self, _: int, frame: FrameType | None) -> None:
        """Raise for the first signal, unless it has to wait."""
        if self.holding or (_importing(frame) and time.monotonic() < self.deadline):
            signal.setitimer(signal.ITIMER_REAL, POLL)
        else:
            raise Interrupted(self.received[0])


_run: _Run | None = None


def _importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def install() -> Callable[[], None]:
    """From here on the signals of `ENDING` raise `Interrupted`, but for those that are ignored.

    Only the main thread can say what signals do, and once is enough: else nothing changes.

    Returns:
        What undoes it.
    """
    global _run
    if _run is not None or threading.current_thread() is not threading.main_thread():
        return lambda: None
    own = _run = _Run()
    wanted = [number for number in ENDING if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, own.arrived) for number in wanted}
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, own.deliver)

    def undo() -> None:
        global _run
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)
        _run = None

    return undo


def ignore() -> None:
    """From here on the process ends by itself: a signal would only cut off its last breath."""
    signal.setitimer(signal.ITIMER_REAL, 0)  # of a signal that waits: Python's end would leave it to the system's rule
    for number in (*ENDING, signal.SIGALRM):
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def held_back() -> Iterator[None]:
    """Within, signals wait: for lines that take milliseconds and must not be left half done."""
    own = _run
    if own is None:
        yield
        return
    own.holding += 1
    try:
        yield
    finally:
        own.holding -= 1


def put_in_place(name: str) -> None:
    """Remember an output, so that the last sentence of an interrupted program is true."""
    if _run is not None:
        _run.written.append(name)


def ending(otherwise: int = 0) -> tuple[int, str]:
    """The exit code and the last sentence of a program that a signal ends; 0 and no sentence where none does.

    It is the first signal of this run, also where a library swallowed its exception.

    Args:
        otherwise: the signal to take where none was noticed.
    """
    number = _run.received[0] if _run is not None and _run.received else otherwise
    if not number:
        return 0, ""
    written = [] if _run is None else _run.written
    done = f"{', '.join(written)} written, nothing else" if written else "nothing was written"
    return SHELL + number, f"{ENDING[number]}: {done}"
