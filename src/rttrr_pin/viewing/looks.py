"""What the links look like: the solids and meshes of the file, each in the frame of its link.

Where a link is, is never asked of another library: shapes hang on the link frames of our own forward kinematics, so
that a link which `yourdfpy` drops, a joint that follows another, or a floating base stands where the recursion has it.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.solids import Solid
from rttrr_pin.inspection.shapes import find_mesh, primitive
from rttrr_pin.urdf.document import UrdfDocument, UrdfLink, UrdfShape
from rttrr_pin.urdf.files import note_read

Colour = tuple[float, float, float, float]

GREY: Colour = (0.68, 0.7, 0.73, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """A surface.

    Attributes:
        corners: (N, 3) [m].
        faces: which three corners each triangle has, (M, 3).
    """

    corners: NDArray[np.float32]
    faces: NDArray[np.uint32]


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A shape on a link.

    Attributes:
        link: index of the link; -1 is the root.
        shape: a solid, or a surface.
        colour: red, green, blue and opacity, 0 to 1.
        R: rotation of the shape's frame in the link's, (3, 3).
        p: its origin there, (3,) [m].
    """

    link: int
    shape: Solid | Triangles
    colour: Colour
    R: Array
    p: Array


@dataclass(frozen=True, slots=True)
class Looks:
    """What can be drawn of a robot.

    Attributes:
        parts: its shapes; none where the file has none, or none can be read.
        missing: meshes that could not be read, as the file names them.
        role: `"visual"`, or `"collision"` where nothing visual can be drawn.
    """

    parts: tuple[Part, ...] = ()
    missing: tuple[str, ...] = ()
    role: str = "visual"


def looks_of(model: Model, meshes: bool = True) -> Looks:
    """The visual shapes of a robot's file, or else those that collide.

    Args:
        model: the robot.
        meshes: whether meshes are read.
    """
    document = model.document
    if not isinstance(document, UrdfDocument):
        return Looks()
    names = {model.root.name: -1} | {name: i for i, name in enumerate(model.link_names)}
    colours = _colours(document.text)
    missing: dict[str, None] = {}
    for role in ("visual", "collision"):
        parts: list[Part] = []
        for name, i in names.items():
            if name in document.links:
                parts += _parts(document, document.links[name], i, role, colours, meshes, missing)
        if parts:
            return Looks(tuple(parts), tuple(missing), role)
    return Looks((), tuple(missing))


def _parts(
    document: UrdfDocument,
    link: UrdfLink,
    index: int,
    role: str,
    colours: Mapping[tuple[str, str], list[Colour | None]],
    meshes: bool,
    missing: dict[str, None],
) -> Iterator[Part]:
    """The shapes of one link."""
    shapes = [shape for shape in link.shapes if shape.role == role]
    own = colours.get((link.name, role), [])
    own = own if len(own) == len(shapes) else [None] * len(shapes)
    for shape, colour in zip(shapes, own, strict=True):
        solid = primitive(shape)
        if solid is not None:
            yield Part(index, solid, colour or GREY, shape.origin.R, shape.origin.p)
        elif shape.tag == "mesh" and meshes:
            surfaces = _surfaces(shape, document)
            if not surfaces:
                missing[shape.attributes.get("filename", "")] = None
            for surface, painted in surfaces:
                yield Part(index, surface, colour or painted or GREY, shape.origin.R, shape.origin.p)


def _surfaces(shape: UrdfShape, document: UrdfDocument) -> list[tuple[Triangles, Colour | None]]:
    """A mesh as the link has it; none where it cannot be read."""
    path = find_mesh(shape.attributes.get("filename", ""), document.folder, document.packages)
    try:
        scale = np.array([float(word) for word in shape.attributes.get("scale", "1 1 1").split()])
    except ValueError:
        return []
    if path is None or scale.shape != (3,) or not np.isfinite(scale).all():
        return []
    note_read(path)
    flipped = bool(np.prod(scale) < 0.0)
    return [
        (Triangles((own.corners * scale).astype(np.float32), own.faces[:, ::-1] if flipped else own.faces), colour)
        for own, colour in load_surfaces(path)
    ]


@lru_cache(maxsize=512)
def load_surfaces(path: Path) -> tuple[tuple[Triangles, Colour | None], ...]:
    """The surfaces of a mesh file with their colours; none where it cannot be read."""
    import trimesh  # slow to import: robots without meshes do without

    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene: Any = trimesh.load(path, force="scene", process=False)
            if scene.units not in (None, "m", "meter", "meters"):
                scene = scene.convert_units("meters")
            return tuple(filter(None, map(_surface, scene.dump())))
    except Exception:  # whatever a damaged mesh does to its reader, the rest is shown
        return ()
    finally:
        logger.setLevel(level)


def _surface(mesh: Any) -> tuple[Triangles, Colour | None] | None:
    """A part of a mesh file; None where it has no triangles, or a corner is nowhere."""
    if not hasattr(mesh, "faces") or not len(mesh.faces) or not np.isfinite(mesh.vertices).all():
        return None
    mesh.merge_vertices(merge_tex=True)
    surface = Triangles(np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.uint32))
    material = getattr(mesh.visual, "material", None)
    paint = getattr(material, "main_color", None)
    if paint is None and getattr(mesh.visual, "kind", None) in ("face", "vertex"):
        paint = mesh.visual.main_color
    return surface, None if paint is None else _colour(np.asarray(paint, dtype=float) / 255.0)


def _colour(numbers: Array) -> Colour | None:
    """Four numbers from 0 to 1 as a colour."""
    if numbers.shape != (4,) or not np.isfinite(numbers).all():
        return None
    r, g, b, a = np.clip(numbers, 0.0, 1.0).tolist()
    return r, g, b, a


def _colours(text: str) -> dict[tuple[str, str], list[Colour | None]]:
    """By link and role, the colour of each shape that has a geometry, in the order of the file."""
    try:
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, recover=True)
        root = etree.fromstring(text.encode(), parser)
        if root is None:
            return {}
        named = {own.get("name"): _painted(own) for own in root.findall("material")}
        out: dict[tuple[str, str], list[Colour | None]] = {}
        for link in root.findall("link"):
            for role in ("visual", "collision"):
                shapes = [own for own in link.findall(role) if own.find("geometry/*") is not None]
                materials = (own.find("material") for own in shapes)
                out[link.get("name", ""), role] = [
                    None if own is None else _painted(own) or named.get(own.get("name")) for own in materials
                ]
        return out
    except etree.LxmlError:
        return {}


def _painted(material: Any) -> Colour | None:
    """The <color> of a <material>."""
    colour = material.find("color")
    try:
        return None if colour is None else _colour(np.array([float(word) for word in colour.get("rgba", "").split()]))
    except ValueError:
        return None
