"""Files that are written: JSON; text and bytes, whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from rttrr_pin.errors import InputError
from rttrr_pin.reporting.interrupts import held_back, put_in_place

PARTIAL = ".rttrr-pin."
"""What the name of a file that is not whole yet begins with; short, since the target's may be as long as one may be."""


def as_json(data: dict[str, Any]) -> str:
    """JSON text of data that are `finite`."""
    return json.dumps(data, indent=2, allow_nan=False) + "\n"


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file whole or not at all, however the process ends.

    Raises:
        InputError: the folder does not exist or cannot be written to.
    """
    target = Path(os.path.realpath(path))  # a link stays a link
    try:
        if target.exists() and not target.is_file():
            put_in_place(str(path))
            target.write_bytes(_bytes(content))  # a pipe or a device is written to, not replaced
            return
        with held_back():
            _replace(target, _bytes(content))
            put_in_place(str(path))
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror}; choose another file") from error


def _bytes(content: str | bytes) -> bytes:
    """Text as UTF-8, which has no place for halves of characters."""
    return content if isinstance(content, bytes) else content.encode("utf-8", "backslashreplace")


def _replace(target: Path, content: bytes) -> None:
    """A file beside the target, moved there once it is whole."""
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=PARTIAL)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        umask = os.umask(0)
        os.umask(umask)
        Path(name).chmod(target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~umask)
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
