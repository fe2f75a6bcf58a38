"""Laws that compare results of the recursion: linearity, invariance, scaling.

Each says how another motion, another field or another description of the robot changes the forces. Factors and vectors
are arbitrary, and exact in binary.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rttrr_pin.core.algebra import ZERO, Matrix, Scalar, Vector
from rttrr_pin.core.dynamics import Result
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.rotations import rotation
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.reframe import reframed, reframing

SCALE = 3
"""No power of two, so that it rounds as other factors do."""


def in_acceleration(case: Case) -> Iterator[Scalar]:
    """All quantities at x + y, less those at x and at y, with those at 0; x = a, y = -a/2 with joints exchanged."""
    y = [x * -0.5 for x in (*case.a[1:], *case.a[:1])]
    both = [one + other for one, other in zip(case.a, y, strict=True)]
    yield from _superposed(case.forces(a=both), case.result, case.forces(a=y), case.forces(a=case.at_rest))


def in_gravity(case: Case) -> Iterator[Scalar]:
    """All quantities in the field g + h, less those in g and in h, with those in none; h is another field."""
    h = Vector.of((1.5, -2.25, 3.0), lambda value: case.arithmetic.number(value, 0.0))
    both, other, none = (case.forces(gravity=field) for field in (case.gravity + h, h, ZERO))
    yield from _superposed(both, case.result, other, none)


def in_inertia(case: Case) -> Iterator[Scalar]:
    """Tau, F, f, n of each link whole, less those of its two parts, with those of none.

    Mass, first moment, and tensor about a common point add up. A link is split into a quarter of its mass at r_C + 3 d
    and three quarters at r_C - d; with the tensor that takes, 3 M (d.d E - d d^T), they make the link.
    """
    parts = [_split(case, body, i) for i, body in enumerate(case.links)]
    one, other = (case.forces(links=list(half)) for half in zip(*parts, strict=True))
    none = case.forces(links=[_without_inertia(body) for body in case.links])
    yield from _superposed(case.result, one, other, none, ("F", "f", "n"))


def under_base(case: Case) -> Iterator[Scalar]:
    """All quantities, less those on a base frame that is moved and rotated, gravity and payloads with it."""
    number = case.arithmetic.number
    p = Vector.of((0.75, -0.5, 1.25), lambda value: number(value, 0.0))
    R = _turn(case, 0.875, (0, 0, 1)) @ _turn(case, -0.625, (1, 0, 0))
    links = [
        replace(body, R=R @ body.R, p=p + R @ body.p) if joint.parent < 0 else body
        for joint, body in zip(case.model.joints, case.links, strict=True)
    ]
    payloads = [replace(x, f=R @ x.f, n=R @ x.n) if x.in_base else x for x in case.payloads]
    yield from _differences(case.result, case.forces(links=links, payloads=payloads, gravity=R @ case.gravity))


def under_frames(case: Case) -> Iterator[Scalar]:
    """All quantities, less those in link frames that are rotated, and moved as far as their joint allows."""
    turn = _turn(case, 0.375, (0, 1, 0)) @ _turn(case, 1.125, (0, 0, 1))
    frames = reframing(case, turn)
    other = reframed(case, frames)
    f, n, F, N = [], [], [], []
    for frame, F_i, N_i, f_i, n_i in zip(frames, other.F, other.N, other.f, other.n, strict=True):
        F.append(frame.R @ F_i)
        N.append(frame.R @ N_i)
        f.append(frame.R @ f_i)
        n.append(frame.R @ n_i + frame.p.cross(f[-1]))
    yield from _differences(case.result, replace(other, F=F, N=N, f=f, n=n))


def under_mass(case: Case) -> Iterator[Scalar]:
    """All quantities times s, less those at s times the masses, tensors and payloads; tau without tau_joint."""
    links = [replace(body, M=body.M * SCALE, I=body.I * SCALE) for body in case.links]
    yield from _scaled(case.result, case.forces(links=links, payloads=_times(case.payloads, SCALE)), SCALE)


def under_time(case: Case) -> Iterator[Scalar]:
    """All quantities times s^2, less those s times as fast, at s^2 times field and payloads; tau without tau_joint."""
    v, a = [x * SCALE for x in case.v], [x * SCALE**2 for x in case.a]
    faster = case.forces(v, a, _times(case.payloads, SCALE**2), gravity=case.gravity * SCALE**2)
    yield from _scaled(case.result, faster, SCALE**2)


def _superposed(
    both: Result, one: Result, other: Result, none: Result, keys: Sequence[str] = LINK_QUANTITIES
) -> Iterator[Scalar]:
    """Both - one - other + none."""
    rows = (result.scalars(("tau", *keys)) for result in (both, one, other, none))
    for x, y, z, zero in zip(*rows, strict=True):
        yield x - y - z + zero


def _differences(one: Result, other: Result) -> Iterator[Scalar]:
    for x, y in zip(one.scalars(), other.scalars(), strict=True):
        yield x - y


def _scaled(result: Result, other: Result, factor: int) -> Iterator[Scalar]:
    """Factor times the one, less the other; tau without tau_joint."""
    one, scaled = ([x - own for x, own in zip(r.tau, r.tau_joint, strict=True)] for r in (result, other))
    pairs = zip((*one, *result.scalars(LINK_QUANTITIES)), (*scaled, *other.scalars(LINK_QUANTITIES)), strict=True)
    yield from (x * factor - y for x, y in pairs)


def _times(payloads: Sequence[Payload], factor: int) -> list[Payload]:
    return [replace(x, f=x.f * factor, n=x.n * factor) for x in payloads]


def _turn(case: Case, angle: float, axis: tuple[int, int, int]) -> Matrix:
    """The rotation by an angle about a coordinate axis, within the rounding of its sine and cosine."""
    return rotation(Vector(*axis), case.arithmetic.column(angle), case.arithmetic.sincos)


def _split(case: Case, body: Body, i: int) -> tuple[Body, Body]:
    """Two bodies that make the link together."""

    def vector(*values: float) -> Vector:
        return Vector.of(values, lambda value: case.arithmetic.number(value, 0.0))

    d = vector(0.25, -0.125 * (1 + i % 3), 0.375)
    apart = point_tensor(d) * body.M * 3
    x = Matrix((vector(0.5, 0.25, -0.125), vector(0.25, -0.375, 0.0625), vector(-0.125, 0.0625, 0.75)))
    quarter = replace(body, M=body.M * 0.25, r_C=body.r_C + d * 3, I=body.I * 0.25 + x)
    return quarter, replace(body, M=body.M * 0.75, r_C=body.r_C - d, I=body.I * 0.75 - x - apart)


def _without_inertia(body: Body) -> Body:
    return replace(body, M=0, r_C=ZERO, I=Matrix((ZERO, ZERO, ZERO)))
