"""Laws of motion, energy and momentum: derivatives by time, exact by duals, against what the recursion says.

Each function gives what the law says is zero. Nothing of the recursion's own accelerations or forces goes into the
derivatives.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce

from rttrr_pin.core.algebra import ZERO, Matrix, Scalar, Vector
from rttrr_pin.core.dual import part_of
from rttrr_pin.core.dynamics import joint_states
from rttrr_pin.core.energy import (
    angular_momentum,
    drive_power,
    in_base_axes,
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


def flat(vectors: Sequence[Vector]) -> list[Scalar]:
    """The components of vectors, one after another."""
    return [x for vector in vectors for x in vector]


def kinematics(case: Case) -> Iterator[Scalar]:
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
    """The power tau . v, less d/dt (T + V), what the payload gets and what the joints take."""
    states = joint_states(case.model, case.arithmetic, case.q, case.v, case.a)
    energy = kinetic_energy(case.links, case.moving) + potential_energy(case.links, case.moving, case.gravity)
    driven: Scalar = 0
    for force, rate in zip(case.result.tau, case.v, strict=True):
        driven = force * rate + driven
    given = payload_power(case.payloads, case.placed) + drive_power(case.model, case.arithmetic, states, states)
    yield driven - part_of(energy, TIME) - given


def base_force(case: Case) -> Iterator[Scalar]:
    """What the base exerts, less d/dt of the linear momentum, weight and payload."""
    yield from _base(case)[0]


def base_moment(case: Case) -> Iterator[Scalar]:
    """The same for moments and the angular momentum, about the base's origin."""
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
    """f_i - sum of the children's f - f_tool - d/dt (M v_C) + M g of every link, in base axes."""
    for force, _ in _balances(case):
        yield from force


def moment_balance(case: Case) -> Iterator[Scalar]:
    """The same for moments and the angular momentum of the link, about the base's origin."""
    for _, moment in _balances(case):
        yield from moment


def _changes(case: Case) -> list[Wrench]:
    """Of each link: d/dt of its linear and angular momentum, less what its weight does to them."""
    changes = []
    for body, link, placed in zip(case.links, case.moving, case.placed, strict=True):
        weight = case.gravity * body.M
        P_dot, L_dot = rate_of(linear_momentum(body, link)), rate_of(angular_momentum(body, link))
        changes.append((P_dot - weight, L_dot - placed.place_of(body.r_C).cross(weight)))
    return changes


def _across(case: Case) -> list[Wrench]:
    """f_i, n_i of each link, turned and moved to the base."""
    forces = [link.R @ f for link, f in zip(case.placed, case.result.f, strict=True)]
    moments = [link.R @ n for link, n in zip(case.placed, case.result.n, strict=True)]
    return [(f, n + link.p.cross(f)) for link, f, n in zip(case.placed, forces, moments, strict=True)]


def _given(case: Case) -> dict[int, Wrench]:
    """The payloads by link, turned and moved to the base."""
    total: dict[int, Wrench] = {}
    for payload in case.payloads:
        link = case.placed[payload.link]
        f, n = in_base_axes(payload, link)
        f_sum, n_sum = total.get(payload.link, (ZERO, ZERO))
        total[payload.link] = f_sum + f, n_sum + n + link.p.cross(f)
    return total


def _balances(case: Case) -> list[Wrench]:
    """What crosses the joint of each link, less what its children and its payload take and its momentum needs."""
    across, given = _across(case), _given(case)
    left = [list(wrench) for wrench in across]
    for i, joint in enumerate(case.model.joints):
        if joint.parent >= 0:
            left[joint.parent] = [x - y for x, y in zip(left[joint.parent], across[i], strict=True)]
    for i, change in enumerate(_changes(case)):
        for taken in (change, given.get(i, (ZERO, ZERO))):
            left[i] = [x - y for x, y in zip(left[i], taken, strict=True)]
    return [(f, n) for f, n in left]


def _base(case: Case) -> Wrench:
    """What the base exerts on the robot, less all that takes it."""
    roots = [wrench for joint, wrench in zip(case.model.joints, _across(case), strict=True) if joint.parent < 0]
    taken = [*_changes(case), *_given(case).values()]
    f, n = (reduce(Vector.__add__, (wrench[k] for wrench in roots), ZERO) for k in (0, 1))
    for change in taken:
        f, n = f - change[0], n - change[1]
    return f, n
