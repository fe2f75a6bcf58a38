"""Where robots come from: bundled and example robots, paths, folders, texts, xacro files, objects of other libraries.

| a source | is |
|---|---|
| text that starts with `<` | a URDF |
| `rttrr` | a bundled robot; it wins over a file of that name (`./rttrr` is the file) |
| `example:panda` | a file of the package `example-robot-data`, by the names of `catalogue.examples()` |
| a path to a folder | the one `.urdf` or `.xacro` file in it or below |
| a path of a xacro file | what ROS's package `xacro` makes of it, if asked to; messages give the lines of that |
| any other path | a URDF file |
| a `pinocchio.Model`, `mujoco.MjModel`, `yourdfpy.URDF` | see `pinocchio_object.py` and the like |

Objects become the text of a URDF too, so that all goes on as with a file.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from rttrr_pin.core.model import Model, Note
from rttrr_pin.errors import InputError, UnknownNameError, UrdfError, listed, shortened
from rttrr_pin.urdf import catalogue, xacro
from rttrr_pin.urdf.catalogue import EXAMPLE
from rttrr_pin.urdf.files import read_limited
from rttrr_pin.urdf.packages import forget_packages

AnySource: TypeAlias = Any
"""What `load` takes: str | os.PathLike[str] | pinocchio.Model | mujoco.MjModel | yourdfpy.URDF."""

OBJECTS = {"pinocchio": "Model", "mujoco": "MjModel", "yourdfpy": "URDF"}
"""Classes of objects that are robots, by library; a library of which there is an object is loaded."""

LARGEST_FILE = 16 * 2**20
"""Bytes; the largest URDF of known robots has about one MiB."""

MOST_TAGS = 20_000
"""Of 1,500 published files none has more than 6,400; to read more takes more seconds than anyone waits."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What is done with a file only where the user asks for it.

    Attributes:
        xacro: whether a xacro file is expanded, which runs the Python in it.
        xacro_args: values of its <xacro:arg>, by name; to pass some asks for it too.
        lenient: whether to go on with what is assumed where the file is wrong, or does not say.
        mimic: whether joints follow others; without it each moves by itself.
        packages: folders by the names of packages; others are looked for (`packages.py`).
    """

    xacro: bool = False
    xacro_args: Mapping[str, object] = field(default_factory=dict)
    lenient: bool = False
    mimic: bool = True
    packages: Mapping[str, Path] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "xacro_args", xacro.arguments(self.xacro_args))


AS_IT_STANDS = Reading()


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

    def __post_init__(self) -> None:
        tags = self.text.count(b"<")
        if tags > MOST_TAGS:
            raise UrdfError(
                f"has {tags:,} tags, more than the {MOST_TAGS:,} that are read: is it a URDF?", source=self.name
            )


def find(source: AnySource, reading: Reading = AS_IT_STANDS) -> Source:
    """The text behind a source; see the table at the top of this file.

    Args:
        source: a name, a path, a text, ...
        reading: what the user allows.

    Raises:
        UnknownNameError: there is neither such a bundled robot nor such a file, or no such example robot.
        UrdfError: the file cannot be read, is too large to be a URDF, or is xacro that cannot be expanded; or the
            folder does not hold exactly one.
        InputError: the source is of another type, or an example robot is asked for without its package.
    """
    if isinstance(source, Source):
        return source
    forget_packages()
    for library, class_name in OBJECTS.items():
        module = sys.modules.get(library)
        if module is not None and isinstance(source, getattr(module, class_name)):
            return object_source(source, module, f"{library}.{class_name}")
    if isinstance(source, str):
        return _find_text(source, reading)
    if isinstance(source, os.PathLike) and isinstance(os.fspath(source), str):
        return _find_path(Path(source), reading)
    raise InputError(
        f"the source is a {type(source).__name__}, expected a name, a path, the text of a URDF, or an object: "
        f"{', '.join(f'{library}.{class_name}' for library, class_name in OBJECTS.items())}"
    )


def object_source(source: Any, module: Any, class_name: str, name: str = "") -> Source:
    """The text that is written from an object.

    Args:
        source: the object.
        module: its library.
        class_name: its class, one of `OBJECTS`.
        name: what to call it in messages, if there is a file of it.

    Raises:
        UrdfError: it is none of our robots.
    """
    from rttrr_pin.urdf import mujoco_object, pinocchio_object, yourdfpy_object
    from rttrr_pin.urdf.writer import urdf_text

    def called(own: str) -> str:
        return name or f"<{class_name} {shortened(own)!r}>"

    if class_name == "yourdfpy.URDF":
        name = called(str(source.robot.name))
        notes = (Note(yourdfpy_object.UNKNOWN, left_out=True),)
        return Source(
            name, _encoded(yourdfpy_object.as_urdf(source.robot, name), name), made_from=class_name, notes=notes
        )
    if class_name == "pinocchio.Model":
        name = called(source.name)
        model = pinocchio_object.as_model(source, name)
    else:
        name = called(mujoco_object.name_of(source))
        model = mujoco_object.as_model(source, module, name)
    return Source(name, _encoded(urdf_text(model), name), made_from=class_name, model=model, notes=model.notes)


def mjcf_path(source: Any) -> Path | None:
    """The path, if a source is that of a file of MJCF, MuJoCo's format: XML whose outermost element is <mujoco>."""
    if not isinstance(source, str | os.PathLike) or not isinstance(os.fspath(source), str):
        return None
    if Path(source).suffix.lower() not in (".xml", ".mjcf"):
        return None
    from lxml import etree

    try:
        path = Path(source).expanduser()
        if not path.is_file():
            return None
        with path.open("rb") as file:
            start = etree.iterparse(file, events=("start",), resolve_entities=False, no_network=True, load_dtd=False)
            return path if next(iter(start))[1].tag == "mujoco" else None
    except (etree.XMLSyntaxError, OSError, ValueError, RuntimeError, StopIteration):
        return None  # whoever reads it as a URDF says what is wrong


