"""Files that are read: how many bytes of them, how long they are waited for, and which they were."""

from __future__ import annotations

import os
import select
import stat
import time
from pathlib import Path

from rttrr_pin.errors import InputError

PATIENCE = 5.0
"""Seconds that a pipe or a device may take."""

_read: set[object] = set()


def identity(path: Path) -> object:
    """What two names of one file share; None for a device or a pipe, which overwrites nothing, and no file's name."""
    try:
        status = path.stat()
    except OSError:
        return os.path.realpath(path)
    except ValueError:  # a character that no name of a file has
        return None
    return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None


def note_read(path: Path) -> None:
    """Remember a file, so that no output overwrites it."""
    _read.add(identity(path))


def was_read(path: Path) -> bool:
    """Whether it was read since `forget_reads`."""
    return (own := identity(path)) is not None and own in _read


def forget_reads() -> None:
    """From here on, another run."""
    _read.clear()


def read_limited(path: Path, most: int) -> bytes:
    """The bytes of a file, or of a pipe or a device, which may have no end and may never say anything.

    Raises:
        OSError: it cannot be read.
        InputError: there are more than `most` bytes, or they do not come.
    """
    end = time.monotonic() + PATIENCE
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # a pipe that nobody writes to is opened all the same
    parts: list[bytes] = []
    size = 0
    try:
        note_read(path)
        while size <= most:
            if not select.select([handle], [], [], max(0.0, end - time.monotonic()))[0]:
                raise InputError(f"its text does not come within {PATIENCE:g} s; give a file")
            part = os.read(handle, 1 << 16)
            if not part:
                return b"".join(parts)
            parts.append(part)
            size += len(part)
    finally:
        os.close(handle)
    raise InputError(f"it has more than {most / 2**20:g} MiB; give a shorter file")
