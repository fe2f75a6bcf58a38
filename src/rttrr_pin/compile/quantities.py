"""What a program can compute: the five quantities of the recursion, and what else follows from the same recursion.

Each is a line in the table `QUANTITIES`: what it needs, its shape, and how its scalars come from the recursion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.core.dual import Dual, part_of
from rttrr_pin.core.dynamics import Result, bodies, dynamics, generalised_forces, joint_effects, joint_states
from rttrr_pin.core.inertia import SpatialInertia
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.core.tangent import over_duals, tangent

if TYPE_CHECKING:
    from rttrr_pin.core.energy import LinkState


@dataclass(frozen=True)
class Motion:
    """A robot in motion, in scalars of one kind; what a quantity does not need is empty.

    Attributes:
        model: the robot.
        arithmetic: the kind of scalar.
        q, v, a: coordinates, rates, accelerations.
        payloads: what the robot exerts on its surroundings.
        links: to take instead of the model's own; None for those.
    """

    model: Model
    arithmetic: Arithmetic
    q: Sequence[Scalar]
    v: Sequence[Scalar] = ()
    a: Sequence[Scalar] = ()
    payloads: Sequence[Payload] = ()
    links: Sequence[Body] | None = None

    @cached_property
    def result(self) -> Result:
        """The five quantities."""
        return dynamics(self.model, self.arithmetic, self.q, self.v, self.a, self.payloads, self.links)


@dataclass(frozen=True, slots=True)
class Quantity:
    """What can be asked of a kernel.

    Attributes:
        inputs: which of q, v, a it depends on.
        shape: of what belongs to one state.
        scalars: its numbers, the last axis fastest.
        payload: whether a payload enters.
        of_links: whether single links matter, so that no mass may be moved from one to another.
        by_steps: whether it comes from scalars of one kind, so that the recursion's steps can be compiled once each.
    """

    inputs: str
    shape: Callable[[Model], tuple[int, ...]]
    scalars: Callable[[Motion], Sequence[Scalar]]
    payload: bool = False
    of_links: bool = False
    by_steps: bool = True


def _of_links(name: str) -> Quantity:
    return Quantity(
        "qva", lambda model: (len(model.links), 3), lambda motion: motion.result.scalars((name,)), True, of_links=True
    )


def _force_at(motion: Motion, v: Sequence[Scalar], a: Sequence[Scalar], gravity: bool = True) -> list[Scalar]:
    """The driving forces at other rates and accelerations."""
    model = motion.model if gravity else motion.model.with_gravity(np.zeros(3))
    return dynamics(model, motion.arithmetic, motion.q, v, a, links=motion.links).tau


def _mass_matrix(motion: Motion) -> list[Scalar]:
    """M(q): column j is what an acceleration of 1 in coordinate j alone takes, without gravity and rates."""
    n = motion.model.nv
    rest = [0.0] * n
    columns = [_force_at(motion, rest, [float(i == j) for i in range(n)], gravity=False) for j in range(n)]
    return [columns[max(i, j)][min(i, j)] for i in range(n) for j in range(n)]  # symmetric to the last bit


def _regressor(motion: Motion) -> list[Scalar]:
    """Y(q, v, a) with tau - tau_joint = Y pi: the derivative of the recursion by the parameters of each link.

    At a point mass of 1 kg in the origin of {i} the derivatives by mass, r_C and tensor about the centre of mass are
    those by mass, first moment and tensor about the origin; as tau is linear in them, they hold everywhere.
    """
    still = motion.model.without_joint_effects()
    links = [_with_parameters(body, 10 * i) for i, body in enumerate(bodies(still, motion.arithmetic))]
    tau = dynamics(still, motion.arithmetic, motion.q, motion.v, motion.a, links=links).tau
    return [part_of(row, k) for row in tau for k in range(10 * len(links))]


EFFECTS = tuple(JointEffects(**{effect.name: 1.0}) for effect in fields(JointEffects))
"""Armature, damping and friction of 1, one at a time."""


def _joint_regressor(motion: Motion) -> list[Scalar]:
    """Y(q, v, a) with tau_joint = Y pi: the force of each effect of 1 in each joint that moves, followers too."""
    model, arithmetic = motion.model, motion.arithmetic
    states = joint_states(model, arithmetic, motion.q, motion.v, motion.a)
    at_rest: list[Sequence[Scalar]] = [[0.0] * joint.nv for joint in model.joints]
    columns = [
        generalised_forces(model, arithmetic, [*at_rest[:i], joint_effects(own, state, arithmetic), *at_rest[i + 1 :]])
        for i, state in enumerate(states)
        if model.joints[i].nv
        for own in EFFECTS
    ]
    return [column[row] for row in range(model.nv) for column in columns]


def _link_states(motion: Motion) -> list[LinkState]:
    """Placement and velocity of each link, as duals along the rates."""
    from rttrr_pin.core.energy import moving_links

    arithmetic, rates = over_duals(motion.arithmetic), [Dual(0.0, {k: 1.0}) for k in range(motion.model.nv)]
    links = motion.links or bodies(motion.model, motion.arithmetic)
    return moving_links(motion.model, links, motion.q, rates, arithmetic)


def _link_jacobians(motion: Motion) -> list[Scalar]:
    """Of each link, in {i}, v of the origin and w by the rates; both are linear in them."""
    states, directions = _link_states(motion), range(motion.model.nv)
    return [part_of(row, k) for link in states for row in (*link.v, *link.w) for k in directions]


def _link_placements(motion: Motion) -> list[Scalar]:
    """R_0_i and behind it p_0_i, row by row."""
    states = _link_states(motion)
    return [x for link in states for row, p in zip(link.R.rows, link.p, strict=True) for x in (*row, p)]


def _with_parameters(body: Body, first: int) -> Body:
    """The body as a point mass at its origin, whose ten parameters are directions from `first` on."""
    own = SpatialInertia.of_parameters([Dual(0.0, {first + k: 1.0}) for k in range(10)])
    return replace(body, M=own.m + 1.0, r_C=own.h, I=own.J)


def _derivatives(by: str) -> Quantity:
    """D tau by the coordinates (tangent directions, as the rates), rates or accelerations."""

    def scalars(motion: Motion) -> list[Scalar]:
        n = motion.model.nv
        moved = {"q": motion.q, "v": motion.v, "a": motion.a}
        if by == "q":
            moved[by] = tangent(motion.model.moving, motion.q, motion.arithmetic)
        else:
            moved[by] = [Dual(value, {k: 1.0}) for k, value in enumerate(moved[by])]
        arithmetic = over_duals(motion.arithmetic)
        q, v, a = moved.values()
        tau = dynamics(motion.model, arithmetic, q, v, a, motion.payloads, motion.links).tau
        return [part_of(row, k) for row in tau for k in range(n)]

    return Quantity("qva", lambda model: (model.nv, model.nv), scalars, payload=True, by_steps=False)


def _per_joint(model: Model) -> tuple[int, ...]:
    return (model.nv,)


QUANTITIES: dict[str, Quantity] = {
    "tau": Quantity("qva", _per_joint, lambda motion: motion.result.tau, payload=True),
    "F": _of_links("F"),
    "N": _of_links("N"),
    "f": _of_links("f"),
    "n": _of_links("n"),
    "tau_joint": Quantity("qva", _per_joint, lambda motion: motion.result.tau_joint, payload=True),
    "mass_matrix": Quantity("q", lambda model: (model.nv, model.nv), _mass_matrix),
    "nonlinear_effects": Quantity(
        "qv", _per_joint, lambda motion: _force_at(motion, motion.v, [0.0] * motion.model.nv)
    ),
    "gravity_torque": Quantity(
        "q", _per_joint, lambda motion: _force_at(motion, (0.0,) * motion.model.nv, (0.0,) * motion.model.nv)
    ),
    "regressor": Quantity(
        "qva", lambda model: (model.nv, 10 * len(model.links)), _regressor, of_links=True, by_steps=False
    ),
    "joint_regressor": Quantity(
        "qva",
        lambda model: (model.nv, 3 * sum(joint.nv > 0 for joint in model.joints)),
        _joint_regressor,
        by_steps=False,
    ),
    "link_jacobians": Quantity(
        "q", lambda model: (len(model.links), 6, model.nv), _link_jacobians, of_links=True, by_steps=False
    ),
    "link_placements": Quantity(
        "q", lambda model: (len(model.links), 3, 4), _link_placements, of_links=True, by_steps=False
    ),
    "dtau_dq": _derivatives("q"),
    "dtau_dv": _derivatives("v"),
    "dtau_da": _derivatives("a"),
}
"""By name; `robot.compile(outputs=...)` takes any of them."""

STRAIGHT_LINE = 20_000
"""Operations, as traced, beyond which a program is made of calls: straight lines would take seconds to compile."""

BOUND = "_bound"
"""What the name of a bound ends with, behind that of what it bounds."""


QUANTITIES |= {name + BOUND: replace(quantity, by_steps=False) for name, quantity in QUANTITIES.items()}
# `bounds.with_bounds` makes them from the operations of what they bound.
