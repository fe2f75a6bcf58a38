"""MJCF files, MuJoCo's own format: MuJoCo compiles them, and its model is read like any that a user holds."""

from __future__ import annotations

from math import prod
from pathlib import Path

from lxml import etree

from rttrr_pin.errors import InputError, UrdfError, shortened
from rttrr_pin.urdf.files import note_read, read_limited
from rttrr_pin.urdf.sources import LARGEST_FILE, Source, object_source

MOST_COPIES = 10_000
"""Of a body; MuJoCo takes minutes and gigabytes for more."""

MANY = 10**12
"""In place of any larger number."""

GRID, MOST_CELLS = ("nrow", "ncol", "width", "height"), 10**8
"""The sides of fields of heights and of textures, and the cells that memory has room for."""


def mjcf_source(path: Path) -> Source:
    """The robot of an MJCF file and the files that it names, as MuJoCo compiles it.

    Raises:
        UrdfError: MuJoCo is not installed, or refuses the file.
    """
    source = shortened(str(path))
    try:
        import mujoco
    except ImportError:
        raise UrdfError(
            "is MJCF, which MuJoCo reads: pip install 'rttrr-pin[mujoco]', or pass a URDF", source=source
        ) from None
    from rttrr_pin.implementations.mujoco_model import without_log

    _check(path, path.parent, source)
    try:
        with without_log():
            compiled = mujoco.MjModel.from_xml_path(str(path))
    except (MemoryError, RuntimeError, ValueError) as error:
        raise UrdfError(f"MuJoCo refuses the file: {str(error).strip()}", source=source) from error
    return object_source(compiled, mujoco, "mujoco.MjModel", source)


def _count(word: str) -> int:
    """A whole number of any length, or what is large enough in its place; 1 for what is none."""
    return min(int(word.lstrip("0")[:20] or "0"), MANY) if word.isascii() and word.isdigit() else 1


def _check(path: Path, folder: Path, source: str, copies: int = 1, checked: dict[Path, int] | None = None) -> None:
    """Of a file that MuJoCo will read and those that it includes and names: they end, and make no crowd of bodies.

    A file that many include is looked at again only where more copies are made of it. What is no XML, or not there,
    MuJoCo says itself.
    """
    checked = {} if checked is None else checked
    checked[path] = copies
    try:
        root = etree.fromstring(read_limited(path, LARGEST_FILE), etree.XMLParser(resolve_entities=False))
    except etree.XMLSyntaxError:
        return
    except (OSError, InputError) as error:
        raise UrdfError(f"{path.name} cannot be read: {error}", source=source) from error
    places = {word for tag in root.iter("compiler") for word in tag.attrib.values()}  # meshdir and the like
    for element in root.iter("*"):
        counts = [above.get("count", "") for above in element.iterancestors("replicate")]
        all_copies = copies * prod(map(_count, counts))
        if all_copies > MOST_COPIES:
            message = f"<replicate> makes {all_copies:,} copies, expected {MOST_COPIES:,} at most"
            raise UrdfError(message, source=source, line=element.sourceline)
        cells = prod(_count(element.get(key, "")) for key in GRID)
        if cells > MOST_CELLS:
            message = f"<{element.tag}> has {cells:,} cells, expected {MOST_CELLS:,} at most"
            raise UrdfError(message, source=source, line=element.sourceline)
        for place in ("", *places) if (name := element.get("file")) else ():
            file = folder / place / name
            note_read(file)
            if file.exists() and not file.is_file():
                raise UrdfError(f"names {file}, which is no file", source=source, line=element.sourceline)
            if element.tag == "include" and file.is_file() and checked.get(file, 0) < all_copies:
                _check(file, folder, source, all_copies, checked)
