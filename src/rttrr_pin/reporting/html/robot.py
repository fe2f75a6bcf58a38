"""The robot as a drawing: its skeleton with link frames, joints, and what acts at them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.reporting.html.chart import WIDTH, Chart, Key, cut
from rttrr_pin.reporting.html.labels import Box, placed
from rttrr_pin.reporting.html.markup import element, joined
from rttrr_pin.reporting.html.scales import label, ticks
from rttrr_pin.reporting.html.skeleton import Bone, Camera, camera, size_of, skeleton

HEIGHT = 400.0

MARGIN = (70.0, 34.0, 70.0, 34.0)
"""Left, top, right, bottom, with room for names."""

CROWDED = 14
"""From so many links on, only those are named that matter: what is marked, the root, and the ends."""

ARROW = 0.3
"""The longest arrow, of the robot's size."""

Points = Array


@dataclass(frozen=True, slots=True)
class _Paper:
    """From metres to the paper."""

    view: Camera
    scale: float
    offset: Array

    @classmethod
    def around(cls, view: Camera, points: Points) -> _Paper:
        """That on which all points fit."""
        flat = view(points)
        low, high = flat.min(axis=0), flat.max(axis=0)
        left, top, right, bottom = MARGIN
        room = np.array([WIDTH - left - right, HEIGHT - top - bottom])
        scale = float((room / np.maximum(high - low, 1e-12 * max(float(np.abs(flat).max()), 1e-12))).min())
        middle = np.array([left + room[0] / 2, top + room[1] / 2])
        return cls(view, scale, middle - scale * np.array([1, -1]) * (low + high) / 2)

    def __call__(self, point: Points) -> Array:
        return self.scale * np.array([1, -1]) * self.view(np.asarray(point)) + self.offset


def robot_drawing(
    model: Model,
    q: Array | None = None,
    marked: Collection[str] = (),
    wrenches: Array | None = None,
    name: str = "robot",
    title: str = "",
) -> Chart:
    """A robot at a state.

    Args:
        model: the robot.
        q: coordinates, (nq,); None for the robot at zero.
        marked: links, or joints, that stand out.
        wrenches: f of each link in {i}, (links, 3) [N], drawn as arrows.
        name: of the picture, in letters for a file's name.
        title: what it is of.
    """
    if q is None:
        q = model.coordinates_at(np.zeros((1, model.nv)))[0]
    carried = {joint.name: link.name for joint, link in zip(model.joints, model.links, strict=True)}
    links = {carried.get(one, one) for one in marked}
    forces = None if wrenches is None else np.vstack([np.zeros(3), wrenches])
    return drawing(skeleton(model, q), links, forces, name, title or f"{model.name}, its links and joints")


def drawing(bones: Sequence[Bone], marked: Collection[str], forces: Array | None, name: str, title: str) -> Chart:
    """A skeleton; forces are in the axes of their links, (bones, 3)."""
    if not all(np.isfinite(bone.p).all() and np.isfinite(bone.R).all() for bone in bones):
        return Chart(name, title, f"{title}: its links are not at finite places", _nothing(), 60.0)
    size = size_of(bones)
    points = np.array([bone.p for bone in bones])
    arrows = _arrows(bones, forces, size)
    axes = 0.075 * size if len(bones) <= CROWDED else 0.045 * size
    paper = _Paper.around(camera(bones), np.vstack([points, *_bodies(bones, size), *map(np.stack, arrows.values())]))
    parts: list[Markup] = [_line(paper(a), paper(b), "floor") for a, b in _floor(size, points)]
    depth = np.argsort(points @ np.cross(paper.view.across, paper.view.up), kind="stable").tolist()
    parts += [_bone(paper, bones, k, bones[k].name in marked) for k in depth]
    parts += [part for k in depth for part in _frame(paper, bones[k], axes)]
    parts += [part for k in depth for part in _joint(paper, bones[k], 0.09 * size, bones[k].name in marked)]
    parts += [_arrow(paper(tail), paper(head)) for tail, head in arrows.values()]
    parts += _names(paper, bones, marked, [*arrows.values()], axes)
    return Chart(
        name,
        title,
        _said(bones, marked, title),
        joined(parts),
        HEIGHT,
        _legend(bones, bool(arrows)),
        note=f"grid {label(_grid(size))} m",
    )


