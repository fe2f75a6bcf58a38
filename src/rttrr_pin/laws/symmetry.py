"""Laws that compare results of the recursion: linearity, invariance, scaling.

Each says how another motion, another field or another description of the robot changes the forces. Factors and vectors
are arbitrary, and exact in binary.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from rttrr_pin.core.algebra import IDENTITY, ZERO, Matrix, Scalar, Vector, rotation
from rttrr_pin.core.dynamics import Result
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.law import law

SCALE = 3
"""No power of two, so that it rounds as other factors do."""


@dataclass(frozen=True, slots=True)
class Frame:
    """A new frame of link i: R maps its vectors to {i}; p is where its origin is, in {i} [m]."""

    R: Matrix
    p: Vector


@law("L501", "linear in acceleration")
def in_acceleration(case: Case) -> Iterator[Scalar]:
    """Forces superpose in the accelerations: at x + y those at x and at y less those at 0."""
    # x = a, and y = -a/2 with joints exchanged
    y = [x * -0.5 for x in (*case.a[1:], *case.a[:1])]
    both = [one + other for one, other in zip(case.a, y, strict=True)]
    yield from _superposed(case.forces(a=both), case.result, case.forces(a=y), case.forces(a=case.at_rest))


@law("L502", "linear in gravity")
def in_gravity(case: Case) -> Iterator[Scalar]:
    """Forces superpose in the field: in g + h those in g and in h less those in none."""
    h = case.vector(1.5, -2.25, 3.0)
    both, other, none = (case.forces(gravity=field) for field in (case.gravity + h, h, ZERO))
    yield from _superposed(both, case.result, other, none)


@law("L503", "linear in inertia")
def in_inertia(case: Case) -> Iterator[Scalar]:
    """Forces superpose in mass, first moment and tensor: a link made of two bodies has those of both less those of
    none.

    Mass, first moment, and tensor about a common point add up. A link is split into a quarter of its mass at r_C + 3 d
    and three quarters at r_C - d; with the tensor that takes, 3 M (d.d E - d d^T), they make the link. N is left out,
    since it is about the centre of mass of each.
    """  # noqa: D205 - a statement of two lines
    parts = [_split(case, body, i) for i, body in enumerate(case.links)]
    one, other = (case.forces(links=list(half)) for half in zip(*parts, strict=True))
    massless = [replace(body, M=0, r_C=ZERO, I=Matrix((ZERO, ZERO, ZERO))) for body in case.links]
    none = case.forces(links=massless)
    yield from _superposed(case.result, one, other, none, ("F", "f", "n"))


@law("I601", "base frame")
def under_base(case: Case) -> Iterator[Scalar]:
    """A base frame that is moved and rotated, and the field with it, changes no force."""
    p = case.vector(0.75, -0.5, 1.25)
    R = _turn(case, 0.875, (0, 0, 1)) @ _turn(case, -0.625, (1, 0, 0))
    links = [
        replace(body, R=R @ body.R, p=p + R @ body.p) if joint.parent < 0 else body
        for joint, body in zip(case.model.joints, case.links, strict=True)
    ]
    payloads = [replace(x, f=R @ x.f, n=R @ x.n) if x.in_base else x for x in case.payloads]
    yield from _differences(case.result, case.forces(links=links, payloads=payloads, gravity=R @ case.gravity))


@law("I602", "link frames")
def under_frames(case: Case) -> Iterator[Scalar]:
    """Other link frames change the components of forces, and no driving force."""
    # A frame may be rotated at will where the joint's axis can be written in the new axes, and moved along what the
    # joint leaves alone. Planar and floating joints keep theirs, since their rates are components in {i}.
    turn = _turn(case, 0.375, (0, 1, 0)) @ _turn(case, 1.125, (0, 0, 1))
    offset = case.vector(0.25, -0.5, 0.125)
    shifts = [body.type.origin_shift(body.axis, offset) for body in case.links]
    frames = [Frame(IDENTITY, ZERO) if shift is None else Frame(turn, shift) for shift in shifts]
    other = _reframed(case, frames)
    f, n, F, N = [], [], [], []
    for frame, F_i, N_i, f_i, n_i in zip(frames, other.F, other.N, other.f, other.n, strict=True):
        F.append(frame.R @ F_i)
        N.append(frame.R @ N_i)
        f.append(frame.R @ f_i)
        n.append(frame.R @ n_i + frame.p.cross(f[-1]))
    yield from _differences(case.result, replace(other, F=F, N=N, f=f, n=n))


@law("S701", "scale of mass")
def under_mass(case: Case) -> Iterator[Scalar]:
    """s times the masses take s times the forces."""  # noqa: D403 - s is a factor
    links = [replace(body, M=body.M * SCALE, I=body.I * SCALE) for body in case.links]
    yield from _scaled(case.result, case.forces(links=links, payloads=_times(case.payloads, SCALE)), SCALE)


@law("S702", "scale of time")
def under_time(case: Case) -> Iterator[Scalar]:
    """A motion s times as fast, in s^2 times the field, takes s^2 times the forces."""
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
    d = case.vector(0.25, -0.125 * (1 + i % 3), 0.375)
    apart = point_tensor(d) * body.M * 3
    x = Matrix((case.vector(0.5, 0.25, -0.125), case.vector(0.25, -0.375, 0.0625), case.vector(-0.125, 0.0625, 0.75)))
    quarter = replace(body, M=body.M * 0.25, r_C=body.r_C + d * 3, I=body.I * 0.25 + x)
    return quarter, replace(body, M=body.M * 0.75, r_C=body.r_C - d, I=body.I * 0.75 - x - apart)


def _reframed(case: Case, frames: Sequence[Frame]) -> Result:
    """The results of the recursion in the new frames, about their origins and in their axes.

    With S, o the frame of the link and P, c that of its parent:

        R' = P^T R S,   p' = P^T (p + R o - c),   u' = S^T u,   r_C' = S^T (r_C - o),   I' = S^T I S
    """
    links = []
    for joint, body, frame in zip(case.model.joints, case.links, frames, strict=True):
        parent = frames[joint.parent] if joint.parent >= 0 else Frame(IDENTITY, ZERO)
        P, S, o = parent.R, frame.R, frame.p
        R, p = P.T @ body.R @ S, P.T @ (body.p + body.R @ o - parent.p)
        links.append(replace(body, R=R, p=p, axis=S.T @ body.axis, r_C=S.T @ (body.r_C - o), I=S.T @ body.I @ S))
    return case.forces(links=links, payloads=[_about(case, x, frames[x.link]) for x in case.payloads])


def _about(case: Case, payload: Payload, frame: Frame) -> Payload:
    """The payload about the new origin, in base axes or those of the new frame as it was."""
    if payload.in_base:
        arm = case.placed[payload.link].R @ frame.p
        return replace(payload, n=payload.n - arm.cross(payload.f))
    moment = payload.n - frame.p.cross(payload.f)
    return replace(payload, f=frame.R.T @ payload.f, n=frame.R.T @ moment)
