"""Laws of motion, energy and momentum: exact time derivatives, by dual numbers, against the results that are checked.

The derivatives contain no acceleration and no force of the recursion.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

from rttrr_pin.core.algebra import ZERO, Matrix, Scalar, Vector
from rttrr_pin.core.dual import part_of
from rttrr_pin.core.dynamics import joint_states
from rttrr_pin.core.energy import (
    LinkState,
    angular_momentum,
    in_base_axes,
    joint_effects_power,
    kinetic_energy,
    linear_momentum,
    now,
    payload_power,
    potential_energy,
    rate_of,
    spin,
)
from rttrr_pin.core.tangent import TIME
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.law import law

Wrench = tuple[Vector, Vector]
"""Force, and moment about the base's origin, in base axes."""


@law("K101", "joint motion")
def joint_motion(case: Case) -> Iterator[Scalar]:
    """Placement and velocity of a joint agree: R' = R [w]x, p' = R v, w' = w_dot, v' = v_dot."""
    q, v = case.flow
    states = joint_states(case.model, case.duals, q, v, case.a)
    for body, state in zip(case.links, states, strict=True):
        joint = body.type.motion(body, state, case.duals.sincos)
        turned = joint.R @ Matrix.skew(joint.w)
        for row, expected in zip(joint.R.rows, turned.rows, strict=True):
            yield from rate_of(row) - now(expected)
        yield from rate_of(joint.p) - now(joint.R @ joint.v)
        yield from rate_of(joint.w) - now(joint.w_dot)
        yield from rate_of(joint.v) - now(joint.v_dot)


@law("E201", "power balance", reads=("tau",))
def power(case: Case) -> Iterator[Scalar]:
    """The driving power is the rate of energy, the power of the payload and that of friction and armature:
    tau . v = d/dt (T + V) + f_tool . v + n_tool . w + tau_joint . v.
    """  # noqa: D205 - a statement of two lines
    states = joint_states(case.model, case.arithmetic, case.q, case.v, case.a)
    energy = kinetic_energy(case.links, case.moving) + potential_energy(case.links, case.moving, case.gravity)
    driving: Scalar = 0
    for force, rate in zip(case.result.tau, case.v, strict=True):
        driving = force * rate + driving
    joints = joint_effects_power(case.model, case.arithmetic, states, states)
    yield driving - part_of(energy, TIME) - payload_power(case.payloads, case.placed) - joints


@law("E202", "base force", reads=("f",))
def base_force(case: Case) -> Iterator[Scalar]:
    """The base's force changes the linear momentum and carries weight and payload: f_0 = d/dt P - M g + f_tool."""
    yield from _base(case)[0]


@law("E203", "base moment", reads=("f", "n"))
def base_moment(case: Case) -> Iterator[Scalar]:
    """The base's moment about its origin, likewise: n_0 = d/dt L - p_C x M g + n_tool + p x f_tool."""
    yield from _base(case)[1]


@law("B301", "Newton's law", reads=("F",))
def net_force(case: Case) -> Iterator[Scalar]:
    """The net force on a link changes its linear momentum: F = d/dt (M v_C) - M g."""
    for F, placed, change in zip(case.result.F, case.placed, _changes(case), strict=True):
        yield from placed.R @ F - change[0]


@law("B302", "Euler's law", reads=("N",))
def net_moment(case: Case) -> Iterator[Scalar]:
    """The net moment on a link changes its angular momentum about its centre of mass: N = d/dt (I w)."""
    for N, body, link, placed in zip(case.result.N, case.links, case.moving, case.placed, strict=True):
        yield from placed.R @ N - rate_of(spin(body, link))


@law("B303", "action and reaction, f", reads=("f",))
def force_balance(case: Case) -> Iterator[Scalar]:
    """The forces on a link add up; its children react with -f_c: f_i - sum f_c - f_tool = d/dt (M v_C) - M g."""
    for force, _ in _balances(case):
        yield from force


@law("B304", "action and reaction, n", reads=("f", "n"))
def moment_balance(case: Case) -> Iterator[Scalar]:
    """The moments about the base's origin, likewise: n_i - sum n_c - n_tool = d/dt (p_C x M v_C + I w) - p_C x M g."""
    for _, moment in _balances(case):
        yield from moment


def _changes(case: Case) -> list[Wrench]:
    """Of each link d/dt (M v_C) - M g and d/dt (p_C x M v_C + I w) - p_C x M g, in base axes."""
    changes = []
    for body, link, placed in zip(case.links, case.moving, case.placed, strict=True):
        weight = case.gravity * body.M
        P_dot, L_dot = rate_of(linear_momentum(body, link)), rate_of(angular_momentum(body, link))
        changes.append((P_dot - weight, L_dot - placed.position_of(body.r_C).cross(weight)))
    return changes


def _joint_wrenches(case: Case) -> list[Wrench]:
    """f_i, n_i of each link."""
    links = zip(case.placed, case.result.f, case.result.n, strict=True)
    return [_about_base(link, link.R @ f, link.R @ n) for link, f, n in links]


def _payloads(case: Case) -> dict[int, Wrench]:
    """The payloads by link."""
    total: dict[int, Wrench] = {}
    for payload in case.payloads:
        link = case.placed[payload.link]
        f, n = _about_base(link, *in_base_axes(payload, link))
        f_sum, n_sum = total.get(payload.link, (ZERO, ZERO))
        total[payload.link] = f_sum + f, n_sum + n
    return total


def _about_base(link: LinkState, f: Vector, n: Vector) -> Wrench:
    """What acts at the origin of a link, given in base axes."""
    return f, n + link.p.cross(f)


def _less(wrench: Wrench, *others: Wrench) -> Wrench:
    f, n = wrench
    for f_other, n_other in others:
        f, n = f - f_other, n - n_other
    return f, n


def _balances(case: Case) -> list[Wrench]:
    """Residual of force and moment of each link."""
    wrenches, payloads = _joint_wrenches(case), _payloads(case)
    on_children: list[list[Wrench]] = [[] for _ in wrenches]
    for joint, wrench in zip(case.model.joints, wrenches, strict=True):
        if joint.parent >= 0:
            on_children[joint.parent].append(wrench)
    links = enumerate(zip(wrenches, on_children, _changes(case), strict=True))
    return [_less(own, *children, change, payloads.get(i, (ZERO, ZERO))) for i, (own, children, change) in links]


def _base(case: Case) -> Wrench:
    """Residual of force and moment of the base on the whole robot."""
    roots = [wrench for joint, wrench in zip(case.model.joints, _joint_wrenches(case), strict=True) if joint.parent < 0]
    f, n = (reduce(Vector.__add__, (wrench[k] for wrench in roots), ZERO) for k in (0, 1))
    return _less((f, n), *_changes(case), *_payloads(case).values())
