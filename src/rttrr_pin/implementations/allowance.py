"""How far rounding can take a result from the true one.

Three rules, from most to least that is known of a program:

- A program whose own operations are bounded (`recursion`, `kernel`, `lagrange`) has that bound.
- A library whose formulas are known adds up the recursion's terms in another order and in other axes. It gets the
  recursion's bound for the whole vector x that a quantity belongs to, since in other axes an error of one component is
  an error of all; 4 eps |x| for what is rounded on its way into the library; and its own terms that cancel.
- A program of which nothing is known gets the sizes of all terms that add up to the quantity, in any formulation: in
  absolute values, outwards for velocities and accelerations, inwards for forces and moments, with some eps at each
  level of the tree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import IDENTITY, ZERO, Vector
from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.dynamics import bodies, generalised_forces, joint_effects, joint_states
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import EPS, FLOAT, UNDERFLOW
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES, LinkWrenches
from rttrr_pin.implementations.library import norms
from rttrr_pin.implementations.protocol import Batch

HANDOVER = 4 * EPS
"""Relative: payloads, placements and angles are rounded on their way into another program's conventions."""

OPERATIONS = 8
"""Roundings of each term at each level of the tree: a change of frame, a vector product, sums."""

PARAMETERS = 4
"""What it takes beside that, where the numbers of the robot are rounded to single precision too: a rotation, a position
or an axis at each level, and mass, centre and tensor of the link that the term is of."""


@dataclass(frozen=True, slots=True)
class Precision:
    """The numbers that a program computes in.

    Attributes:
        name: of the type.
        eps: the distance from 1 to the next number.
        underflow: absolute, in any unit: what products lose that fall below the normal numbers.
        operations: roundings of each term at each level of the tree, in eps.
    """

    name: str
    eps: float
    underflow: float
    operations: int = OPERATIONS + PARAMETERS

    @classmethod
    def of(cls, type: np.dtype[Any]) -> Precision:
        """That of a floating-point type that is shorter than float64."""
        numbers = np.finfo(type)
        return cls(type.name, float(numbers.eps), float(numbers.smallest_normal) * LOST)


LOST = 2.0**40
"""How many products of a robot's recursion may fall below the normal numbers, times what multiplies them afterwards."""

DOUBLE = Precision("float64", EPS, UNDERFLOW, OPERATIONS)
"""Whose numbers are those of the model."""

SINGLE = Precision.of(np.dtype(np.float32))
"""Whose numbers are those of the model rounded."""

SIZES = replace(FLOAT, number=lambda value, error: abs(value))
"""Floats, of which numbers of the model count in absolute value."""

Carrier = tuple[float, str, int]
"""Weight, quantity (f or n) and link of a vector that a driving force is a component of."""


def carriers(model: Model) -> list[list[Carrier]]:
    """For each degree of freedom the vectors that its driving force is made of: its own, and those of followers."""
    own = [_carried(i, body) for i, body in enumerate(bodies(model, FLOAT))]
    parts = {i: own[i] for i in model.independent}
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None:
            multiplier = abs(joint.mimic.multiplier)
            parts[joint.mimic.joint][0] += [(multiplier * weight, key, link) for weight, key, link in own[i][0]]
    return [freedom for i in model.independent for freedom in parts[i]]


def _carried(i: int, body: Body) -> list[list[Carrier]]:
    """For each rate of a joint how much of f and of n of its link is in the driving force, at most."""
    units = [Vector(*row) for row in np.eye(3).tolist()]
    along = {"f": [body.type.driving_force(body, unit, ZERO) for unit in units]}
    along["n"] = [body.type.driving_force(body, ZERO, unit) for unit in units]
    weights = {key: norm(np.array(x, dtype=float).T) for key, x in along.items()}
    return [[(float(weights[key][k]), key, i) for key in weights if weights[key][k]] for k in range(body.type.nv)]