def _bodies(bones: Sequence[Bone], size: float) -> Iterator[Array]:
    """Centres of mass that are not far off, and some room around a robot whose links are all at one place."""
    for bone in bones:
        if bone.com is not None and float(np.linalg.norm(bone.com - bone.p)) <= size:
            yield bone.com
    for side in (-0.2, 0.2):
        yield bones[0].p + side * size


def _nothing() -> Markup:
    return element("text", "nothing to draw", x=WIDTH / 2, y=30, class_="tick middle")


def _grid(size: float) -> float:
    """A round length, about a fifth of the robot."""
    steps = ticks(0.0, size, 5)
    return steps[1] - steps[0] if len(steps) > 1 else size


def _floor(size: float, points: Points) -> list[tuple[Array, Array]]:
    """A grid at the height of the root, as large as the robot's shadow."""
    step = _grid(size)
    x0, y0 = np.floor(points[:, :2].min(axis=0) / step - 0.1).tolist()
    x1, y1 = np.ceil(points[:, :2].max(axis=0) / step + 0.1).tolist()
    rows = [((x0, y), (x1, y)) for y in np.arange(y0, y1 + 0.5)]
    columns = [((x, y0), (x, y1)) for x in np.arange(x0, x1 + 0.5)]
    return [(step * np.array([*a, 0.0]), step * np.array([*b, 0.0])) for a, b in (*rows, *columns)]


def _line(a: Array, b: Array, look: str, **more: str) -> Markup:
    return element("line", x1=float(a[0]), y1=float(a[1]), x2=float(b[0]), y2=float(b[1]), class_=look, **more)


def _bone(paper: _Paper, bones: Sequence[Bone], k: int, marked: bool) -> Markup:
    """From the parent's origin to its own."""
    bone = bones[k]
    if bone.parent < 0:
        return Markup("")
    a, b = paper(bones[bone.parent].p), paper(bone.p)
    return _line(a, b, f"bone{' fixed' * (bone.kind == 'rigid')}{' marked' * marked}")


def _frame(paper: _Paper, bone: Bone, length: float) -> Iterator[Markup]:
    """x, y and z of the link, and its centre of mass."""
    for axis, direction in zip("xyz", bone.R.T, strict=True):
        yield _line(paper(bone.p), paper(bone.p + length * direction), axis)
    if bone.com is not None and np.isfinite(bone.com).all():
        x, y = paper(bone.com).tolist()
        half = f"M{x:.1f} {y:.1f}v-3.5a3.5 3.5 0 0 1 3.5 3.5zM{x:.1f} {y:.1f}v3.5a3.5 3.5 0 0 1 -3.5 -3.5z"
        yield element("circle", cx=x, cy=y, r=3.5, class_="mass")
        yield element("path", d=half, class_="mass-half")


def _joint(paper: _Paper, bone: Bone, length: float, marked: bool) -> Iterator[Markup]:
    """Its axis, and a sign for how it moves."""
    x, y = paper(bone.p).tolist()
    if bone.kind in ("turn", "slide"):
        half = 0.5 * length * bone.axis
        yield _line(paper(bone.p - half), paper(bone.p + half), "joint-axis")
    said = element("title", f"{bone.name}, at {', '.join(label(v) for v in bone.p.tolist())} m")
    radius = 5.0 if marked else 4.0
    if bone.kind in ("slide", "root"):
        yield element("rect", said, x=x - radius, y=y - radius, width=2 * radius, height=2 * radius, class_="slide")
    elif bone.kind == "free":
        yield element("path", said, d=f"M{x:.1f} {y - 6:.1f}l6 6l-6 6l-6 -6z", class_="free")
    else:
        yield element("circle", said, cx=x, cy=y, r=2.5 if bone.kind == "rigid" else radius, class_=bone.kind)


def _arrows(bones: Sequence[Bone], forces: Array | None, size: float) -> dict[int, tuple[Array, Array]]:
    """Tail and head of each force, the largest `ARROW` of the robot."""
    if forces is None:
        return {}
    lengths = np.linalg.norm(forces, axis=1)
    most = float(lengths[np.isfinite(lengths)].max(initial=0.0))
    return {
        k: (bone.p, bone.p + ARROW * size * (bone.R @ forces[k]) / most)
        for k, bone in enumerate(bones)
        if most > 0.0 and np.isfinite(lengths[k]) and lengths[k] > 0.02 * most
    }


