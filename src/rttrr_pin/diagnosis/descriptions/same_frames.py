"""One description in the frames and coordinates of another: what is left then is a difference of robots.

Of the joint between two bodies either description may choose the frame: along the axis of a revolute joint, anywhere on
a prismatic one, and turned at will. Let X be the frame of B's body in that of A's. Then

    pose in A's terms   X_parent  pose_B  X^-1,      axis  R_X u_B,      inertia  that of B, moved by X

describe the motion of B exactly, if the origin of X lies on B's axis (revolute).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.descriptions.pairing import ROOT, Pairs
from rttrr_pin.diagnosis.descriptions.rigid_tree import AT_ORIGIN, Body, Member, Pose, RigidTree
from rttrr_pin.diagnosis.descriptions.tolerance import Level, Tolerance


@dataclass(frozen=True, slots=True, eq=False)
class Reframed:
    """B with the bodies, frames and coordinates of A.

    Attributes:
        tree: bodies in A's order, in A's frames.
        signs: of each, -1 where B counts its coordinate the other way.
        moved: of each, whether B has its frame elsewhere.
    """

    tree: RigidTree
    signs: tuple[float, ...]
    moved: tuple[bool, ...]


def reframed(a: RigidTree, b: RigidTree, pairs: Pairs, tolerance: Tolerance) -> Reframed:
    """B in the terms of A; every body of A has a counterpart, and every one of B is one."""
    frames: dict[int, Pose] = {ROOT: AT_ORIGIN}
    bodies, signs, moved = [], [], []
    back = {j: i for i, j in pairs.items()}
    for i, of_a in enumerate(a.bodies):
        of_b = b.bodies[pairs[i]]
        carrier = frames[of_a.parent] @ of_b.pose
        choices = [
            (_unlike(a, b, i, pairs, carrier, x, tolerance), k, x) for k, x in enumerate(_choices(of_a, of_b, carrier))
        ]
        _, k, frame = min(choices, key=lambda one: one[:2])
        frames[i] = frame
        own = _in_frame(of_a, of_b, carrier, frame)
        sign = -1.0 if of_a.joint.type.has_axis and float(own.joint.axis @ of_a.joint.axis) < 0.0 else 1.0
        bodies.append(_turned(own, sign))
        signs.append(sign)
        moved.append(k > 0)
    for i, body in enumerate(bodies):
        mimic = body.joint.mimic
        if mimic is not None:  # q_i = s_i (m s_l q_l + o)
            leader = back[mimic.joint]
            own_mimic = replace(
                mimic,
                joint=leader,
                multiplier=signs[i] * signs[leader] * mimic.multiplier,
                offset=signs[i] * mimic.offset,
            )
            bodies[i] = replace(body, joint=replace(body.joint, mimic=own_mimic))
    return Reframed(replace(a, base=b.base, bodies=tuple(bodies), gravity=b.gravity), tuple(signs), tuple(moved))


def _choices(of_a: Body, of_b: Body, carrier: Pose) -> Iterator[Pose]:
    """Frames of B's body in A's: the same; then such that both joints are in the same place at zero."""
    yield AT_ORIGIN
    if not of_a.joint.type.has_axis:
        return
    there = of_a.pose.inverse @ carrier
    u = there.R @ of_b.joint.axis
    along = u * float(u @ there.p) if of_b.joint.type.rotates else there.p
    yield Pose(there.R, along)
    yield Pose(there.R, np.zeros(3))
    v = of_b.joint.axis
    yield Pose(np.eye(3), v * float(v @ there.p) if of_b.joint.type.rotates else there.p)


def _in_frame(of_a: Body, of_b: Body, carrier: Pose, frame: Pose) -> Body:
    """B's body in a frame of A's, all but whom it follows, and its direction."""
    members = tuple(Member(own.link, frame @ own.pose) for own in of_b.members)
    axis = frame.R @ of_b.joint.axis if of_b.joint.type.has_axis else of_b.joint.axis
    if frame is not AT_ORIGIN and of_b.joint.type.has_axis:
        axis = axis / np.linalg.norm(axis)
    return Body(replace(of_b.joint, axis=axis), of_a.parent, carrier @ frame.inverse, members)


def _turned(body: Body, sign: float) -> Body:
    """The body, whose joint counts its coordinate by the axis and no more against it."""
    if sign > 0.0:
        return body
    own = body.joint.limits
    limits = replace(own, lower=-own.upper, upper=-own.lower)
    return replace(body, joint=replace(body.joint, axis=-body.joint.axis, limits=limits))


def _unlike(
    a: RigidTree, b: RigidTree, i: int, pairs: Pairs, carrier: Pose, frame: Pose, tolerance: Tolerance
) -> tuple[int, float]:
    """How many numbers differ in this frame: of the joint, the body, and the lines of the joints that it carries."""
    of_a, of_b = a.bodies[i], b.bodies[pairs[i]]
    own = _in_frame(of_a, of_b, carrier, frame)
    found = [
        tolerance.length(of_a.pose.p, own.pose.p),
        tolerance.turn(of_a.pose.R, own.pose.R),
        tolerance.direction(of_a.joint.axis, own.joint.axis),
    ]
    x, y = of_a.inertia, own.inertia
    if x.mass and y.mass:
        found.append(tolerance.length(x.moment / x.mass, y.moment / y.mass))
    found.append(tolerance.tensor(x.inertia, y.inertia, (x.mass, y.mass)))
    for k, child in enumerate(a.bodies):
        if child.parent == i:
            other = b.bodies[pairs[k]]
            found += _lines(child, other, frame @ other.pose, tolerance)
    return sum(level.beyond for level in found), sum(level.size for level in found if level.beyond)


def _lines(x: Body, y: Body, pose: Pose, tolerance: Tolerance) -> Iterator[Level]:
    """How far two joints are from each other as lines (revolute), directions (prismatic) or frames."""
    if not (x.joint.type.has_axis and y.joint.type.has_axis):
        yield tolerance.length(x.pose.p, pose.p)
        yield tolerance.turn(x.pose.R, pose.R)
        return
    u, v = x.pose.R @ x.joint.axis, pose.R @ y.joint.axis
    yield tolerance.direction(u, v if float(u @ v) >= 0.0 else -v)
    if x.joint.type.rotates:
        apart: Array = pose.p - x.pose.p
        yield tolerance.length(x.pose.p, x.pose.p + apart - u * float(u @ apart))