def of_bounds(bounds: LinkWrenches) -> dict[str, Array]:
    """The allowance of a program whose every number has a bound."""
    return {"tau": np.abs(bounds.tau)} | {key: norm(getattr(bounds, key)) for key in LINK_QUANTITIES}


def of_library(
    batch: Batch, values: Mapping[str, Array], own: Array, cancelling: Mapping[str, Array]
) -> dict[str, Array]:
    """The allowance of a library: the recursion's bound of the whole vector, handing over, and terms that cancel.

    Args:
        batch: the states.
        values: what the library gave: tau, F, N, f, n.
        own: tau_joint, (N, nv).
        cancelling: by quantity (F, N, f, n), (N, links): the rounding of terms that only the library's formulas have.
    """
    wide = {
        key: norm(getattr(batch.bounds, key)) + np.abs(cancelling[key]) + HANDOVER * np.where(np.isfinite(x), x, 0.0)
        for key, x in ((key, norm(values[key])) for key in LINK_QUANTITIES)
    }
    return {"tau": _of_carriers(batch.model, wide) + HANDOVER * np.abs(own)} | wide


def of_other_numbers(batch: Batch, built: Model) -> dict[str, Array]:
    """How far the true values are from those of a model with other numbers: what the recursion makes of the two.

    Rounding of both is counted, so that this holds for the true values, and to any order in the difference.
    """
    sides = (batch.recursion, replace(batch, model=built).recursion)
    apart = {}
    for key in QUANTITIES:
        (x, x_bound), (y, y_bound) = ((getattr(values, key), getattr(bounds, key)) for values, bounds in sides)
        apart[key] = np.abs(x - y) + x_bound + y_bound
    return {key: x if key == "tau" else norm(x) for key, x in apart.items()}


def default_allowance(batch: Batch, precision: Precision = DOUBLE) -> dict[str, Array]:
    """The allowance of a program of which nothing is known: eps for all terms, at each level of the tree.

    In single precision the same terms are rounded, 2^29 times as much. To them come the numbers of the robot, which are
    rounded before anything is computed: that changes each term relatively, as one more operation on it would, and is
    `PARAMETERS` of them. Coordinates, rates, accelerations and payloads are taken as they are: where single precision
    does not hold them, their rounding is the caller's.
    """
    model = batch.model
    depth = levels([joint.parent for joint in model.joints]).max(initial=0.0)
    each = precision.operations * precision.eps * (1 + depth)
    wide = {key: each * size + precision.underflow for key, size in sizes(batch).items()}
    own = precision.operations * precision.eps * _sizes_of_tau_joint(batch)
    return {"tau": _of_carriers(model, wide) + own} | wide


def _sizes_of_tau_joint(batch: Batch) -> Array:
    """What armature, damping and friction add up to where none is against another, (N, nv)."""
    model = batch.model
    states = joint_states(model, SIZES, *(list(np.abs(x).T) for x in (batch.q, batch.v, batch.a)))
    own = [joint_effects(joint.effects, state, SIZES) for joint, state in zip(model.joints, states, strict=True)]
    forces: list[Any] = generalised_forces(model, SIZES, own)
    columns = [np.broadcast_to(x, len(batch)) for x in forces]
    return np.stack(columns, axis=1) if columns else np.zeros((len(batch), 0))


def of_printed(batch: Batch, halves: Mapping[str, Array]) -> dict[str, Array]:
    """The default allowance, and half a unit in the last place of each number that was printed."""
    default = default_allowance(batch)
    return {key: default[key] + (half if key == "tau" else norm(half)) for key, half in halves.items()}


