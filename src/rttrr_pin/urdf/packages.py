"""Folders of ROS packages, without ROS: what `package://NAME/...` and `$(find NAME)` stand for.

A package is a folder with a `package.xml`, which names it. It is looked for in this order: where the user says; from
the file upwards, in each folder and what stands in it, the nearest first; in the folders of ROS_PACKAGE_PATH,
AMENT_PREFIX_PATH and CMAKE_PREFIX_PATH. A folder of the package's name without `package.xml` is taken where there is
no better one as near.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping
from functools import lru_cache
from itertools import islice
from pathlib import Path

from rttrr_pin.errors import InputError, shortened

MANIFEST = "package.xml"

NAME = re.compile(r"<name\b[^<>]*>\s*([^<\s]+)\s*</name>")

LEVELS = 8
"""Folders above a file in which packages are looked for."""

MOST_FOLDERS = 2000
"""Folders that are looked into for one package beside a file."""

LONGEST_MANIFEST = 2**16


def named_packages(words: Mapping[str, str | os.PathLike[str]]) -> dict[str, Path]:
    """Folders by the names of packages, which exist.

    Raises:
        InputError: one is no folder.
    """
    if not isinstance(words, Mapping):
        raise InputError(f"packages is a {type(words).__name__}: pass a dict, such as {{'my_description': 'ws/my'}}")
    packages = {}
    for name, folder in words.items():
        try:
            packages[name] = Path(folder).expanduser().absolute()
            there = packages[name].is_dir()
        except (OSError, RuntimeError, TypeError, ValueError):  # too long, no such home, no path, a zero byte
            there = False
        if not there:
            shown = shortened(str(folder))
            raise InputError(f"package {name!r}: {shown!r} is no folder; pass the one that holds its {MANIFEST}")
    return packages


def forget_packages() -> None:
    """Look for packages again, where there were none."""
    _looked_for.cache_clear()
    _named_in.cache_clear()


def find_package(name: str, start: Path | None, named: Mapping[str, Path]) -> Path | None:
    """The folder of a package.

    Args:
        name: the package.
        start: where the file lies that names it; None for a text.
        named: folders that the user gave, by package.
    """
    if name in named:
        return named[name]
    if not name or "/" in name or "\\" in name or name in (".", ".."):
        return None
    return _looked_for(name, start, tuple(os.environ.get(key, "") for key in ("ROS_PACKAGE_PATH", *PREFIXES)))


def not_found(names: Collection[str], start: Path | None) -> str:
    """That there are no packages of these names: where they were looked for, and the fix."""
    paths = [key for key in ("ROS_PACKAGE_PATH", *PREFIXES) if os.environ.get(key)]
    around = "" if start is None else f" in {start}, in the folders above and beside it,"
    options = " ".join(f"--package {name}=FOLDER" for name in names)
    return (
        f"no package is called {' or '.join(map(repr, names))}: its {MANIFEST} was looked for{around} and in "
        f"{', '.join(paths) or 'ROS_PACKAGE_PATH, which is not set'}; add {options} "
        f"(load(..., packages={{{', '.join(f'{name!r}: FOLDER' for name in names)}}}))"
    )


PREFIXES = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH")
"""Environment variables with folders in which packages are installed, under share/."""


@lru_cache(maxsize=1024)
def _looked_for(name: str, start: Path | None, paths: tuple[str, ...]) -> Path | None:
    """The same; for given values of the environment variables."""
    ros, *prefixes = ([Path(part) for part in path.split(os.pathsep) if part] for path in paths)
    for folders in (*_around(start), _installed(name, ros, prefixes)):
        by_name: list[Path] = []
        for folder in folders:
            manifest = _named_in(folder)
            if manifest == name:
                return folder
            if manifest == "" and folder.name == name:
                by_name.append(folder)
        if by_name:
            return by_name[0]
    return None


def _around(start: Path | None) -> Iterator[list[Path]]:
    """The folder and each above, with what stands in it, one level down and two."""
    left = MOST_FOLDERS
    for folder in () if start is None else (start, *start.parents)[:LEVELS]:
        within = list(islice(_within(folder), left))
        left -= len(within)
        yield [folder, *within]


def _within(folder: Path) -> Iterator[Path]:
    """The folders in one, and those in them."""
    for child in _folders(folder):
        yield child
        yield from _folders(child)


def _installed(name: str, ros: list[Path], prefixes: list[list[Path]]) -> Iterator[Path]:
    """Where ROS has its packages."""
    for path in ros:
        yield from (path, path / name)
        for folder in _folders(path):
            yield folder
            yield folder / name
    yield from (prefix / "share" / name for path in prefixes for prefix in path)


def _folders(folder: Path) -> list[Path]:
    """The folders in one, but for hidden ones; none where it is shut."""
    try:
        with os.scandir(folder) as entries:
            names = sorted(entry.name for entry in entries if not entry.name.startswith(".") and entry.is_dir())
    except OSError:
        return []
    return [folder / name for name in names]


@lru_cache(maxsize=4096)
def _named_in(folder: Path) -> str | None:
    """The name in a folder's manifest, empty where it has none; None where there is no folder."""
    try:
        if not folder.is_dir():
            return None
        with (folder / MANIFEST).open(encoding="utf-8", errors="replace") as file:
            match = NAME.search(file.read(LONGEST_MANIFEST))
        return match[1] if match else ""
    except (OSError, ValueError):  # no manifest, a folder that is shut, a name with a null byte
        return ""