def _find_text(source: str, reading: Reading) -> Source:
    if source.lstrip("\ufeff \t\r\n").startswith("<"):
        return Source("<string>", _encoded(source, "<string>"))
    if not source.strip():
        raise UrdfError("is empty, expected a URDF, its path or a name", source="<string>")
    if "<" in source and "\n" in source.strip():
        raise UrdfError("starts with other text, expected <robot ...> or a path", source="<string>", line=1)
    if source in catalogue.bundled():
        return _file(catalogue.bundled()[source].name, catalogue.bundled()[source])
    if source.startswith(EXAMPLE):
        return _file(source, catalogue.example(source.removeprefix(EXAMPLE)))
    return _find_path(Path(source), reading)


def _find_path(path: Path, reading: Reading) -> Source:
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
        raise UnknownNameError("bundled robot or file", shortened(str(path)), catalogue.bundled(), fix)
    file = _file(str(path), path)
    if (reading.xacro or reading.xacro_args) and xacro.is_xacro(path, file.text):
        text = xacro.expanded(path, reading.xacro_args, reading.packages)
        return Source(f"{path} (as xacro expands it)", text, file.folder)
    if xacro.has_suffix(path):
        raise xacro.refusal(path)
    return file


def _file(name: str, path: Path) -> Source:
    return Source(name, _read(path), path.absolute().parent)


def _only_robot(folder: Path) -> Path:
    entries = catalogue.robots_in(folder)
    robots = {name: path for name, path in entries.items() if not name.endswith("/")}
    if not robots:
        raise UrdfError(f"holds no robot, and {', '.join(entries)} cannot be read", source=shortened(str(folder)))
    if len(robots) > 1:
        raise UrdfError(
            f"is a folder with {len(robots)} robots ({listed(robots, 12)}): name one of them, or call load_all for all",
            source=shortened(str(folder)),
        )
    return next(iter(robots.values()))


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
        return read_limited(path, LARGEST_FILE)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UrdfError(f"cannot be read: {reason}", source=shortened(str(path))) from error
