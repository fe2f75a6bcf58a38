"""What a link looks like: its visual and collision shapes, their hull, and the solids that they would be if filled.

Meshes are opened where the file is found, from the URDF's folder or upwards from it, and never otherwise: nothing is
downloaded, and a mesh that cannot be read leaves the geometry unknown.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.solids import Box, Capsule, Cylinder, RigidBody, Solid, Sphere
from rttrr_pin.inspection.hull import filled_hull
from rttrr_pin.urdf.document import UrdfLink, UrdfShape
from rttrr_pin.urdf.files import note_read
from rttrr_pin.urdf.packages import find_package

MESH_TYPES = (".stl", ".dae", ".obj", ".ply")

LARGEST_MESH = 64 * 2**20
"""Bytes."""

NO_PACKAGES: Mapping[str, Path] = {}

SMALLEST, LARGEST = 1e-9, 1e9
"""Metres; what is drawn smaller or larger, or elsewhere, is no robot, and its volume may be no float."""

CLOSED = 1e-3
"""Sum of the areas of a mesh, as vectors, over that of their sizes: an open one has more."""

AROUND = 24
"""Points on a circle; the circle through them is drawn around, so that the hull contains the cylinder or ball."""


@dataclass(frozen=True, eq=False)
class Filled:
    """A solid that the link may be.

    Attributes:
        label: such as `"the collision box"` or `"the hull of the visuals"`.
        body: with unit density: its mass is the volume [m^3]; com [m] and axes are the link frame's.
        exact: whether it is one box, cylinder or ball, and no approximation by a hull.
    """

    label: str
    body: RigidBody
    exact: bool

    def inertia(self, mass: float) -> Array:
        """The tensor about its centre in link axes, (3, 3) [kg m^2], for a mass [kg]."""
        return np.asarray(self.body.inertia * (mass / self.body.mass))


@dataclass(frozen=True, eq=False)
class Looks:
    """The geometry of a link.

    Attributes:
        points: of the hull of all shapes, (N, 3) [m], in the link frame; empty where nothing is known.
        volume: of that hull [m^3]; 0 where it is flat or unknown.
        solids: what the link would be if its shapes were filled.
        filled: volume of the visuals, or else of the collision shapes, themselves [m^3]; 0 where one is not closed.
        missing: meshes that could not be read.
    """

    points: Array
    volume: float = 0.0
    filled: float = 0.0
    solids: tuple[Filled, ...] = ()
    missing: tuple[str, ...] = ()

    @property
    def known(self) -> bool:
        """Whether there are shapes and all of them could be read."""
        return len(self.points) > 0 and not self.missing


def looks_of(link: UrdfLink, folder: Path | None, packages: Mapping[str, Path] = NO_PACKAGES) -> Looks:
    """The geometry of a link.

    Args:
        link: the link.
        folder: where the URDF lies; None for a text.
        packages: folders by the names of packages; others are looked for.
    """
    clouds: dict[str, list[Array]] = {"visual": [], "collision": []}
    volumes: dict[str, list[float]] = {"visual": [], "collision": []}
    missing, solids = [], dict[str, Filled]()
    for shape in link.shapes:
        solid = primitive(shape)
        points, volume = _mesh(shape, folder, packages) if solid is None else (_outline(solid), solid.volume)
        volumes[shape.role].append(volume)
        if len(points) and solid is not None and sum(other.role == shape.role for other in link.shapes) == 1:
            body = RigidBody.of(solid, 1.0).placed(shape.origin.xyz.floats, shape.origin.angles)
            solids[shape.role] = Filled(f"the {shape.role} {shape.tag}", body, True)
        if not len(points) or not SMALLEST < float(np.abs(points).max() + np.abs(shape.origin.p).max()) < LARGEST:
            missing.append(shape.attributes.get("filename", f"<{shape.tag}>"))
        else:
            clouds[shape.role].append(points @ shape.origin.R.T + shape.origin.p)
    hulls = {role: _hull(role, cloud) for role, cloud in clouds.items() if cloud}
    everything = [points for cloud in clouds.values() for points in cloud]
    whole = _hull("link", everything) if everything else None
    parts = volumes["visual"] or volumes["collision"]
    approximate = [hull for role, hull in hulls.items() if hull is not None and role not in solids]
    return Looks(
        points=np.concatenate(everything) if everything else np.zeros((0, 3)),
        volume=0.0 if whole is None else whole.body.mass,
        solids=(*solids.values(), *approximate),
        filled=sum(parts) if all(parts) else 0.0,
        missing=tuple(dict.fromkeys(missing)),
    )


SIZES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",), "capsule": ("radius", "length")}
"""The attributes of solids."""


def primitive(shape: UrdfShape) -> Solid | None:
    """The solid; None where its numbers are none, or its tag is unknown."""
    try:
        names = SIZES[shape.tag]
        sizes = [float(word) for name in names for word in shape.attributes[name].split()]
        if not all(SMALLEST < size < LARGEST for size in sizes):
            return None
        if shape.tag == "box":
            x, y, z = sizes
            return Box((x, y, z))
        solids: dict[str, Callable[..., Solid]] = {"sphere": Sphere, "cylinder": Cylinder, "capsule": Capsule}
        return solids[shape.tag](*sizes)
    except (KeyError, ValueError, TypeError):  # no such tag or attribute; no number; too few or too many numbers
        return None


def _outline(solid: Solid) -> Array:
    """Points whose hull contains the solid, in its own frame."""
    if isinstance(solid, Box):
        return np.array(list(product(*((-edge / 2, edge / 2) for edge in solid.size))))
    angles = np.arange(AROUND) * (2.0 * np.pi / AROUND)
    circle = np.stack([np.cos(angles), np.sin(angles), np.zeros(AROUND)], axis=-1) / np.cos(np.pi / AROUND)
    if isinstance(solid, Cylinder):
        ends = (np.array([0.0, 0.0, solid.length / 2 * sign]) for sign in (-1, 1))
        return np.concatenate([circle * solid.radius + end for end in ends])
    heights = np.sin(np.linspace(-np.pi / 2, np.pi / 2, AROUND // 2 + 1))
    rings = [circle * np.sqrt(max(1.0 - z * z, 0.0)) + np.array([0.0, 0.0, z]) for z in heights]
    ball = np.asarray(np.concatenate(rings) * (solid.radius / np.cos(np.pi / AROUND)))
    if isinstance(solid, Capsule):
        ball = np.concatenate([ball + np.array([0.0, 0.0, end * solid.length / 2]) for end in (-1, 1)])
    return ball


def _hull(role: str, clouds: Iterable[Array]) -> Filled | None:
    """The filled hull of points; None where they lie in a plane."""
    body = _filled(np.unique(np.concatenate(list(clouds)), axis=0).tobytes())
    return None if body is None else Filled(f"the hull of the {role}s", body, False)


@lru_cache(maxsize=64)  # most links are drawn as they collide: two hulls, and that of both, are one
def _filled(points: bytes) -> RigidBody | None:
    return filled_hull(np.frombuffer(points).reshape(-1, 3).copy())


def _mesh(shape: UrdfShape, folder: Path | None, packages: Mapping[str, Path]) -> tuple[Array, float]:
    """The corners of a mesh's hull and the mesh's volume, scaled; no corners where it cannot be read."""
    path = None if shape.tag != "mesh" else find_mesh(shape.attributes.get("filename", ""), folder, packages)
    try:
        scale = np.array([float(word) for word in shape.attributes.get("scale", "1 1 1").split()])
    except ValueError:
        path = None
    if path is None:
        return np.zeros((0, 3)), 0.0
    note_read(path)
    corners, volume = load_mesh(path)
    return (corners * scale, volume * float(abs(scale.prod()))) if len(scale) == 3 else (corners, volume)


@lru_cache(maxsize=512)
def load_mesh(path: Path) -> tuple[Array, float]:
    """The corners of a mesh's hull, (N, 3) [m], none where it cannot be read; its volume [m^3], 0 where it is open."""
    import trimesh  # slow to import, as SciPy is: robots without meshes do without
    from scipy.spatial import ConvexHull

    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            mesh: Any = trimesh.load(path, force="mesh", process=False, skip_materials=True)
            if mesh.units not in (None, "m", "meter", "meters"):
                mesh.convert_units("meters")
            points = np.asarray(mesh.vertices, dtype=np.float64)
            finite = points[np.isfinite(points).all(axis=1)]
            corners = finite[ConvexHull(finite).vertices] if len(finite) > 100 else finite
            return corners, _enclosed(points[np.asarray(mesh.faces)])
    except Exception:  # whatever a damaged mesh does to its reader, inspection goes on without it
        return np.zeros((0, 3)), 0.0
    finally:
        logger.setLevel(level)


