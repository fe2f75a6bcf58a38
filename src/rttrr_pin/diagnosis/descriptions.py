"""Two descriptions of one robot, number by number: what differs, each as a change of the first."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array, angles_of
from rttrr_pin.core.joint import EFFECTS, Limits
from rttrr_pin.core.model import Link
from rttrr_pin.diagnosis.rigid_tree import Body, Member, Pose, RigidTree, link_of
from rttrr_pin.diagnosis.tolerance import Level, Tolerance

Change = Callable[[RigidTree], RigidTree]
"""The first robot with one number of the second."""

UNITS = {
    "mass": "kg",
    "centre of mass": "m",
    "inertia": "kg m^2",
    "position": "m",
    "orientation": "rad, rpy",
    "gravity": "m/s^2",
    "link": "kg",
}
"""Of the values of a difference, by its kind; of others those of the joint's coordinate."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One thing that two descriptions of a robot say differently.

    Attributes:
        kind: "mass", "centre of mass", "inertia" (about the centre of mass), "link" (only one has it); "position",
            "orientation", "axis", "type", "limits", "mimic", "armature", "damping", "friction"; "gravity".
        link: the link that it is about; None where it is about a joint.
        joint: the joint that carries it, or that it is about; None on the base.
        a: what the first says, in its frames: a number, a list of numbers, a word, or None.
        b: what the second says, in the frames and coordinates of the first.
        relative: the size of the difference; of directions in rad, of anything else relative to the larger number.
        rounding: whether digits that were printed explain it.
        unit: of a and b.
        change: the first robot with this number of the second; None where no torque can depend on it.
    """

    kind: str
    link: str | None
    joint: str | None
    a: Any
    b: Any
    relative: float
    rounding: bool = False
    unit: str = ""
    change: Change | None = field(default=None, compare=False, repr=False)

    @property
    def where(self) -> str:
        """What it is about, in words."""
        if self.link is not None:
            return f"{self.kind} of {self.link}"
        return self.kind if self.joint is None else f"{self.kind} of {self.joint}"

    def to_dict(self) -> dict[str, Any]:
        """All but the change, as data for JSON."""
        return {own.name: getattr(self, own.name) for own in fields(self) if own.name != "change"}


def differences(a: RigidTree, b: RigidTree, tolerance: Tolerance) -> tuple[RigidTree, list[Difference]]:
    """What two descriptions say differently; `b` is in the terms of `a`.

    Returns:
        The first robot, whose bodies are merged where the second has no such links; and the differences from it.
    """
    found: list[Difference] = []
    level = tolerance.length(a.gravity, b.gravity)
    if level.differs:
        g = b.gravity
        found.append(_of("gravity", None, None, a.gravity, g, level, lambda tree: replace(tree, gravity=g)))
    found += _base(a, b, tolerance)
    for k, (x, y) in enumerate(zip(a.bodies, b.bodies, strict=True)):
        found += _joint(k, x, y, tolerance, [body.joint.name for body in a.bodies])
        merged, own = _body(k, x, y, tolerance)
        if merged is not None:
            a = a.changed(k, members=merged)
        found += own
    return a, found


def _of(
    kind: str, link: str | None, joint: str | None, x: Any, y: Any, level: Level, change: Change | None, unit: str = ""
) -> Difference:
    x, y = (own.tolist() if isinstance(own, np.ndarray) else own for own in (x, y))
    return Difference(kind, link, joint, x, y, level.size, level.printed, unit or UNITS.get(kind, ""), change)


def _base(a: RigidTree, b: RigidTree, tolerance: Tolerance) -> Iterator[Difference]:
    """Links that stand still, which no torque feels."""
    of_b = {own.link.name: own for own in b.base}
    for own in a.base:
        other = of_b.get(own.link.name)
        if other is not None:
            for kind, _, x, y, level in _link(own.link, other.link, tolerance):
                yield _of(kind, own.link.name, None, x, y, level, None)


def _link(x: Link, y: Link, tolerance: Tolerance) -> Iterator[tuple[str, str, Any, Any, Level]]:
    """Kind, name and numbers of what differs of two links in one frame."""
    level = tolerance.number(x.mass, y.mass)
    if level.differs:
        yield "mass", "mass", x.mass, y.mass, level
    if x.mass and y.mass:
        level = tolerance.length(x.com, y.com)
        if level.differs:
            yield "centre of mass", "com", x.com, y.com, level
    level = tolerance.tensor(x.inertia, y.inertia, (x.mass, y.mass))
    if level.differs:
        yield "inertia", "inertia", x.inertia, y.inertia, level


def _body(k: int, x: Body, y: Body, tolerance: Tolerance) -> tuple[tuple[Member, ...] | None, list[Difference]]:
    """What differs of two bodies: link by link, where they are made of the same ones, or as a whole."""
    joint = x.joint.name
    whole_x, whole_y = link_of(x.name, x.inertia), link_of(x.name, y.inertia)
    unlike = [level for *_, level in _link(whole_x, whole_y, tolerance)]
    if not unlike:
        return None, []
    of_x, of_y = ({own.link.name: own for own in body.members if own.massive} for body in (x, y))
    if x.name in of_x and y.name in of_y and x.name != y.name:  # one link with two names
        of_y = {x.name if name == y.name else name: own for name, own in of_y.items()}
    found = [one for name, own in of_x.items() if name in of_y for one in _member(k, joint, own, of_y[name], tolerance)]
    lone = [name for name in (*of_x, *of_y) if (name in of_x) != (name in of_y)]
    if not lone:
        return None, found
    if not any(one.rounding is False for one in found):
        return None, found + [_lone(k, joint, name, of_x.get(name), of_y.get(name)) for name in lone]
    merged = (Member(whole_x),)
    own = [
        _of(kind, x.name, joint, p, q, level, _changed_link(k, x.name, key, q))
        for kind, key, p, q, level in _link(whole_x, whole_y, tolerance)
    ]
    return merged, own


def _changed_link(k: int, name: str, key: str, value: Any) -> Change:
    def change(tree: RigidTree) -> RigidTree:
        return tree.changed_link(k, name, **{key: value})

    return change


def _member(k: int, joint: str, x: Member, y: Member, tolerance: Tolerance) -> list[Difference]:
    """What differs of a link of a body: where it is fixed, or what it weighs."""
    name = x.link.name
    moved = Pose(x.pose.R, x.pose.p).inverse @ y.pose
    seen = link_of(name, Member(y.link, moved).inertia)
    found = list(_link(x.link, seen, tolerance))
    placed = [
        ("position", tolerance.length(x.pose.p, y.pose.p), x.pose.p, y.pose.p, Pose(x.pose.R, y.pose.p)),
        ("orientation", tolerance.turn(x.pose.R, y.pose.R), *_rpy(x.pose.R, y.pose.R), Pose(y.pose.R, x.pose.p)),
    ]
    if not any(level.differs for _, level, *_ in placed):
        found = list(_link(x.link, y.link, tolerance))
    elif found and len(own := list(_link(x.link, y.link, tolerance))) < len(found):
        at = [
            _of(kind, name, joint, p, q, level, _placed(k, name, kind, pose))
            for kind, level, p, q, pose in placed
            if level.differs
        ]
        return at + [
            _of(kind, name, joint, p, q, level, _changed_link(k, name, key, q)) for kind, key, p, q, level in own
        ]
    return [_of(kind, name, joint, p, q, level, _changed_link(k, name, key, q)) for kind, key, p, q, level in found]


def _placed(k: int, name: str, kind: str, pose: Pose) -> Change:
    """A link fixed elsewhere, or in another direction, on its body."""

    def change(tree: RigidTree) -> RigidTree:
        own = next(own for own in tree.bodies[k].members if own.link.name == name)
        mixed = Pose(own.pose.R, pose.p) if kind == "position" else Pose(pose.R, own.pose.p)
        return tree.changed_link(k, name, mixed)

    return change


def _lone(k: int, joint: str, name: str, x: Member | None, y: Member | None) -> Difference:
    """A link with mass that only one description has."""

    def change(tree: RigidTree) -> RigidTree:
        kept = [own for own in tree.bodies[k].members if y is not None or own.link.name != name]
        empty = [Member(Link(name))] if not kept else []
        return tree.changed(k, members=(*kept, *empty, *([] if y is None else [y])))

    masses = (own and own.link.mass for own in (x, y))
    return _of("link", name, joint, *masses, Level(1.0, False, True), change)


def _joint(k: int, x: Body, y: Body, tolerance: Tolerance, names: list[str]) -> Iterator[Difference]:
    """What differs of two joints."""
    name, unit = x.joint.name, "rad" if x.joint.type.rotates else "m"

    def told(kind: str, p: Any, q: Any, level: Level, change: Change | None, own_unit: str = "") -> Difference:
        return _of(kind, None, name, p, q, level, change, own_unit)

    level = tolerance.length(x.pose.p, y.pose.p)
    if level.differs:
        yield told("position", x.pose.p, y.pose.p, level, _pose(k, p=y.pose.p))
    level = tolerance.turn(x.pose.R, y.pose.R)
    if level.differs:
        yield told("orientation", *_rpy(x.pose.R, y.pose.R), level, _pose(k, R=y.pose.R))
    if x.joint.type.has_axis and y.joint.type.has_axis:
        level = tolerance.direction(x.joint.axis, y.joint.axis)
        if level.differs:
            yield told("axis", x.joint.axis, y.joint.axis, level, _joint_with(k, axis=y.joint.axis))
    if x.joint.type != y.joint.type:
        own_type = {"type": y.joint.type}
        same = x.joint.type.rotations == y.joint.type.rotations and x.joint.type.has_axis
        change = None if same else _joint_with(k, **own_type)
        yield told("type", str(x.joint.type), str(y.joint.type), Level(1.0, False, True), change, "no unit")
    yield from _mimic(k, x, y, tolerance, names)
    for key in EFFECTS:
        takes = (getattr(x.joint.effects, key), getattr(y.joint.effects, key))
        says = (getattr(x.joint.dynamics, key), getattr(y.joint.dynamics, key))
        for (p, q), part in ((takes, True), (says, False)):
            level = tolerance.number(p, q)
            if level.differs:
                yield told(key, p, q, level, _effect(k, key, q) if part else None)
                break
    for own in fields(Limits):
        p, q = getattr(x.joint.limits, own.name), getattr(y.joint.limits, own.name)
        least = 1.0 if own.name in ("lower", "upper") else 0.0
        level = tolerance.number(p, q, least) if math.isfinite(p) and math.isfinite(q) else Level(1.0, False, p != q)
        if level.differs:
            yield replace(told("limits", p, q, level, None, unit), kind=f"{own.name} limit")


def _mimic(k: int, x: Body, y: Body, tolerance: Tolerance, names: list[str]) -> Iterator[Difference]:
    p, q = x.joint.mimic, y.joint.mimic
    if p is None and q is None:
        return
    level = Level(1.0, False, True)
    if p is not None and q is not None and p.joint == q.joint:
        own = [tolerance.number(p.multiplier, q.multiplier), tolerance.number(p.offset, q.offset, 1.0)]
        level = max(own)
        if not any(one.differs for one in own):
            return
        level = next((one for one in own if one.beyond), level)
    told = [None if m is None else {"joint": names[m.joint], "multiplier": m.multiplier, "offset": m.offset} for m in (p, q)]
    yield _of("mimic", None, x.joint.name, *told, level, _joint_with(k, mimic=q))


def _joint_with(k: int, **numbers: Any) -> Change:
    return lambda tree: tree.changed_joint(k, **numbers)


def _effect(k: int, key: str, value: float) -> Change:
    return lambda tree: tree.changed_joint(k, effects=replace(tree.bodies[k].joint.effects, **{key: value}))


def _pose(k: int, **numbers: Array) -> Change:
    return lambda tree: tree.changed(k, pose=replace(tree.bodies[k].pose, **numbers))


def _rpy(x: Array, y: Array) -> tuple[list[float], list[float]]:
    return [*angles_of(x)], [*angles_of(y)]
