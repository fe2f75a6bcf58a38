"""Robots by name: those that come with the package, those of `example-robot-data`, and those in a folder."""

from __future__ import annotations

import os
from collections import Counter
from functools import cache
from pathlib import Path

from rttrr_pin.core.arguments import path_of
from rttrr_pin.errors import InputError, UnknownNameError, UrdfError, shortened
from rttrr_pin.urdf import xacro

EXAMPLE = "example:"
"""What the name of an example robot starts with."""

EXAMPLES_PACKAGE = "example-robot-data"

SUFFIXES = (".urdf", xacro.SUFFIX)
"""How the robots in a folder end, in capitals too."""

MOST_ENTRIES = 100_000
"""Files and folders that are looked through for robots: some seconds, and more than any collection of robots has."""


@cache
def bundled() -> dict[str, Path]:
    """The robots that come with the package, by name."""
    packaged = Path(__file__).parents[1] / "robots"
    in_checkout = Path(__file__).parents[3] / "urdf"  # an editable install leaves the files at the top level
    folder = packaged if packaged.is_dir() else in_checkout
    return {path.stem: path for path in sorted(folder.glob("*.urdf"))}


@cache
def examples() -> dict[str, Path]:
    """The files of the package `example-robot-data`, by name.

    The name is the file's, without `.urdf`: `panda`. Where two files share it, the robot's folder stands before it,
    without `_description`: `anymal_b_simple/anymal`. The files are found without importing the package's loader.

    Raises:
        InputError: the package is not installed.
    """
    from importlib import metadata  # large, and of no use but for example robots

    try:
        files = metadata.files(EXAMPLES_PACKAGE) or []
    except metadata.PackageNotFoundError:
        raise InputError(
            f"example robots need the package {EXAMPLES_PACKAGE}: pip install 'rttrr-pin[robots]'"
        ) from None
    robots = [file for file in files if file.suffix == ".urdf" and "robots" in file.parts]
    shared = Counter(file.stem for file in robots)
    names = {file: file.stem if shared[file.stem] == 1 else f"{_folder(file.parts)}/{file.stem}" for file in robots}
    return {names[file]: Path(str(file.locate())) for file in sorted(robots, key=names.__getitem__)}


def robots_in(folder: str | os.PathLike[str]) -> dict[str, Path]:
    """The `.urdf` and `.xacro` files in a folder and below, by their path from it; hidden ones are left out.

    A folder below that cannot be looked into stands among them, with a slash behind its name: who reads it says why.

    Raises:
        UrdfError: it is no folder, cannot be read, holds no such file, or far more than anyone keeps robots among.
    """
    top = path_of("folder", folder)
    shown = shortened(str(folder))
    try:
        there = top.is_dir()
    except (OSError, ValueError) as error:  # a name too long, or with a zero byte
        raise UrdfError(f"cannot be read: {getattr(error, 'strerror', None) or error}", source=shown) from None
    if not there:
        raise UrdfError("is no folder, expected one that holds URDF files", source=shown)
    shut: dict[Path, str] = {}
    robots: list[Path] = []
    seen = 0
    for parent, folders, files in os.walk(
        top, onerror=lambda error: shut.update({Path(error.filename): str(error.strerror)})
    ):
        folders[:] = [name for name in folders if not name.startswith(".")]
        seen += len(folders) + len(files)
        if seen > MOST_ENTRIES:
            raise UrdfError(
                f"holds more than {MOST_ENTRIES:,} files and folders, of which {len(robots)} robots were found so far: "
                "name a folder nearer to the robots",
                source=shown,
            )
        robots += [
            Path(parent, name) for name in files if Path(name).suffix.lower() in SUFFIXES and not name.startswith(".")
        ]
    if top in shut:
        raise UrdfError(f"cannot be read: {shut[top]}", source=shown)
    by_name = {path.relative_to(top).as_posix(): path for path in robots if _may_be_a_file(path)}
    by_name |= {f"{path.relative_to(top).as_posix()}/": path for path in shut}
    if not by_name:
        raise UrdfError("is a folder without a .urdf or .xacro file: name the file", source=shown)
    return dict(sorted(by_name.items(), key=lambda item: Path(item[0])))


def one_or_several(robot: str) -> tuple[str, dict[str, Path]]:
    """The robot that is meant, of a folder that holds one its file; by name the files where several are meant, or none.

    Several are `example:all`, and a folder that holds more than one.
    """
    if robot == f"{EXAMPLE}all":
        return robot, examples()
    try:
        folder = Path(robot).expanduser()
        files = robots_in(folder) if robot.strip() and folder.is_dir() else {}
    except (OSError, RuntimeError, ValueError):  # a name too long, no such home, a zero byte: who reads it says so
        files = {}
    one = next((str(path) for name, path in files.items() if not name.endswith("/")), robot)
    return (robot, files) if len(files) > 1 else (one, {})


def _may_be_a_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # in a folder that may be listed and no more: who reads it says so
        return True


def example(name: str) -> Path:
    """The file of an example robot; its folder may stand before the name even where the name alone would do."""
    known = examples()
    matches = [path for path in known.values() if name in (f"{_folder(path.parts)}/{path.stem}", path.stem)]
    if name in known or len(matches) == 1:
        return known.get(name, matches[0])
    namesakes = [other for other in known if other.rpartition("/")[2] == name]
    raise UnknownNameError("example robot", shortened(name), namesakes or known)


def _folder(parts: tuple[str, ...]) -> str:
    """The robot's folder in `.../robots/panda_description/urdf/panda.urdf`, without `_description`."""
    return parts[parts.index("robots") + 1].removesuffix("_description")
