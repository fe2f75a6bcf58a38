"""A robot in motion, on which laws are checked; what several laws need is computed once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from rttrr_pin.core.algebra import ZERO, Scalar, Vector
from rttrr_pin.core.dual import Dual, part_of, value_of
from rttrr_pin.core.dynamics import Result, bodies, dynamics
from rttrr_pin.core.energy import LinkState, moving_links
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.payload import payloads_of
from rttrr_pin.core.scalars import Arithmetic, columns
from rttrr_pin.core.tangent import TIME, in_time, over_duals
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.exact.rounding import BOUNDED, Bounded, coordinate_scalars
from rttrr_pin.implementations import Batch, Implementation, default_allowance
from rttrr_pin.implementations.protocol import evaluated

Rows = list[list[Scalar]]


@dataclass(frozen=True)
class Case:
    """States of a robot in scalars of one kind.

    Attributes:
        model: the robot.
        arithmetic: the kind of scalar.
        q: a scalar for each coordinate.
        v: a scalar for each rate.
        a: a scalar for each acceleration.
        payloads: what the robot exerts on its surroundings.
        subject: the quantities that a program gave for these states, of which only those are read that it gives; None
            to check the reference recursion.
    """

    model: Model
    arithmetic: Arithmetic
    q: Sequence[Scalar]
    v: Sequence[Scalar]
    a: Sequence[Scalar]
    payloads: Sequence[Payload]
    subject: Result | None = None

    @classmethod
    def of(cls, batch: Batch, program: Implementation | None = None) -> Case:
        """States in scalars (value, error bound), with the results of a program and its allowance for them."""
        v, a = ([Bounded(column, 0.0) for column in columns(x)] for x in (batch.v, batch.a))
        q, payloads = coordinate_scalars(batch.model, batch.q), payloads_of(batch.loads, BOUNDED)
        return cls(batch.model, BOUNDED, q, v, a, payloads, None if program is None else _subject(batch, program))

    @property
    def at_rest(self) -> list[Scalar]:
        """Rates or accelerations of zero."""
        return [0] * self.model.nv

    @cached_property
    def links(self) -> list[Body]:
        """The links with their joints."""
        return bodies(self.model, self.arithmetic)

    @cached_property
    def gravity(self) -> Vector:
        """The field in base axes."""
        return self.vector(*self.model.gravity)

    def vector(self, *values: float) -> Vector:
        """Three exact numbers as scalars."""
        return Vector.of(values, lambda value: self.arithmetic.number(value, 0.0))

    @cached_property
    def result(self) -> Result:
        """The results that are checked: those of the subject, or the reference recursion's."""
        return self.forces() if self.subject is None else self.subject

    def forces(
        self,
        v: Sequence[Scalar] | None = None,
        a: Sequence[Scalar] | None = None,
        payloads: Sequence[Payload] | None = None,
        links: Sequence[Body] | None = None,
        gravity: Vector | None = None,
    ) -> Result:
        """The results of the reference recursion, with some of its inputs replaced."""
        v, a = self.v if v is None else v, self.a if a is None else a
        payloads = self.payloads if payloads is None else payloads
        return dynamics(self.model, self.arithmetic, self.q, v, a, payloads, links, gravity)

    @cached_property
    def duals(self) -> Arithmetic:
        """Duals over the scalars."""
        return over_duals(self.arithmetic)

    @cached_property
    def flow(self) -> tuple[list[Dual], list[Dual]]:
        """Coordinates and rates as they move in time, q' = v and v' = a."""
        return in_time(self.model.moving, self.q, self.v, self.a, self.arithmetic)

    @cached_property
    def moving(self) -> list[LinkState]:
        """Placements and velocities of the links as duals in time."""
        return moving_links(self.model, self.links, *self.flow, self.duals)

    @cached_property
    def placed(self) -> list[LinkState]:
        """Placements and velocities of the links at this instant."""
        return [x.now for x in self.moving]

    @cached_property
    def _unit_forces(self) -> Rows:
        """[j][i]: tau_i for an acceleration of 1 along rate j alone, without gravity and friction; duals in time."""
        model, n = self.model.without_joint_effects(), self.model.nv
        units = [[int(i == j) for i in range(n)] for j in range(n)]
        q_t = self.flow[0]
        return [dynamics(model, self.duals, q_t, self.at_rest, unit, (), self.links, ZERO).tau for unit in units]

    @cached_property
    def mass_matrix(self) -> Rows:
        """M by rows: column j is the force of the acceleration of 1 along rate j; without armature."""
        return [[value_of(column[i]) for column in self._unit_forces] for i in range(self.model.nv)]

    @cached_property
    def mass_matrix_rate(self) -> Rows:
        """The time derivative of M."""
        return [[part_of(column[i], TIME) for column in self._unit_forces] for i in range(self.model.nv)]

    @cached_property
    def kinetic_matrix(self) -> Rows:
        """M from the kinetic energy, d^2 T / dv_i dv_j = sum of M J_C^T J_C + J_w^T I J_w, without the recursion."""
        n = range(self.model.nv)
        v = [Dual(0, {j: 1}) for j in n]
        moving = moving_links(self.model, self.links, self.q, v, self.duals)
        rows: Rows = [[0] * self.model.nv for _ in n]
        for body, link in zip(self.links, moving, strict=True):
            v_C = link.velocity_of(body.r_C)
            linear, angular = ([Vector(*(part_of(x, j) for x in y)) for j in n] for y in (v_C, link.w))
            impulses = [(linear[j] * body.M, body.I @ angular[j]) for j in n]
            for i in n:
                for j, (P, L) in enumerate(impulses):
                    rows[i][j] = linear[i].dot(P) + angular[i].dot(L) + rows[i][j]
        return rows


def _subject(batch: Batch, program: Implementation) -> Result:
    """The results of a program; the bound on the norm of a vector bounds each of its components."""
    evaluation = evaluated(program, batch)
    values = evaluation.values
    allowance = default_allowance(batch) if evaluation.allowance is None else evaluation.allowance
    tau = map(Bounded, columns(values["tau"]), columns(allowance["tau"])) if "tau" in values else ()
    vectors: dict[str, list[Vector]] = {key: [] for key in LINK_QUANTITIES}
    for key in vectors.keys() & values.keys():
        for i, bound in enumerate(columns(allowance[key])):
            vectors[key].append(Vector(*(Bounded(x, bound) for x in columns(values[key][:, i]))))
    return Result(list(tau), [], **vectors)