def sizes(batch: Batch) -> dict[str, Array]:
    """F, N, f, n as the sum of the absolute values of all terms, linear velocities included, (N, links) each.

    With sizes w, v, w_dot, a of a link's velocities and accelerations, and reach the distance between two origins:

        F = m (a + c (w_dot + w^2)),   N = |I| (w_dot + w^2)
        f = F + sum f_child,           n = N + c F + m v^2 + sum (n_child + reach f_child)
    """
    model, rows = batch.model, len(batch)
    shape = (rows, len(model.links))
    w, v, w_dot, a, reach = (np.zeros(shape) for _ in range(5))
    gravity = np.full(rows, norm(model.gravity))
    still = np.zeros(rows)
    states = joint_states(model, SIZES, *(list(np.abs(x).T) for x in (batch.q, batch.v, batch.a)))
    for i, (joint, body, state) in enumerate(zip(model.joints, bodies(model, SIZES), states, strict=True)):
        p = joint.parent
        own = joint.type.motion(replace(body, R=IDENTITY, p=ZERO), state, SIZES.sincos)
        moved, turn, turn_dot, slide, slide_dot = (
            _length(x, rows) for x in (own.p, own.w, own.w_dot, own.v, own.v_dot)
        )
        reach[:, i] = norm(joint.p) + moved
        w_p, v_p, w_dot_p, a_p = (
            x[:, p] if p >= 0 else start
            for x, start in zip((w, v, w_dot, a), (still, still, still, gravity), strict=True)
        )
        w[:, i] = w_p + turn
        v[:, i] = v_p + reach[:, i] * w_p + slide
        w_dot[:, i] = w_dot_p + w_p * turn + turn_dot
        a[:, i] = a_p + reach[:, i] * (w_dot_p + w_p**2) + 2 * (w_p + turn) * slide + slide_dot + w[:, i] * v[:, i]
    turning = w_dot + w**2
    mass, lever = norms(link.mass for link in model.links), norms(link.com for link in model.links)
    tensor = norms(link.inertia for link in model.links)
    F = mass * (a + lever * turning)
    N = tensor * turning + mass * lever * (a + lever * turning)
    f, n = F.copy(), N + mass * v**2
    for load in batch.loads:
        f[:, load.link] += norm(np.atleast_2d(load.f))
        n[:, load.link] += norm(np.atleast_2d(load.n))
    add_inwards([joint.parent for joint in model.joints], f.T, n.T, reach.T)
    return {"F": F, "N": N, "f": f, "n": n}


def _length(vector: Vector, rows: int) -> Array:
    """The norm of a vector of columns, or of numbers that are the same in each state, (N,)."""
    components: list[Any] = [*vector]
    return norm(np.stack([np.broadcast_to(np.abs(x), rows) for x in components], axis=-1))


def add_inwards(parents: Sequence[int], f: Any, n: Any, reach: Any) -> None:
    """Add the sizes of forces and moments on each body to those on its parent, in place: scalars by body.

    The parent is -1 where there is none. `reach` is at most how far a body's origin is from its parent's [m]; zero
    where all moments are about one point.
    """
    for i, p in reversed(list(enumerate(parents))):
        if p >= 0:
            f[p] = f[p] + f[i]
            n[p] = n[p] + (n[i] + reach[i] * f[i])


def sum_inwards(parents: Sequence[int], terms: Array) -> None:
    """Add what is of each body to what is of its parent (-1 where there is none), in place, (N, bodies, ...)."""
    for i, p in reversed(list(enumerate(parents))):
        if p >= 0:
            terms[:, p] += terms[:, i]


def levels(parents: Sequence[int]) -> Array:
    """How many bodies there are from each one inward, itself included."""
    counts = np.zeros(len(parents))
    for i, p in enumerate(parents):
        counts[i] = 1 + (counts[p] if p >= 0 else 0)
    return counts


def of_carriers(model: Model, wide: Mapping[str, Any]) -> list[Any]:
    """What the vectors that driving forces are components of are allowed, a scalar for each degree of freedom."""
    return [sum((wide[key][link] * weight for weight, key, link in parts), 0.0) for parts in carriers(model)]


def _of_carriers(model: Model, wide: Mapping[str, Array]) -> Array:
    """The same of a batch, (N, nv)."""
    columns = of_carriers(model, {key: x.T for key, x in wide.items()})
    rows = len(wide["f"])
    return np.stack([np.broadcast_to(x, rows) for x in columns], axis=1) if columns else np.zeros((rows, 0))
