"""Where robots come from: bundled and example robots, paths, folders, texts, xacro files, objects of other libraries.

| a source | is |
|---|---|
| text that starts with `<` | a URDF |
| `rttrr` | a bundled robot; it wins over a file of that name (`./rttrr` is the file) |
| `example:panda` | a file of the package `example-robot-data`, by the names of `examples()` |
| a path to a folder | the one `.urdf` or `.xacro` file in it or below |
| a path that ends in `.xacro` | what ROS's package `xacro` makes of it; messages then give the lines of its output |
| any other path | a URDF file |
| a `pinocchio.Model`, `mujoco.MjModel`, `yourdfpy.URDF` | see `pinocchio_object.py` and the like |

Objects become the text of a URDF too, so that all goes on as with a file.
"""

from __future__ import annotations

import os
import sys
from collections import Counter
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from rttrr_pin.core.model import Model, Note
from rttrr_pin.errors import InputError, UnknownNameError, UrdfError, shortened

AnySource: TypeAlias = Any
"""What `load` takes: str | os.PathLike[str] | pinocchio.Model | mujoco.MjModel | yourdfpy.URDF."""

OBJECTS = {"pinocchio": "Model", "mujoco": "MjModel", "yourdfpy": "URDF"}
"""Classes of objects that are robots, by library; a library of which there is an object is loaded."""

LARGEST_FILE = 64 * 2**20
"""Bytes; the largest URDF of known robots has about one MiB."""

EXAMPLE = "example:"
"""What the name of an example robot starts with."""

EXAMPLES_PACKAGE = "example-robot-data"

SUFFIXES = (".urdf", ".xacro")
"""How the robots in a folder end."""


@dataclass(frozen=True, slots=True)
class Source:
    """The text of a URDF.

    Attributes:
        name: what to call it in messages.
        text: of the file, or written from an object.
        folder: where its file lies, if there is one.
        made_from: the class of the object that the text was written from; empty where there is a file.
        model: the object's, with what a URDF has no words for; None where the text says all.
        notes: what a user must know of how it was read.
    """

    name: str
    text: bytes
    folder: Path | None = None
    made_from: str = ""
    model: Model | None = None
    notes: tuple[Note, ...] = ()


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

    Raises:
        UrdfError: it is no folder, or holds no such file.
    """
    top = Path(folder)
    if not top.is_dir():
        raise UrdfError("is no folder, expected one that holds URDF files", source=shortened(str(folder)))
    paths = {path.relative_to(top): path for path in sorted(top.rglob("*")) if path.suffix in SUFFIXES}
    shown = (path for path in paths if not any(part.startswith(".") for part in path.parts))
    robots = {path.as_posix(): paths[path] for path in shown if paths[path].is_file()}
    if not robots:
        raise UrdfError("is a folder without a .urdf or .xacro file: name the file", source=shortened(str(folder)))
    return robots


def several(robot: str) -> dict[str, Path]:
    """The files of `example:all` or of a folder that holds more than one, by name; none where one robot is meant."""
    if robot == f"{EXAMPLE}all":
        return examples()
    files = robots_in(robot) if robot.strip() and Path(robot).is_dir() else {}
    return files if len(files) > 1 else {}


def find(source: AnySource) -> Source:
    """The text behind a source; see the table at the top of this file.

    Raises:
        UnknownNameError: there is neither such a bundled robot nor such a file, or no such example robot.
        UrdfError: the file cannot be read, is too large to be a URDF, or is xacro that cannot be expanded; or the
            folder does not hold exactly one.
        InputError: the source is of another type, or an example robot is asked for without its package.
    """
    if isinstance(source, Source):
        return source
    for library, kind in OBJECTS.items():
        module = sys.modules.get(library)
        if module is not None and isinstance(source, getattr(module, kind)):
            return object_source(source, module, f"{library}.{kind}")
    if isinstance(source, str):
        return _find_text(source)
    if isinstance(source, os.PathLike) and isinstance(os.fspath(source), str):
        return _find_path(Path(source))
    raise InputError(
        f"the source is a {type(source).__name__}, expected a name, a path, the text of a URDF, or an object: "
        f"{', '.join(f'{library}.{kind}' for library, kind in OBJECTS.items())}"
    )


def object_source(source: Any, module: Any, kind: str, name: str = "") -> Source:
    """The text that is written from an object.

    Args:
        source: the object.
        module: its library.
        kind: its class, one of `OBJECTS`.
        name: what to call it in messages, if there is a file of it.

    Raises:
        UrdfError: it is none of our robots.
    """
    from rttrr_pin.urdf import mujoco_object, pinocchio_object, yourdfpy_object
    from rttrr_pin.urdf.writer import urdf_text

    def called(own: str) -> str:
        return name or f"<{kind} {shortened(own)!r}>"

    if kind == "yourdfpy.URDF":
        name = called(str(source.robot.name))
        notes = (Note(yourdfpy_object.UNKNOWN, left_out=True),)
        return Source(name, _encoded(yourdfpy_object.as_urdf(source.robot, name), name), made_from=kind, notes=notes)
    if kind == "pinocchio.Model":
        name = called(source.name)
        model = pinocchio_object.as_model(source, name)
    else:
        name = called(mujoco_object.name_of(source))
        model = mujoco_object.as_model(source, module, name)
    return Source(name, _encoded(urdf_text(model), name), made_from=kind, model=model, notes=model.notes)


def mjcf_path(source: Any) -> Path | None:
    """The path, if a source is that of a file of MJCF, MuJoCo's format: XML whose outermost element is <mujoco>."""
    if not isinstance(source, str | os.PathLike) or not isinstance(os.fspath(source), str):
        return None
    if Path(source).suffix.lower() not in (".xml", ".mjcf"):
        return None
    from lxml import etree

    try:
        path = Path(source).expanduser()
        with path.open("rb") as file:
            start = etree.iterparse(file, events=("start",), resolve_entities=False, no_network=True, load_dtd=False)
            return path if next(iter(start))[1].tag == "mujoco" else None
    except (etree.XMLSyntaxError, OSError, ValueError, RuntimeError, StopIteration):
        return None  # whoever reads it as a URDF says what is wrong


