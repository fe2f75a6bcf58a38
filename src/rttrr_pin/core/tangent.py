"""How coordinates move: the directions in which rates take them, for derivatives by dual numbers.

Of most joints the rate of a coordinate is its derivative. Of planar and floating joints the rates are a twist in {i},
and x, y, z and the quaternion move as that twist says.
"""

from __future__ import annotations

from collections.abc import Sequence

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.core.dual import Dual, value_of
from rttrr_pin.core.joint import Joint, JointType
from rttrr_pin.core.joint_motion import quaternion_rotation
from rttrr_pin.core.scalars import Arithmetic

TIME = 0
"""The direction of time."""


def in_time(
    joints: Sequence[Joint], q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar], arithmetic: Arithmetic
) -> tuple[list[Dual], list[Dual]]:
    """Coordinates and rates as functions of time, to the first order: duals along `TIME`.

    Args:
        joints: those that move and follow no other.
        q: coordinates [rad or m].
        v: rates.
        a: accelerations.
        arithmetic: the kind of scalar of q, v and a.

    Returns:
        q with q' = what v says, and v with v' = a.
    """
    moved = []
    for x in tangent(joints, q, arithmetic):
        rate: Scalar = 0
        for k, part in x.parts.items():
            rate = part * v[k] + rate
        moved.append(Dual(x.value, {TIME: rate}))
    return moved, [Dual(x, {TIME: x_dot}) for x, x_dot in zip(v, a, strict=True)]


def tangent(joints: Sequence[Joint], q: Sequence[Scalar], arithmetic: Arithmetic) -> list[Dual]:
    """Coordinates that move as the rates say: those of planar and floating joints are turned into the joint's frame."""
    duals: list[Dual] = []
    at, k = 0, 0
    for joint in joints:
        own = q[at : at + joint.nq]
        if joint.type is JointType.FLOATING:
            duals += _floating_tangent(own, k)
        elif joint.type is JointType.PLANAR:
            duals += _planar_tangent(own, k, arithmetic)
        else:
            duals += [Dual(x, {k + i: 1.0}) for i, x in enumerate(own)]
        at, k = at + joint.nq, k + joint.nv
    return duals


def _planar_tangent(own: Sequence[Scalar], k: int, arithmetic: Arithmetic) -> list[Dual]:
    """With x' = c v_x - s v_y, y' = s v_x + c v_y and theta' = w_z for directions k to k + 2."""
    x, y, theta = own
    s, c = arithmetic.sincos(theta)
    return [Dual(x, {k: c, k + 1: -s}), Dual(y, {k: s, k + 1: c}), Dual(theta, {k + 2: 1.0})]


def _floating_tangent(own: Sequence[Scalar], k: int) -> list[Dual]:
    """With p' = R v and (x, y, z, w)' = (x, y, z, w) (w_x, w_y, w_z, 0) / 2 for directions k (v_x) to k + 5 (w_z)."""
    x, y, z, w = own[3:]
    R = quaternion_rotation(x, y, z, w)
    position = [Dual(p, {k + i: r for i, r in enumerate(row)}) for p, row in zip(own[:3], R.rows, strict=True)]
    turns = ((w, -z, y), (z, w, -x), (-y, x, w), (-x, -y, -z))
    quaternion = [
        Dual(c, {k + 3 + i: t * 0.5 for i, t in enumerate(turn)}) for c, turn in zip((x, y, z, w), turns, strict=True)
    ]
    return position + quaternion


def over_duals(arithmetic: Arithmetic) -> Arithmetic:
    """Dual numbers over the scalars of an arithmetic.

    Applied twice it gives second derivatives; then every scalar that moves must be a dual of duals, with parts or
    without, so that no inner dual meets an outer one.
    """

    def sincos(q: Scalar) -> tuple[Scalar, Scalar]:
        s, c = arithmetic.sincos(value_of(q))
        if not isinstance(q, Dual):
            return s, c
        return Dual(s, {k: c * part for k, part in q.parts.items()}), Dual(
            c, {k: -(s * part) for k, part in q.parts.items()}
        )

    return Arithmetic(
        number=arithmetic.number,
        column=arithmetic.column,
        sincos=sincos,
        sign=lambda x: arithmetic.sign(value_of(x)),  # constant but for the jump at rest
    )
