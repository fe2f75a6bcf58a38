"""Compiled programs on disk, so that a robot is compiled once on a machine and not once in every process.

An entry is one file, named after everything that its bytes depend on: the robot's numbers, what is computed, the
versions of this package and of the compiler, the processor. It is written beside its place and then moved there, so
that processes that start at the same time find it whole or not at all, and it carries a digest of itself, so that a
damaged one is dropped. A folder that cannot be written costs a warning and nothing else.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
import warnings
from functools import cache
from pathlib import Path

import platformdirs

from rttrr_pin.errors import CacheWarning

VARIABLE = "RTTRR_PIN_CACHE"
"""The environment's variable that names another folder; empty for none."""

MOST_BYTES = 256 * 2**20
"""Beyond it the entries that were not used for longest are dropped."""

SUFFIX = ".kernel"

DIGEST = 32


def folder() -> Path | None:
    """Where entries lie; None where the user wants none."""
    named = os.environ.get(VARIABLE)
    if named is None:
        return Path(platformdirs.user_cache_dir("rttrr-pin", appauthor=False)) / "kernels"
    return Path(named) if named else None


def key(*parts: bytes | str) -> str:
    """The name of an entry; differs where any part differs."""
    digest = hashlib.sha256(sources())
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()[:40]


@cache
def sources() -> bytes:
    """A digest of this package's own code: a change of it makes all entries useless, whatever its version says."""
    digest = hashlib.sha256()
    package = Path(__file__).parents[1]
    for path in sorted([*package.glob("core/**/*.py"), *package.glob("compile/**/*.py")]):
        digest.update(path.read_bytes())
    return digest.digest()


def read(name: str) -> bytes | None:
    """The bytes of an entry, or None; a damaged one is removed."""
    where = folder()
    if where is None:
        return None
    path = where / (name + SUFFIX)
    try:
        data = path.read_bytes()
    except OSError:
        return None
    if _digest(name, data[DIGEST:]) != data[:DIGEST]:
        with contextlib.suppress(OSError):
            path.unlink()
        return None
    with contextlib.suppress(OSError):
        os.utime(path)  # used now
    return data[DIGEST:]


def _digest(name: str, data: bytes) -> bytes:
    """Of an entry under its name: one that was renamed is no entry."""
    return hashlib.sha256(name.encode() + b"\0" + data).digest()


def write(name: str, data: bytes) -> None:
    """Keep an entry; where that is not possible, warn once."""
    where = folder()
    if where is None:
        return
    partial = None
    try:
        where.mkdir(parents=True, exist_ok=True)
        handle, partial = tempfile.mkstemp(prefix=name, suffix=".partial", dir=where)
        with os.fdopen(handle, "wb") as file:
            file.write(_digest(name, data) + data)
        Path(partial).replace(where / (name + SUFFIX))
        _drop_the_oldest(where)
    except OSError as error:
        if partial is not None:
            with contextlib.suppress(OSError):
                Path(partial).unlink()
        _warn(str(where), error.strerror or type(error).__name__)


@cache
def _warn(where: str, error: str) -> None:
    """Once for a folder and a reason."""
    warnings.warn(
        f"compiled kernels cannot be kept in {where} ({error}): every process compiles its own; "
        f"set {VARIABLE} to a folder that can be written, or to nothing for no cache",
        CacheWarning,
        stacklevel=2,
    )


def _drop_the_oldest(where: Path) -> None:
    """Keep the entries used last, up to `MOST_BYTES`; and no remains of processes that were killed."""
    entries = []
    for path in (*where.glob(f"*{SUFFIX}"), *where.glob("*.partial")):
        with contextlib.suppress(OSError):  # another process may have dropped it
            status = path.stat()
            entries.append((status.st_mtime, status.st_size, path))
    newest = max((time for time, _, _ in entries), default=0.0)
    total = 0
    for time, size, path in sorted(entries, reverse=True, key=lambda entry: entry[0]):
        total += size
        abandoned = path.suffix == ".partial" and time < newest - 3600.0
        if abandoned or (path.suffix == SUFFIX and total > MOST_BYTES):
            with contextlib.suppress(OSError):
                path.unlink()
