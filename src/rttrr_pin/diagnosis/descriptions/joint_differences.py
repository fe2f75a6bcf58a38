"""What two descriptions of a joint say differently."""

from __future__ import annotations

import math
from collections.abc import Iterator, Set
from dataclasses import fields, replace
from typing import Any

from rttrr_pin.core.arrays import Array, angles_of
from rttrr_pin.core.joint import EFFECTS, Limits
from rttrr_pin.diagnosis.descriptions.difference import Change, Difference, difference_of
from rttrr_pin.diagnosis.descriptions.rigid_tree import Body, RigidTree
from rttrr_pin.diagnosis.descriptions.tolerance import UNLIKE, Level, Tolerance

ANGLE = {
    "armature": "kg m^2",
    "damping": "N m s/rad",
    "friction": "N m",
    "lower": "rad",
    "upper": "rad",
    "velocity": "rad/s",
    "effort": "N m",
}
LENGTH = {
    "armature": "kg",
    "damping": "N s/m",
    "friction": "N",
    "lower": "m",
    "upper": "m",
    "velocity": "m/s",
    "effort": "N",
}
"""Units of what a joint has, by what its coordinate is."""


def joint_differences(
    k: int, x: Body, y: Body, tolerance: Tolerance, names: list[str], unset: Set[str]
) -> Iterator[Difference]:
    """What differs of joint k of two descriptions; limits that one of them sets nowhere are left out."""
    yield from _placement(k, x, y, tolerance)
    yield from _motion(k, x, y, tolerance)
    yield from _mimic(k, x, y, tolerance, names)
    yield from _effects(k, x, y, tolerance)
    yield from _limits(x, y, tolerance, unset)


def _placement(k: int, x: Body, y: Body, tolerance: Tolerance) -> Iterator[Difference]:
    level = tolerance.length(x.pose.p, y.pose.p)
    if level.differs:
        yield difference_of("position", None, x.joint.name, (x.pose.p, y.pose.p), level, _pose(k, p=y.pose.p))
    level = tolerance.turn(x.pose.R, y.pose.R)
    if level.differs:
        both = (rpy(x.pose.R), rpy(y.pose.R))
        yield difference_of("orientation", None, x.joint.name, both, level, _pose(k, R=y.pose.R))


def _motion(k: int, x: Body, y: Body, tolerance: Tolerance) -> Iterator[Difference]:
    """Axis and type; a revolute joint and a continuous one move alike."""
    p, q = x.joint.type, y.joint.type
    if p.has_axis and q.has_axis:
        level = tolerance.direction(x.joint.axis, y.joint.axis)
        if level.differs:
            both = (x.joint.axis, y.joint.axis)
            yield difference_of("axis", None, x.joint.name, both, level, _joint(k, axis=y.joint.axis))
    if p != q:
        alike = p.rotations == q.rotations and p.has_axis and q.has_axis
        change = None if alike else _joint(k, type=q, axis=y.joint.axis)
        yield difference_of("type", None, x.joint.name, (str(p), str(q)), UNLIKE, change)


def _mimic(k: int, x: Body, y: Body, tolerance: Tolerance, names: list[str]) -> Iterator[Difference]:
    p, q = x.joint.mimic, y.joint.mimic
    if p is None and q is None:
        return
    level = UNLIKE
    if p is not None and q is not None and p.joint == q.joint:
        own = (tolerance.number(p.multiplier, q.multiplier), tolerance.number(p.offset, q.offset, 1.0))
        level = max(own, key=lambda one: (one.beyond, one.size))
        if not any(one.differs for one in own):
            return
    said = [m and {"joint": names[m.joint], "multiplier": m.multiplier, "offset": m.offset} for m in (p, q)]
    yield difference_of("mimic", None, x.joint.name, (said[0], said[1]), level, lambda tree: tree.following(k, q))


def _effects(k: int, x: Body, y: Body, tolerance: Tolerance) -> Iterator[Difference]:
    """What takes part in tau; else what the file says, and takes none."""
    for key in EFFECTS:
        unit = _units(x)[key]
        p, q = getattr(x.joint.effects, key), getattr(y.joint.effects, key)
        level = tolerance.number(p, q)
        if level.differs:
            yield difference_of(key, None, x.joint.name, (p, q), level, _effect(k, key, q), unit)
            continue
        p, q = getattr(x.joint.dynamics, key), getattr(y.joint.dynamics, key)
        level = tolerance.number(p, q)
        if level.differs:
            yield difference_of(key, None, x.joint.name, (p, q), level, None, unit)


def _limits(x: Body, y: Body, tolerance: Tolerance, unset: Set[str]) -> Iterator[Difference]:
    for key in (own.name for own in fields(Limits) if own.name not in unset):
        p, q = getattr(x.joint.limits, key), getattr(y.joint.limits, key)
        finite = math.isfinite(p) and math.isfinite(q)
        least = 1.0 if key in ("lower", "upper") else 0.0
        level = tolerance.number(p, q, least) if finite else Level(1.0, False, p != q)
        if level.differs:
            yield difference_of(f"{key} limit", None, x.joint.name, (p, q), level, None, _units(x)[key])


def unset_limits(tree: RigidTree) -> list[str]:
    """The kinds of limits that a description sets for no joint."""
    limits = [body.joint.limits for body in tree.bodies]
    return [own.name for own in fields(Limits) if all(math.isinf(getattr(x, own.name)) for x in limits)]


def rpy(R: Array) -> list[float]:
    """Roll, pitch, yaw as a list."""
    return [*angles_of(R)]


def _units(x: Body) -> dict[str, str]:
    return ANGLE if any(x.joint.type.rotations) else LENGTH


def _joint(k: int, **numbers: Any) -> Change:
    return lambda tree: tree.changed_joint(k, **numbers)


def _effect(k: int, key: str, value: float) -> Change:
    return lambda tree: tree.changed_joint(k, effects=replace(tree.bodies[k].joint.effects, **{key: value}))


def _pose(k: int, **numbers: Array) -> Change:
    return lambda tree: tree.changed(k, pose=replace(tree.bodies[k].pose, **numbers))
