"""The 3-D scene: what of a state is drawn, as nodes of viser."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.solids import Box, Capsule, Cylinder, Sphere
from rttrr_pin.viewing import arrow_shapes
from rttrr_pin.viewing.ellipsoids import Ellipsoid, ellipsoids
from rttrr_pin.viewing.looks import Looks, Part, Triangles
from rttrr_pin.viewing.scene import MOMENTS, PAYLOAD, Arrows, Placement
from rttrr_pin.viewing.skeleton import skeleton

if TYPE_CHECKING:
    import viser

COLOURS = {
    "f": (213, 94, 0),
    "n": (170, 50, 130),
    "F": (0, 114, 178),
    "N": (0, 138, 95),
    "payload f": (30, 30, 30),
    "payload n": (90, 90, 90),
}
"""Of arrows; told apart also by those who see fewer colours (after Okabe and Ito)."""

BONE, AXIS, CENTRE, BODY, IMPOSSIBLE = (120, 126, 134), (240, 228, 66), (20, 20, 20), (86, 180, 233), (200, 30, 30)

SMALL = 0.01
"""Of the size of the robot: the radius of the balls that mark centres of mass."""

LARGEST = 20.0
"""Of the size of the robot: larger ellipsoids would hide all else, and are not drawn."""

FARTHEST = 1e30
"""Metres: what is drawn is drawn in single precision."""

THINGS = ("bodies", "skeleton", "link frames", "centres of mass", "inertia ellipsoids", "f", "n", "F", "N", "names")
"""What can be shown and hidden."""


@dataclass(frozen=True, slots=True)
class Shown:
    """What is drawn, and how.

    Attributes:
        things: of `THINGS`.
        labels: the links whose arrows have labels: `"chosen link"`, `"all links"` or `"none"`.
        link: index of the chosen link.
        opacity: of the bodies, 0 to 1.
        forces: newtons for each metre of an arrow.
        moments: newton metres for each metre.
    """

    things: frozenset[str]
    labels: str
    link: int
    opacity: float
    forces: float
    moments: float

    def per_metre(self, key: str) -> float:
        """The scale of a quantity."""
        return self.moments if key in (*MOMENTS, PAYLOAD[1]) else self.forces

    @property
    def scale(self) -> str:
        """The scale in words."""
        return f"1 m = {self.forces:g} N, 1 m = {self.moments:g} N m"


def wxyz_of(R: Array) -> Array:
    """Unit quaternions (w, x, y, z) of rotations (..., 3, 3)."""
    import viser.transforms

    return np.asarray(viser.transforms.SO3.from_matrix(np.asarray(R)).wxyz, dtype=np.float64)


class Canvas:
    """The nodes of one robot."""

    def __init__(self, server: viser.ViserServer, model: Model, looks: Looks, where: Placement, reach: float) -> None:
        self.server, self.model, self.reach = server, model, reach
        self.has_bodies = bool(looks.parts)
        self.bodies = ellipsoids(model)
        self.larger = tuple(own for own in self.bodies if own.semi_axes.max() > LARGEST * reach)
        self._solids = {"cylinder": arrow_shapes.cylinder(), "cone": arrow_shapes.cone(), "ball": arrow_shapes.ball()}
        self._nodes: dict[str, Any] = {}
        self._links = {-1: server.scene.add_frame("/robot/root", show_axes=False)}
        for i in range(len(model.links)):
            self._links[i] = server.scene.add_frame(f"/robot/link {i}", show_axes=False)
        self._parts = [node for k, part in enumerate(looks.parts) for node in self._part(k, part)]
        self._labels: dict[tuple[str, int], Any] = {}
        self._look_at(where)

    def _look_at(self, where: Placement) -> None:
        """Light, ground, and a camera that sees all of the robot."""
        points = np.concatenate([np.zeros((1, 3)), where.p, where.com])
        points = points[np.abs(points).max(axis=1) < 1e6]
        low, high = points.min(axis=0), points.max(axis=0)
        middle, size = (low + high) / 2.0, self.reach
        camera = self.server.initial_camera
        camera.near, camera.far = size * 1e-3, size * 1e3
        camera.fov = 0.7
        camera.look_at, camera.position = middle, middle + np.array([1.45, -1.6, 0.75]) * size
        scene = self.server.scene
        cell = arrow_shapes.rung(arrow_shapes.rung_of(size / 5.0))
        scene.add_grid(
            "/ground", width=20.0 * cell, height=20.0 * cell, cell_size=cell, section_size=5.0 * cell,
            cell_color=(215, 218, 222), section_color=(180, 185, 192), position=(0.0, 0.0, min(0.0, float(low[2]))),
        )  # fmt: skip

    def draw(self, where: Placement, arrows: Mapping[str, Arrows], shown: Shown) -> None:
        """Draw a state."""
        with self.server.atomic():
            turns = wxyz_of(where.R)
            for i in range(len(self.model.links)):
                self._links[i].wxyz, self._links[i].position = turns[i], np.clip(where.p[i], -FARTHEST, FARTHEST)
            for node in self._parts:
                node.visible = "bodies" in shown.things
                node.opacity = shown.opacity if shown.opacity < 1.0 else None
            self._draw_frames(where, turns, shown)
            self._draw_bodies(where, shown)
            self._draw_skeleton(where, shown)
            for key in COLOURS:
                thing = key.removeprefix("payload ")
                visible = thing in shown.things and key in arrows and len(arrows[key].at) > 0
                self._draw_arrows(key, arrows.get(key), shown.per_metre(key), visible)
            self._draw_labels(where, arrows, shown)
        self.server.flush()

    def _draw_frames(self, where: Placement, turns: Array, shown: Shown) -> None:
        visible = "link frames" in shown.things and len(turns) > 0
        node = self._nodes.get("frames")
        if node is None and visible:
            node = self._nodes["frames"] = self.server.scene.add_batched_axes(
                "/link frames", turns, where.p, axes_length=0.08 * self.reach, axes_radius=0.004 * self.reach
            )
        if node is not None:
            node.visible = visible
            node.batched_wxyzs, node.batched_positions = _f32(turns), _f32(where.p)

    def _draw_bodies(self, where: Placement, shown: Shown) -> None:
        """Centres of mass, and what bodies would have the inertia of the links."""
        self._balls("centres of mass", self.bodies, where, SMALL, CENTRE, "centres of mass" in shown.things)
        visible = "inertia ellipsoids" in shown.things
        own = [body for body in self.bodies if not body.impossible and body not in self.larger]
        self._balls("inertia ellipsoids", own, where, None, BODY, visible, opacity=0.45)
        bad = [body for body in self.bodies if body.impossible]
        self._balls("impossible inertias", bad, where, 3.0 * SMALL, IMPOSSIBLE, visible, wireframe=True)

    def _balls(
        self,
        name: str,
        bodies: list[Ellipsoid] | tuple[Ellipsoid, ...],
        where: Placement,
        radius: float | None,
        colour: tuple[int, int, int],
        visible: bool,
        **look: Any,
    ) -> None:
        """A ball, or an ellipsoid, about the centre of mass of each of some links."""
        links = [body.link for body in bodies]
        R = where.R[links] @ np.array([body.axes for body in bodies]).reshape(-1, 3, 3)
        sizes = np.array([body.semi_axes for body in bodies]).reshape(-1, 3)
        sizes = np.maximum(sizes, 1e-4 * self.reach) if radius is None else np.full_like(sizes, radius * self.reach)
        own = arrow_shapes.Instances(wxyz_of(R) if links else np.zeros((0, 4)), where.com[links], sizes)
        self._instances(f"/{name}", "ball", own, colour, visible, **look)

    def _draw_skeleton(self, where: Placement, shown: Shown) -> None:
        lines = skeleton(self.model, where, self.reach)
        for name, own, colour, width in (("bones", lines.bones, BONE, 0.012), ("joint axes", lines.axes, AXIS, 0.016)):
            sticks = arrow_shapes.sticks(own, width * self.reach)
            self._instances(f"/skeleton/{name}", "cylinder", sticks, colour, "skeleton" in shown.things)

    def _draw_arrows(self, key: str, arrows: Arrows | None, per_metre: float, visible: bool) -> None:
        if arrows is None or not visible:
            for part in ("shafts", "heads"):
                if (node := self._nodes.get(f"/{key}/{part}")) is not None:
                    node.visible = False
            return
        double = key in (*MOMENTS, PAYLOAD[1])
        bodies = arrow_shapes.shafts(arrows, per_metre, self.reach)
        heads = arrow_shapes.heads(arrows, per_metre, self.reach, double)
        self._instances(f"/{key}/shafts", "cylinder", bodies, COLOURS[key], True)
        self._instances(f"/{key}/heads", "cone", heads, COLOURS[key], True)

    def _draw_labels(self, where: Placement, arrows: Mapping[str, Arrows], shown: Shown) -> None:
        """Names of links, and sizes at the tips of arrows."""
        wanted: dict[tuple[str, int], tuple[str, Array]] = {}
        for i, name in enumerate(self.model.link_names):
            if "names" in shown.things:
                wanted["name", i] = name, where.p[i]
        for key, own in arrows.items():
            if key not in shown.things or key in PAYLOAD or shown.labels == "none":
                continue
            at = arrow_shapes.tips(own, shown.per_metre(key), self.reach)
            size, unit = own.size, "N m" if key in MOMENTS else "N"
            for i in range(len(at)) if shown.labels == "all links" else [shown.link]:
                if i < len(at) and size[i] > 0.0:
                    wanted[key, i] = f"{key} {size[i]:.4g} {unit}", at[i]
        for place, node in self._labels.items():
            node.visible = place in wanted
        for place, (text, at_point) in wanted.items():
            node = self._labels.get(place)
            if node is None:
                self._labels[place] = self.server.scene.add_label(
                    f"/labels/{place[0]} {place[1]}", text, position=at_point, anchor="bottom-left"
                )
            else:
                node.text, node.position = text, at_point

    def _instances(
        self,
        name: str,
        solid: str,
        own: arrow_shapes.Instances,
        colour: tuple[int, int, int],
        visible: bool,
        **look: Any,
    ) -> None:
        """Copies of a solid: the node is made when it is first seen, and made anew where their number changes."""
        node = self._nodes.get(name)
        if node is not None and len(node.batched_positions) != len(own.position):
            node.remove()
            node = None
        if node is None:
            if not visible or not len(own.position):
                return
            corners, faces = self._solids[solid]
            self._nodes[name] = self.server.scene.add_batched_meshes_simple(
                name, corners, faces, own.wxyz, _f32(own.position), batched_scales=_f32(own.scale),
                batched_colors=_linear(colour), lod="off", cast_shadow=False, receive_shadow=False, **look,
            )  # fmt: skip
            return
        node.visible = visible
        if visible:
            node.batched_wxyzs, node.batched_positions = _f32(own.wxyz), _f32(own.position)
            node.batched_scales = _f32(own.scale)

    def _part(self, k: int, part: Part) -> Iterator[Any]:
        """The nodes of a shape."""
        link = "root" if part.link < 0 else f"link {part.link}"
        place: dict[str, Any] = {"wxyz": wxyz_of(part.R), "position": part.p}
        scene, name, shape = self.server.scene, f"/robot/{link}/{k}", part.shape
        r, g, b, _ = part.colour
        colour = round(255 * r), round(255 * g), round(255 * b)
        if isinstance(shape, Box):
            yield scene.add_box(name, color=colour, dimensions=shape.size, **place)
        elif isinstance(shape, Triangles):
            yield scene.add_mesh_simple(name, shape.corners, shape.faces, color=colour, side="double", **place)
        elif isinstance(shape, Sphere):
            yield scene.add_icosphere(name, shape.radius, colour, **place)
        else:
            assert isinstance(shape, Cylinder | Capsule)
            yield scene.add_cylinder(name, shape.radius, shape.length, colour, **place)
            if isinstance(shape, Capsule):
                for end, side in (("top", 0.5), ("bottom", -0.5)):
                    at = part.p + part.R[:, 2] * (side * shape.length)
                    yield scene.add_icosphere(f"{name} {end}", shape.radius, colour, position=at)


def _linear(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    """A colour for copies of a solid, whose numbers viser's client takes for linear light, not for sRGB."""
    r, g, b = (round(200.0 * (x / 255.0) ** 2.2) for x in colour)  # and the lights add to it
    return r, g, b


def _f32(x: Array) -> Any:
    """As viser sends it."""
    return np.ascontiguousarray(np.clip(x, -FARTHEST, FARTHEST), dtype=np.float32)
