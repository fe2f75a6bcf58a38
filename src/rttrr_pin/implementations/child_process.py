"""A running program of the user's: lines to it and from it, each with a limit of time, and its end in any case."""

from __future__ import annotations

import math
import os
import select
import subprocess
import time
import tty
from collections.abc import Iterator, Sequence
from contextlib import suppress

LONGEST_REPLY = 1_000_000
"""Bytes of one reply; thousands of links need fewer."""

TAIL = 2000
"""Characters of stderr that an error shows."""

PATIENCE = 0.5
"""Seconds that a program has to leave once its input has ended."""


class ReplyError(Exception):
    """No result was had of a program; the message continues a sentence that begins with its name."""


class Child:
    """A running program: lines to it and from it, each with a limit of time."""

    def __init__(self, words: Sequence[str]) -> None:
        # A terminal instead of a pipe: most languages then write each line at once, without being told to flush.
        self._output, terminal = os.openpty()
        try:
            tty.setraw(terminal)
            self._process = subprocess.Popen(
                words, stdin=subprocess.PIPE, stdout=terminal, stderr=subprocess.PIPE, bufsize=0, start_new_session=True
            )
        except (OSError, ValueError, IndexError) as error:
            os.close(self._output)
            raise ReplyError(f"cannot be started: {getattr(error, 'strerror', None) or error}") from None
        finally:
            os.close(terminal)
        assert self._process.stdin is not None
        assert self._process.stderr is not None
        self._stdin, self._stderr = self._process.stdin, self._process.stderr
        for pipe in (self._stdin, self._stderr):
            os.set_blocking(pipe.fileno(), False)
        self._unsent, self._received, self._tail = b"", b"", b""

    def ask(self, requests: Sequence[bytes], seconds: float, start: float) -> Iterator[str]:
        """A line for each line, which are all written as fast as the program reads.

        The first must come within `start` seconds, each other within `seconds` from the one before.
        """
        self._unsent = b""
        self._exchange(0.001)
        self._check_silent()
        self._unsent = b"".join(requests)
        for k in range(len(requests)):
            yield self._line(start if k == 0 else seconds)
        self._check_silent()

    def _check_silent(self) -> None:
        if self._unsent or self._received.strip():
            raise ReplyError(f"wrote more lines than it has read states: {_shown(self._received)}")

    def _line(self, seconds: float) -> str:
        deadline = time.monotonic() + seconds
        while True:
            line, end, after = self._received.partition(b"\n")
            if end:
                self._received = after
                if line.strip():
                    return line.decode(errors="replace")
            elif len(self._received) > LONGEST_REPLY:
                raise ReplyError(f"wrote more than {LONGEST_REPLY:,} bytes for a state: {_shown(self._received)}")
            elif not self._exchange(deadline - time.monotonic()):
                raise ReplyError(
                    f"did not reply within {seconds:g} s: it must write a line for each state, and flush it"
                )

    def _exchange(self, seconds: float) -> bool:
        """Wait until something can be written or read, and do it; whether that was so in time."""
        if seconds <= 0:
            return False
        waiting = select.poll()
        waiting.register(self._output, select.POLLIN)
        if not self._stderr.closed:
            waiting.register(self._stderr, select.POLLIN)
        if self._unsent:
            waiting.register(self._stdin, select.POLLOUT)
        ready = {descriptor for descriptor, _ in waiting.poll(math.ceil(1000 * seconds))}
        if not self._stderr.closed and self._stderr.fileno() in ready:
            self._read_stderr()
        if self._unsent and self._stdin.fileno() in ready:
            try:
                self._unsent = self._unsent[os.write(self._stdin.fileno(), self._unsent) :]
            except BrokenPipeError:  # it reads no more, and may have replied all the same
                self._unsent = b""
        if self._output in ready:
            received = b""
            with suppress(OSError):  # Linux's word for the end of a terminal
                received = os.read(self._output, 65536)
            if not received:
                raise ReplyError(self._ended())
            self._received += received
        return bool(ready)

    def _read_stderr(self) -> None:
        text = self._stderr.read(65536)
        if text == b"":
            self._stderr.close()
        elif text:
            self._tail = (self._tail + text)[-TAIL:]

    def _ended(self) -> str:
        """How the program ended, as the rest of a sentence."""
        try:
            code = self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            return "closed its output"
        return f"was ended by signal {-code}" if code < 0 else f"ended with exit code {code}"

    def end(self, patience: float = 0.0) -> str:
        """End it, with all that it has started, after its input if there is patience; the end of its stderr."""
        if self._output < 0:
            return ""
        if patience:  # else at once, so that the end of its input leaves no trace on its stderr
            self._stdin.close()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(patience)
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, 9)
        self._process.wait()
        self._stdin.close()
        if not self._stderr.closed:
            self._read_stderr()
            self._stderr.close()
        os.close(self._output)
        self._output = -1
        return self._tail.decode(errors="replace").strip()


def _shown(received: bytes) -> str:
    """The beginning of what was received."""
    return repr(received[:80].decode(errors="replace"))
