"""Lagrange's equations: the driving forces from derivatives of T and V, by dual numbers.

For rate j, with p_j = dT/dv_j the momentum that belongs to it and d_j the derivative by the configuration in the
direction in which rate j takes it (the rates held):

    tau_j = d/dt p_j - d_j (T - V) + turning_j + d(P_payload + P_drives)/dv_j

Of a joint whose rates are derivatives of its coordinates, `turning` is zero and this is Lagrange's equation. A planar
or floating joint has a twist (v, w) in {i} as its rates, which are no derivatives of coordinates (quasi-velocities);
there the Boltzmann-Hamel equations apply, for twists those of Kirchhoff:

    turning = w x P for the force,   w x L + v x P for the moment

Payload and drives enter by virtual power: the derivative, by rate j, of the power of the forces that they are. A joint
that follows another has the followed joint's rate times its multiplier, which the derivatives see.

Source: Greenwood, "Advanced Dynamics", 2003, sections 2.2 and 4.1 (Boltzmann-Hamel); Lamb, "Hydrodynamics", article
124.

It shares nothing with the recursion but the motion of single joints (`JointType.motion`): no acceleration of a link, no
force on one. So it gives tau alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.core.dual import Dual, part_of, value_of
from rttrr_pin.core.dynamics import bodies, joint_states
from rttrr_pin.core.energy import (
    gyroscopic,
    joint_effects_power,
    kinetic_energy,
    moving_links,
    payload_power,
    potential_energy,
)
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import payloads_of
from rttrr_pin.core.scalars import Arithmetic, columns
from rttrr_pin.core.tangent import TIME, in_time, over_duals, tangent
from rttrr_pin.exact.rounding import BOUNDED, Bounded, coordinate_scalars, values_and_bounds
from rttrr_pin.implementations.protocol import Batch, Evaluation
from rttrr_pin.version import __version__

if TYPE_CHECKING:
    from rttrr_pin.core.newton_euler import Payload


class Lagrange:
    """Lagrange's equations on our own model, run on (value, bound) scalars: its rounding comes with it."""

    name = "lagrange"
    version: str = __version__
    quantities: tuple[str, ...] = ("tau",)

    def __init__(self, model: Model) -> None:
        self.model = model

    def evaluate(self, batch: Batch) -> Evaluation:
        """The driving forces of a batch, and a bound on their rounding."""
        v, a = ([Bounded(column, 0.0) for column in columns(x)] for x in (batch.v, batch.a))
        payloads = payloads_of(batch.loads, BOUNDED)
        q = coordinate_scalars(self.model, batch.q)
        tau, tau_joint = (values_and_bounds(x, len(batch)) for x in lagrange(self.model, BOUNDED, q, v, a, payloads))
        return Evaluation({"tau": tau[0]}, {"tau": tau[1]}, tau_joint[0])


def lagrange(
    model: Model,
    arithmetic: Arithmetic,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    payloads: Sequence[Payload] = (),
) -> tuple[list[Scalar], list[Scalar]]:
    """The driving forces in scalars of any kind, and the part of them that the joints take themselves.

    Args:
        model: the robot.
        arithmetic: the kind of scalar.
        q: a scalar for each coordinate.
        v: a scalar for each rate.
        a: a scalar for each acceleration.
        payloads: what the robot exerts on its surroundings.
    """
    links = bodies(model, arithmetic)
    n = range(model.nv)
    inner = over_duals(arithmetic)
    outer = over_duals(inner)
    q_t, v_t = in_time(model.moving, q, v, a, arithmetic)
    q_o = [Dual(x, {}) for x in q_t]  # what moves in time, and along each rate
    v_o = [Dual(x, {j: 1}) for j, x in enumerate(v_t)]
    moving = moving_links(model, links, q_o, v_o, outer)
    T = kinetic_energy(links, moving)
    p = [part_of(T, j) for j in n]
    p_dot = [part_of(x, TIME) for x in p]
    gravity = Vector.of(model.gravity, lambda value: arithmetic.number(value, 0.0))
    at_rates = moving_links(model, links, tangent(model.moving, q, arithmetic), v, inner)
    lagrangian = kinetic_energy(links, at_rates) - potential_energy(links, at_rates, gravity)
    slope = [part_of(lagrangian, j) for j in n]  # d_j (T - V)
    turning = gyroscopic(model, v, [value_of(x) for x in p])
    states = joint_states(model, arithmetic, q, v, a)
    effects = joint_effects_power(model, arithmetic, states, joint_states(model, outer, q_o, v_o, a))
    surroundings = payload_power(payloads, moving)
    tau_joint = [value_of(part_of(effects, j)) for j in n]
    payload = [value_of(part_of(surroundings, j)) for j in n]
    tau = [p_dot[j] - slope[j] + turning[j] + payload[j] + tau_joint[j] for j in n]
    return tau, tau_joint
