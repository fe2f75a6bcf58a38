"""Laws of motion, energy and momentum: exact time derivatives, by dual numbers, against the results that are checked.

Each function yields the residual of its law. The derivatives contain no acceleration and no force of the recursion.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

from rttrr_pin.core.algebra import ZERO, Matrix, Scalar, Vector
from rttrr_pin.core.dual import part_of
from rttrr_pin.core.dynamics import joint_states
from rttrr_pin.core.energy import (
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

Wrench = tuple[Vector, Vector]
"""Force, and moment about the base's origin, in base axes."""


def joint_motion(case: Case) -> Iterator[Scalar]:
    """R' - R [w]x,  p' - R v,  w' - w_dot,  v' - v_dot of every joint."""
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


def power(case: Case) -> Iterator[Scalar]:
    """Tau . v - d/dt (T + V) - f_tool . v - n_tool . w - tau_joint . v."""
    states = joint_states(case.model, case.arithmetic, case.q, case.v, case.a)
    energy = kinetic_energy(case.links, case.moving) + potential_energy(case.links, case.moving, case.gravity)
    driving: Scalar = 0
    for force, rate in zip(case.result.tau, case.v, strict=True):
        driving = force * rate + driving
    joints = joint_effects_power(case.model, case.arithmetic, states, states)
    yield driving - part_of(energy, TIME) - payload_power(case.payloads, case.placed) - joints


def base_force(case: Case) -> Iterator[Scalar]:
    """f_0 - d/dt P + M g - f_tool, in base axes."""
    yield from _base(case)[0]


def base_moment(case: Case) -> Iterator[Scalar]:
    """n_0 - d/dt L + p_C x M g - n_tool - p x f_tool, about the base's origin."""
    yield from _base(case)[1]


def net_force(case: Case) -> Iterator[Scalar]:
    """F_i - d/dt (M v_C) + M g of every link, in base axes."""
    for F, placed, change in zip(case.result.F, case.placed, _changes(case), strict=True):
        yield from placed.R @ F - change[0]


def net_moment(case: Case) -> Iterator[Scalar]:
    """N_i - d/dt (I w) of every link, in base axes."""
    for N, body, link, placed in zip(case.result.N, case.links, case.moving, case.placed, strict=True):
        yield from placed.R @ N - rate_of(spin(body, link))


def force_balance(case: Case) -> Iterator[Scalar]:
    """f_i - sum f_c - f_tool - d/dt (M v_C) + M g of every link, in base axes."""
    for force, _ in _balances(case):
        yield from force


def moment_balance(case: Case) -> Iterator[Scalar]:
    """n_i - sum n_c - n_tool - d/dt (p_C x M v_C + I w) + p_C x M g of every link, about the base's origin."""
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
    """f_i, n_i of each link, in base axes about the base's origin."""
    forces = [link.R @ f for link, f in zip(case.placed, case.result.f, strict=True)]
    moments = [link.R @ n for link, n in zip(case.placed, case.result.n, strict=True)]
    return [(f, n + link.p.cross(f)) for link, f, n in zip(case.placed, forces, moments, strict=True)]


def _payloads(case: Case) -> dict[int, Wrench]:
    """The payloads by link, in base axes about the base's origin."""
    total: dict[int, Wrench] = {}
    for payload in case.payloads:
        link = case.placed[payload.link]
        f, n = in_base_axes(payload, link)
        f_sum, n_sum = total.get(payload.link, (ZERO, ZERO))
        total[payload.link] = f_sum + f, n_sum + n + link.p.cross(f)
    return total


def _balances(case: Case) -> list[Wrench]:
    """Residual of force and moment of each link."""
    wrenches, payloads = _joint_wrenches(case), _payloads(case)
    residuals = [list(wrench) for wrench in wrenches]
    for i, joint in enumerate(case.model.joints):
        if joint.parent >= 0:
            residuals[joint.parent] = [x - y for x, y in zip(residuals[joint.parent], wrenches[i], strict=True)]
    for i, change in enumerate(_changes(case)):
        for wrench in (change, payloads.get(i, (ZERO, ZERO))):
            residuals[i] = [x - y for x, y in zip(residuals[i], wrench, strict=True)]
    return [(f, n) for f, n in residuals]


def _base(case: Case) -> Wrench:
    """Residual of force and moment of the base on the whole robot."""
    roots = [wrench for joint, wrench in zip(case.model.joints, _joint_wrenches(case), strict=True) if joint.parent < 0]
    f, n = (reduce(Vector.__add__, (wrench[k] for wrench in roots), ZERO) for k in (0, 1))
    for wrench in (*_changes(case), *_payloads(case).values()):
        f, n = f - wrench[0], n - wrench[1]
    return f, n
