"""Files: JSON, text that is written whole or not at all, and reading that comes to an end."""

from __future__ import annotations

import json
import math
import os
import select
import tempfile
import time
from pathlib import Path
from typing import Any

from rttrr_pin.errors import InputError
from rttrr_pin.reporting.interrupts import held_back, put_in_place

PARTIAL = ".rttrr-pin."
"""What the name of a file that is not whole yet begins with; short, since the target's may be as long as one may be."""


def as_json(data: dict[str, Any]) -> str:
    """JSON text; what JSON has no number for is written as text ("inf")."""
    return json.dumps(_finite(data), indent=2, allow_nan=False) + "\n"


def write_whole(path: Path, text: str) -> None:
    """Write a file whole or not at all, however the process ends.

    Raises:
        InputError: the folder does not exist or cannot be written to.
    """
    target = path.resolve()  # a link stays a link
    try:
        if target.exists() and not target.is_file():
            put_in_place(str(path))
            target.write_text(text, encoding="utf-8")  # a pipe or a device is written to, not replaced
            return
        with held_back():
            _replace(target, text)
            put_in_place(str(path))
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror}; choose another file") from error


PATIENCE = 5.0
"""Seconds that a pipe or a device may take."""


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
    raise InputError(f"it has more than {most:,} bytes; give a shorter file")


def _replace(target: Path, text: str) -> None:
    """A file beside the target, moved there once it is whole."""
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=PARTIAL)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        umask = os.umask(0)
        os.umask(umask)
        Path(name).chmod(target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~umask)
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _finite(data: Any) -> Any:
    """The same data with text in place of NaN and infinities."""
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    if isinstance(data, float) and not math.isfinite(data):
        return str(data)
    return data
