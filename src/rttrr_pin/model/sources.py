"""Where robots come from: the bundled files, a path, a text."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from rttrr_pin.errors import UnknownNameError, UrdfError

LARGEST_FILE = 64 * 2**20
"""Bytes; the largest URDF of known robots has about one MiB."""


@dataclass(frozen=True, slots=True)
class Source:
    """The text of a URDF and what to call it in messages."""

    name: str
    text: bytes


@cache
def bundled() -> dict[str, Path]:
    """The robots that come with the package, by name."""
    packaged = Path(str(resources.files("rttrr_pin"))) / "urdf"
    in_checkout = Path(__file__).parents[3] / "urdf"  # an editable install leaves the files at the top level
    folder = packaged if packaged.is_dir() else in_checkout
    return {path.stem: path for path in sorted(folder.glob("*.urdf"))}


def find(source: str | Path) -> Source:
    """The text behind a robot's name, a path, or a text that starts with "<".

    A bundled name wins over a file of the same name in the working folder; write "./rttrr" for the latter.

    Raises:
        UnknownNameError: there is neither such a bundled robot nor such a file.
        UrdfError: the file cannot be read, or is too large to be a URDF.
    """
    if isinstance(source, str):
        if source.lstrip("\ufeff \t\r\n").startswith("<"):
            return Source("<string>", source.encode())
        if source in bundled():
            return Source(bundled()[source].name, _read(bundled()[source]))
    path = Path(source).expanduser()
    if path.is_dir():
        raise UrdfError("is a folder, expected a URDF file: name the file in it", source=str(source))
    if not path.exists():
        raise UnknownNameError("bundled robot or file", str(source), bundled(), "check the path")
    return Source(str(source), _read(path))


def _read(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise UrdfError(
                f"has {size / 2**20:.0f} MiB, expected at most {LARGEST_FILE // 2**20}: is it a mesh?", source=str(path)
            )
        return path.read_bytes()
    except OSError as error:
        raise UrdfError(f"cannot be read: {error.strerror or error}", source=str(path)) from error
