"""What the commands share: exit codes, a console whose reader may leave, a progress bar, text to a file or stdout."""

from __future__ import annotations

import io
import os
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from rttrr_pin.reporting.files import as_json, write_whole

AGREE, DISAGREE, UNUSABLE = 0, 1, 2

SHOW_PROGRESS_AFTER = 1.0
"""Seconds."""


COMMANDS = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]"
)
"""What a terminal obeys instead of showing it, and XML has no place for: control characters, marks of direction, halves
of characters, and no characters."""


def shown(text: str) -> str:
    """A text that a terminal only shows, whatever names are in it."""
    return COMMANDS.sub("?", text)


class Output(Console):
    """Standard output that obeys no text that it prints.

    Its reader may leave early, as `head` does: the exit code stays that of the verdict.
    """

    def __init__(self, **options: Any) -> None:
        """As rich's console, but for names of pictures between colons, which may be names of links."""
        super().__init__(emoji=False, **options)

    def print(self, *objects: Any, **options: Any) -> None:
        """Print, unless it is quiet: rich would lay everything out all the same."""
        if not self.quiet:
            super().print(*objects, **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterator[Segment]:
        """The pieces of what is printed, in each of which names of files may stand."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=shown(segment.text))

    def on_broken_pipe(self) -> None:
        """Throw away what follows."""
        discard_stdout()


def open_streams() -> None:
    """Streams that take every text: a closed one goes nowhere, and one in ASCII gets a name's other letters escaped."""
    while (free := os.open(os.devnull, os.O_RDWR)) <= 2:  # else what is opened later would get what C prints
        pass
    os.close(free)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8"))
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def discard_stdout() -> None:
    """What is still to be written goes nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextmanager
def progress(total: int | None, quiet: bool, what: str = "states") -> Iterator[Any]:
    """A function to call with the number done; it shows a bar on stderr once the run has lasted a second.

    Without a total it shows the number and the time.
    """
    started = time.monotonic()
    bar: Any = None

    def advance(done: int) -> None:
        nonlocal bar
        if quiet or not sys.stderr.isatty() or time.monotonic() - started < SHOW_PROGRESS_AFTER:
            return
        if bar is None:
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

            of = "" if total is None else " of {task.total:,}"
            time_shown = TimeElapsedColumn() if total is None else TimeRemainingColumn()
            columns = (TextColumn("{task.completed:,}" + f"{of} {what}"), BarColumn(), time_shown)
            bar = Progress(*columns, console=Console(stderr=True), transient=True)
            bar.start()
            bar.add_task("", total=total)
        bar.update(bar.task_ids[0], completed=done)

    try:
        yield advance
    finally:
        if bar is not None:
            bar.stop()


def write_json(target: str | None, data: Callable[[], dict[str, Any]]) -> None:
    """JSON to stdout or, whole or not at all, to a file."""
    write_text(target, lambda: as_json(data()))


def write_text(target: str | None, text: Callable[[], str]) -> None:
    """Text to stdout or, whole or not at all, to a file."""
    if target == "-":
        try:
            sys.stdout.write(text())
            sys.stdout.flush()
        except BrokenPipeError:
            discard_stdout()
    elif target is not None:
        write_whole(Path(target), text())