def _find_text(source: str) -> Source:
    if source.lstrip("\ufeff \t\r\n").startswith("<"):
        return Source("<string>", _encoded(source, "<string>"))
    if not source.strip():
        raise UrdfError("is empty, expected a URDF, its path or a name", source="<string>")
    if "<" in source and "\n" in source.strip():
        raise UrdfError("starts with other text, expected <robot ...> or a path", source="<string>", line=1)
    if source in bundled():
        return _file(bundled()[source].name, bundled()[source])
    if source.startswith(EXAMPLE):
        return _file(source, _example(source.removeprefix(EXAMPLE)))
    return _find_path(Path(source))


def _find_path(path: Path) -> Source:
    try:
        path = path.expanduser()
        if path.is_dir():
            path = _only_robot(path)
        there = path.exists()
    except (OSError, ValueError, RuntimeError) as error:  # too long, a zero byte, no such home, a folder that is shut
        reason = getattr(error, "strerror", None) or error
        raise UrdfError(f"cannot be read: {reason}", source=shortened(str(path))) from None
    if not there:
        fix = f"check the path, or write {EXAMPLE}NAME for an example robot"
        raise UnknownNameError("bundled robot or file", shortened(str(path)), bundled(), fix)
    file = _file(str(path), path)
    if path.suffix == ".xacro":
        return Source(f"{path} (as xacro expands it)", _expanded(path), file.folder)
    return file


def _file(name: str, path: Path) -> Source:
    return Source(name, _read(path), path.absolute().parent)


def _only_robot(folder: Path) -> Path:
    robots = robots_in(folder)
    if len(robots) > 1:
        names = ", ".join(list(robots)[:12]) + (f", ... ({len(robots)} in all)" if len(robots) > 12 else "")
        raise UrdfError(
            f"is a folder with {len(robots)} robots ({names}): name one of them, or call load_all for all",
            source=shortened(str(folder)),
        )
    return next(iter(robots.values()))


def _example(name: str) -> Path:
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


def _expanded(path: Path) -> bytes:
    """The URDF that a xacro file stands for, line by line what the command `xacro FILE` prints.

    A xacro file is a program: its expressions are evaluated as Python, and may read other files and the environment.
    """
    try:
        import xacro
    except ImportError:
        raise UrdfError(
            "is a xacro file, which needs the package xacro: pip install 'rttrr-pin[xacro]'", source=str(path)
        ) from None
    try:
        text: str = xacro.process_file(str(path)).toprettyxml(indent="  ")
        return text.encode()
    except RecursionError:
        raise UrdfError("xacro cannot expand it: a macro calls itself without end", source=str(path)) from None
    except Exception as error:  # the file's own expressions run here, and may raise anything
        reason = " ".join(str(error).split()) or repr(error)
        raise UrdfError(f"xacro cannot expand it: {reason}{_xacro_fix(reason)}", source=str(path)) from error


def _xacro_fix(reason: str) -> str:
    if "ament_index_python" in reason:
        return ": $(find ...) asks ROS; source its setup first, or run xacro there and pass the URDF"
    if "Undefined substitution argument" in reason:
        return ": run `xacro FILE NAME:=VALUE` yourself and pass the URDF, or give the argument a default"
    return ""


def _encoded(text: str, name: str) -> bytes:
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise UrdfError(
            f"holds {text[error.start]!r}, half a character: read the file as UTF-8", source=name, line=line
        ) from None


def _read(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size <= LARGEST_FILE:
            with path.open("rb") as file:
                text = file.read(LARGEST_FILE + 1)  # a device may have no size and no end
            size = len(text)
    except (OSError, ValueError) as error:
        raise UrdfError(f"cannot be read: {getattr(error, 'strerror', None) or error}", source=str(path)) from error
    if size > LARGEST_FILE:
        raise UrdfError(
            f"has more than {LARGEST_FILE // 2**20} MiB, which no URDF has: is it a mesh?", source=shortened(str(path))
        )
    return text
