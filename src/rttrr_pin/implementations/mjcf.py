"""MJCF files, MuJoCo's own format: MuJoCo compiles them, and its model is read like any that a user holds."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from rttrr_pin.errors import UrdfError, shortened
from rttrr_pin.urdf.files import note_read
from rttrr_pin.urdf.sources import Source, object_source


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

    try:
        with without_log():
            compiled = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise UrdfError(f"MuJoCo refuses the file: {str(error).strip()}", source=source) from error
    _note_files(path, path.parent)
    return object_source(compiled, mujoco, "mujoco.MjModel", source)


def _note_files(path: Path, folder: Path) -> None:
    """A file that MuJoCo has read, with those that it includes and names."""
    note_read(path)
    root = etree.parse(path, etree.XMLParser(resolve_entities=False, no_network=True)).getroot()
    places = {word for tag in root.iter("compiler") for word in tag.attrib.values()}  # meshdir and the like
    for element in root.iter("*"):
        name = element.get("file", "")
        if element.tag == "include":
            _note_files(folder / name, folder)
        elif name:
            for place in ("", *places):
                note_read(folder / place / name)
