"""Compiled programs on disk, so that a robot is compiled once on a machine and not once in every process.

An entry is one file, named after everything that its bytes depend on: the robot's numbers, what is computed, the
versions of this package and of the compiler, the processor. It is written beside its place and then moved there, so
that processes that start at the same time find it whole or not at all, and it carries a digest of itself, so that a
damaged one is dropped. A folder that cannot be written costs a warning and nothing else.

An entry is machine code that will run as the user. So the folder and the entry must belong to the user or to root, and
nobody else may write them, or put another in their place: a digest protects from accidents, not from a neighbour.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import re
import stat
import tempfile
import warnings
from functools import cache
from pathlib import Path

from rttrr_pin.errors import CacheWarning

VARIABLE = "RTTRR_PIN_CACHE"
"""The environment's variable that names another folder; empty for none."""

MOST_BYTES = 256 * 2**20
"""Beyond it the entries that were not used for longest are dropped."""

SUFFIX = ".kernel"

OWN = re.compile(r"[0-9a-f]{40}(\.kernel|[0-9a-z_]{8}\.partial)")
"""The names of entries, and of those that are being written; whatever else lies in the folder is somebody else's."""

DIGEST = 32

BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH


class DoubtError(OSError):
    """A folder or an entry that another user may have written: code in it is not run."""


def folder() -> Path | None:
    """Where entries lie; None where the user wants none, or there is no such place.

    Unless another is named, it is in the user's folder for such files (XDG Base Directory Specification).
    """
    named = os.environ.get(VARIABLE, f"{os.environ.get('XDG_CACHE_HOME') or '~/.cache'}/rttrr-pin/kernels")
    return _place(named) if named else None


@cache
def _place(named: str) -> Path | None:
    """The folder of a name, for as long as the process runs: a relative one is where it was when first asked for."""
    try:
        return Path(named).expanduser().absolute()
    except (OSError, RuntimeError) as error:
        _warn_of_no_cache(named, str(error))
        return None


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
    rooms = ("core", "compile", "implementations")  # whose formulas are compiled too
    for path in sorted(path for room in rooms for path in package.glob(f"{room}/**/*.py")):
        digest.update(path.read_bytes())
    return digest.digest()


def read(name: str) -> bytes | None:
    """The bytes of an entry, or None. A damaged one is removed; one that others may have written is not touched."""
    where = folder()
    if where is None:
        return None
    path = where / (name + SUFFIX)
    try:
        _check_folder(where)
    except DoubtError as doubt:
        _warn_of_no_cache(str(where), str(doubt.strerror))
        return None
    except OSError:
        return None
    try:
        data = _contents(path)
    except DoubtError as doubt:
        _warn(f"a compiled kernel in {where} is not run ({doubt.strerror}): it is compiled anew")
        return None
    except OSError:
        return None
    if _digest(name, data[DIGEST:]) != data[:DIGEST]:
        with contextlib.suppress(OSError):
            path.unlink()
        return None
    with contextlib.suppress(OSError):
        os.utime(path)  # used now
    return data[DIGEST:]


def _contents(path: Path) -> bytes:
    """The bytes of a file of this user's; a pipe in its place is not waited for, and a link not followed."""
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        status = os.fstat(handle)
        _check_owner(status)
        if not stat.S_ISREG(status.st_mode) or status.st_size > MOST_BYTES:
            return b""
        with os.fdopen(handle, "rb", closefd=False) as file:
            return file.read()
    finally:
        os.close(handle)


def _check_owner(status: os.stat_result) -> None:
    """Refuse what another user but root owns or may write.

    Raises:
        DoubtError: it is so.
    """
    if status.st_uid not in (os.geteuid(), 0):
        raise DoubtError(errno.EPERM, "it belongs to another user")
    if status.st_mode & BY_OTHERS:
        raise DoubtError(errno.EPERM, "other users may write it")


def _check_folder(where: Path) -> None:
    """Refuse a folder of another user's, and one that others may write or put another in the place of.

    Raises:
        DoubtError: it is so.
    """
    _check_owner(where.stat())
    for parent in Path(os.path.realpath(where)).parents:
        mode = parent.stat().st_mode
        if mode & BY_OTHERS and not mode & stat.S_ISVTX:
            raise DoubtError(errno.EPERM, f"other users may write {parent}")


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
        missing = [place for place in (where, *where.parents) if not place.exists()]
        for place in reversed(missing):  # parents=True would give the outer ones another mode
            place.mkdir(mode=0o700, exist_ok=True)
        _check_folder(where)
        handle, partial = tempfile.mkstemp(prefix=name, suffix=".partial", dir=where)
        with os.fdopen(handle, "wb") as file:
            file.write(_digest(name, data) + data)
        Path(partial).replace(where / (name + SUFFIX))
        _drop_the_oldest(where)
    except OSError as error:
        _warn_of_no_cache(str(where), error.strerror or type(error).__name__)
    finally:
        if partial is not None:
            with contextlib.suppress(OSError):  # it is in its place, where nothing went wrong
                Path(partial).unlink()


def _warn_of_no_cache(where: str, error: str) -> None:
    _warn(
        f"compiled kernels cannot be kept in {where} ({error}): every process compiles its own; "
        f"set {VARIABLE} to a folder that you alone can write, or to nothing for no cache"
    )


@cache
def _warn(message: str) -> None:
    """Once."""
    warnings.warn(message, CacheWarning, stacklevel=2)


def _drop_the_oldest(where: Path) -> None:
    """Keep the entries used last, up to `MOST_BYTES`; and no remains of processes that were killed."""
    entries = []
    for path in where.iterdir():
        with contextlib.suppress(OSError):  # another process may have dropped it
            status = path.lstat()
            if OWN.fullmatch(path.name) and stat.S_ISREG(status.st_mode):
                entries.append((status.st_mtime, status.st_size, path))
    newest = max((time for time, _, _ in entries), default=0.0)
    total = 0
    for time, size, path in sorted(entries, reverse=True, key=lambda entry: entry[0]):
        total += size
        abandoned = path.suffix == ".partial" and time < newest - 3600.0
        if abandoned or (path.suffix == SUFFIX and total > MOST_BYTES):
            with contextlib.suppress(OSError):
                path.unlink()