def _arrow(tail: Array, head: Array) -> Markup:
    along = head - tail
    length = float(np.hypot(*along))
    if length < 2.0:
        return Markup("")
    u = along / length
    back = head - min(8.0, 0.4 * length) * u
    side = min(4.0, 0.2 * length) * np.array([-u[1], u[0]])
    a, b = back + side, back - side
    d = f"M{tail[0]:.1f} {tail[1]:.1f}L{head[0]:.1f} {head[1]:.1f}M{a[0]:.1f} {a[1]:.1f}L{head[0]:.1f} {head[1]:.1f}"
    return element("path", d=f"{d}L{b[0]:.1f} {b[1]:.1f}", class_="force")


def _names(
    paper: _Paper, bones: Sequence[Bone], marked: Collection[str], arrows: Sequence[tuple[Array, Array]], length: float
) -> Iterator[Markup]:
    """Marked links first, then the root and the ends, then the others where there is room."""
    ends = set(range(len(bones))) - {bone.parent for bone in bones} | {0}
    crowded = len(bones) > CROWDED
    order = sorted(range(len(bones)), key=lambda k: (bones[k].name not in marked, k not in ends, k))
    wanted: list[tuple[str, float, float, bool, bool]] = []
    for k in order:
        stands_out = bones[k].name in marked
        if crowded and not stands_out and (k not in ends or len(wanted) > CROWDED):
            continue
        x, y = paper(bones[k].p).tolist()
        wanted.append((cut(bones[k].name), x, y, stands_out, stands_out))
    taken: list[Box] = [_around(paper(bone.p), 6.0) for bone in bones]
    taken += [_around(paper(0.5 * (tail + head)), 5.0) for tail, head in arrows]
    taken += [_around(paper(bone.p + length * 0.75 * u), 4.0) for bone in bones for u in bone.R.T]
    for bone in bones:
        if bone.parent >= 0:
            a, b = paper(bones[bone.parent].p), paper(bone.p)
            steps = np.linspace(0.0, 1.0, int(np.hypot(*(b - a)) // 14) + 2)[1:-1]
            taken += [_around(a + s * (b - a), 4.0) for s in steps]
    for own in placed(wanted, taken, (2.0, 2.0, WIDTH - 2.0, HEIGHT - 2.0)):
        if own.tip is not None:
            edge = np.array([own.x, own.y - 4.0])
            yield _line(np.array(own.tip), edge, "leader")
        look = f"halo{' end' * own.end}{' marked' * own.marked}"
        yield element("text", own.text, x=own.x, y=own.y, class_=look)


def _around(point: Array, half: float) -> Box:
    x, y = point.tolist()
    return (x - half, y - half, x + half, y + half)


def _said(bones: Sequence[Bone], marked: Collection[str], title: str) -> str:
    """The tree in words, the first links of a large one."""
    words: Mapping[str, str] = {"turn": "turns on", "slide": "slides on", "free": "is free on", "rigid": "is fixed to"}
    shown = [f"{bone.name} {words[bone.kind]} {bones[bone.parent].name}" for bone in bones[1 : CROWDED + 1]]
    more = f"; and {len(bones) - 1 - len(shown)} more" if len(bones) - 1 > len(shown) else ""
    stands_out = [bone.name for bone in bones if bone.name in marked]
    which = f". Marked: {', '.join(stands_out)}" if stands_out else ""
    return f"{title}: {'; '.join(shown)}{more}{which}"


def _legend(bones: Sequence[Bone], forces: bool) -> tuple[Key, ...]:
    kinds = {bone.kind for bone in bones}
    joints = {"turn": "revolute", "slide": "prismatic", "free": "planar or floating", "rigid": "fixed"}
    return (
        Key("x", "x"),
        Key("y", "y"),
        Key("z", "z of the link's frame"),
        *(Key(kind, word) for kind, word in joints.items() if kind in kinds),
        *([Key("mass", "centre of mass")] if any(bone.com is not None for bone in bones) else []),
        *([Key("force", "f at the joint")] if forces else []),
    )
