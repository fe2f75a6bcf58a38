"""How coordinates move: the directions in which rates take them, for derivatives by dual numbers.

Of most joints the rate of a coordinate is its derivative. Of planar and floating joints the rates are a twist in {i},
and x, y, z and the quaternion move as that twist says.
"""

from __future__ import annotations

from collections.abc import Sequence

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.core.dual import Dual, value_of
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.scalars import Arithmetic

TIME = 0
"""The direction of time."""


def in_time(
    joints: Sequence[Joint], q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar], arithmetic: Arithmetic
) -> tuple[list[Dual], list[Dual]]:
    """Coordinates and rates as functions of time, to the first order: duals along `TIME`.

    q' is what v says, and v' is a; `joints` are those that move and follow no other.
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
        duals += joint.type.tangent(q[at : at + joint.nq], k, arithmetic.sincos)
        at, k = at + joint.nq, k + joint.nv
    return duals


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