def _enclosed(triangles: Array) -> float:
    """The volume inside a surface [m^3]; 0 where it is open, so that its areas do not add up to zero."""
    a, b, c = np.moveaxis(triangles - triangles.mean(axis=(0, 1)), 1, 0)
    areas = np.cross(b - a, c - a)
    if not np.linalg.norm(areas.sum(axis=0)) < CLOSED * np.linalg.norm(areas, axis=1).sum():
        return 0.0
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0


def find_mesh(filename: str, folder: Path | None, packages: Mapping[str, Path] = NO_PACKAGES) -> Path | None:
    """The file that a URDF names.

    `package://name/rest` is looked for in the package (`urdf/packages.py`), and as `name/rest` in the URDF's folder and
    in those above it; anything else from the URDF's folder.
    """
    candidates: list[Path] = []
    if filename.startswith(("package://", "model://")):
        rest = filename.split("://", 1)[1]
        package = find_package(rest.partition("/")[0], folder, packages)
        candidates += [] if package is None else [package / rest.partition("/")[2]]
        candidates += [] if folder is None else [up / rest for up in (folder, *folder.parents)]
    elif folder is not None:
        candidates = [folder / filename.removeprefix("file://")]
    for path in candidates:
        try:
            if path.suffix.lower() in MESH_TYPES and path.is_file() and path.stat().st_size <= LARGEST_MESH:
                return path
        except (OSError, ValueError):  # a name too long, or with a null byte
            continue
    return None
