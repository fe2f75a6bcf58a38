"""Files that are written: JSON; text and bytes, whole or not at all."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
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
    with whole_file(path) as own, writing(path):
        own.write_bytes(_bytes(content))


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file to write in pieces, which takes the place of `path` once all is written; nothing is left of it else.

    Raises:
        InputError: the folder does not exist or cannot be written to, or the disk is full.
    """
    target = Path(os.path.realpath(path))  # a link stays a link
    special = target.exists() and not target.is_file()  # a pipe or a device is written to, not replaced
    own: Path | None = None
    try:
        with held_back(), writing(path):  # else a signal could leave a file whose name nobody knows yet
            handle, name = tempfile.mkstemp(dir=None if special else target.parent, prefix=PARTIAL)
            own = Path(name)
            os.close(handle)
        yield own
        if special:
            put_in_place(str(path))
            with writing(path), own.open("rb") as source, target.open("wb") as sink:
                shutil.copyfileobj(source, sink)
            return
        with held_back(), writing(path):
            _replace(target, own)
            put_in_place(str(path))
    finally:
        if own is not None:
            own.unlink(missing_ok=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Within, what the system refuses is said of this file.

    Raises:
        InputError: it cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}; choose another file") from error


def _bytes(content: str | bytes) -> bytes:
    """Text as UTF-8, which has no place for halves of characters."""
    return content if isinstance(content, bytes) else content.encode("utf-8", "backslashreplace")


def _replace(target: Path, whole: Path) -> None:
    """A file beside the target in its place, with its mode."""
    umask = os.umask(0)
    os.umask(umask)
    whole.chmod(target.stat().st_mode & 0o7777 if target.exists() else 0o666 & ~umask)
    whole.replace(target)
