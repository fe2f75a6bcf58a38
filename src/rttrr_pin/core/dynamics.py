"""The dynamics of a robot: the reference recursion, mimic joints, and armature and friction of the joints.

Like the recursion this is written once, over scalars of any kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice
from math import copysign

import numpy as np

from rttrr_pin.core.algebra import Matrix, Scalar, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint, JointEffects, Lock, Mimic
from rttrr_pin.core.joints import FIXED
from rttrr_pin.core.joints.base import Body, JointState
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.newton_euler import Payload, newton_euler
from rttrr_pin.core.payload import Load, payloads_of
from rttrr_pin.core.scalars import AXIS_ERROR, FLOAT, ROTATION_ERROR, UNIT_ROUNDOFF, Arithmetic, columns
from rttrr_pin.core.wrench import QUANTITIES


def bodies(model: Model, arithmetic: Arithmetic) -> list[Body]:
    """The links and joints of a model with their numbers as scalars."""
    if not any(joint.lock for joint in model.joints):  # so that arithmetics that differ in sines alone share bodies
        arithmetic = replace(FLOAT, number=arithmetic.number)
    return _bodies(model, arithmetic)


@lru_cache(maxsize=32)
def _bodies(model: Model, arithmetic: Arithmetic) -> list[Body]:
    """Models and bodies are frozen, so the last few are kept."""
    return [body_of(*pair, arithmetic) for pair in zip(model.joints, model.links, strict=True)]


@dataclass(frozen=True, slots=True)
class Result:
    """The result of inverse dynamics, in scalars of one kind.

    Attributes:
        tau: driving force of each degree of freedom: what crosses the joint along it, plus `tau_joint`.
        tau_joint: the part that the joint itself takes (armature, friction).
        F, N, f, n: of each link, in {i}.
    """

    tau: list[Scalar]
    tau_joint: list[Scalar]
    F: list[Vector]
    N: list[Vector]
    f: list[Vector]
    n: list[Vector]

    def scalars(self, quantities: Sequence[str] = QUANTITIES) -> list[Scalar]:
        """The numbers of the quantities in one list: tau by rate; F, N, f, n link by link."""
        values = (getattr(self, key) for key in quantities)
        return [x for value in values for item in value for x in (item if isinstance(item, Vector) else (item,))]


def evaluate(model: Model, arithmetic: Arithmetic, q: Array, v: Array, a: Array, loads: Sequence[Load] = ()) -> Result:
    """Inverse dynamics of a batch.

    q is (N, nq), v and a (N, nv); one state, (1, nq), is computed with Python floats. See `dynamics`.
    """
    q_, v_, a_ = ([arithmetic.column(column) for column in columns(x)] for x in (q, v, a))
    return dynamics(model, arithmetic, q_, v_, a_, payloads_of(loads, arithmetic))


def dynamics(
    model: Model,
    arithmetic: Arithmetic,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    payloads: Sequence[Payload] = (),
    links: Sequence[Body] | None = None,
    gravity: Vector | None = None,
) -> Result:
    """Inverse dynamics on scalars.

    Args:
        model: the robot.
        arithmetic: the kind of scalar.
        q: a scalar for each coordinate.
        v: a scalar for each rate.
        a: a scalar for each acceleration.
        payloads: what the robot exerts on its surroundings.
        links: bodies, if not the model's own.
        gravity: the gravity field [m/s^2], if not the model's own.

    Returns:
        The five quantities in scalars of that kind; one that no state changes may be a plain number.
    """
    states = joint_states(model, arithmetic, q, v, a)
    if gravity is None:
        gravity = Vector.of(model.gravity, lambda value: arithmetic.number(value, 0.0))
    parents = [joint.parent for joint in model.joints]
    sincos, keep, call = arithmetic.sincos, arithmetic.keep, arithmetic.call
    result = newton_euler(links or bodies(model, arithmetic), parents, states, gravity, payloads, sincos, keep, call)
    own = [
        call(joint_effects, joint.effects, state, arithmetic) for joint, state in zip(model.joints, states, strict=True)
    ]
    transmitted, tau_joint = (generalised_forces(model, arithmetic, forces) for forces in (result.tau, own))
    tau = [x + y for x, y in zip(transmitted, tau_joint, strict=True)]
    return Result(tau, tau_joint, result.F, result.N, result.f, result.n)


def joint_states(
    model: Model, arithmetic: Arithmetic, q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar]
) -> list[JointState]:
    """q, v, a of each joint; those of a mimic joint are computed from the joint that it follows."""
    q_, v_, a_ = iter(q), iter(v), iter(a)
    own: dict[int, JointState] = {}
    for i in model.independent:
        nq, nv = model.joints[i].nq, model.joints[i].nv
        own[i] = JointState(list(islice(q_, nq)), list(islice(v_, nv)), list(islice(a_, nv)))
    at_rest = JointState((), (), ())
    return [
        own.get(i, at_rest) if joint.mimic is None else mimicked(joint.mimic, own[joint.mimic.joint], arithmetic)
        for i, joint in enumerate(model.joints)
    ]


def mimicked(mimic: Mimic, followed: JointState, arithmetic: Arithmetic) -> JointState:
    """The state of a mimic joint: multiplier q + offset, and its time derivatives."""
    rounded = UNIT_ROUNDOFF if mimic.rounded else 0.0
    multiplier, offset = (arithmetic.number(x, rounded * abs(x)) for x in (mimic.multiplier, mimic.offset))
    sign = arithmetic.number(copysign(mimic.multiplier != 0, mimic.multiplier), 0.0)
    (q,), (v,), (a,) = followed.q, followed.v, followed.a
    return JointState([q * multiplier + offset], [v * multiplier], [a * multiplier], [v * sign])


def joint_effects(effects: JointEffects, state: JointState, arithmetic: Arithmetic) -> list[Scalar]:
    """The force armature a + damping v + friction sign(v) of each degree of freedom; 0 where the joint has none."""
    forces = []
    for v, a, signed in zip(state.v, state.a, state.signs_of or state.v, strict=True):
        force: Scalar = 0
        if effects.armature:
            force = a * arithmetic.number(effects.armature, 0.0) + force
        if effects.damping:
            force = v * arithmetic.number(effects.damping, 0.0) + force
        if effects.friction:
            force = arithmetic.sign(signed) * arithmetic.number(effects.friction, 0.0) + force
        forces.append(force)
    return forces


def generalised_forces(model: Model, arithmetic: Arithmetic, forces: Sequence[Sequence[Scalar]]) -> list[Scalar]:
    """Forces of all joints, mimic joints included, as forces along the degrees of freedom of the robot.

    By virtual work a joint that follows another with multiplier m adds m times its force to that of the other.
    """
    total = {i: list(forces[i]) for i in model.independent}
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None:
            rounded = UNIT_ROUNDOFF if joint.mimic.rounded else 0.0
            multiplier = arithmetic.number(joint.mimic.multiplier, rounded * abs(joint.mimic.multiplier))
            total[joint.mimic.joint][0] = total[joint.mimic.joint][0] + forces[i][0] * multiplier
    return [force for i in model.independent for force in total[i]]


def body_of(joint: Joint, link: Link, arithmetic: Arithmetic) -> Body:
    """One link with its joint, in scalars of one kind."""
    if joint.lock is not None:
        return locked_body(body_of(joint.lock.joint, link, arithmetic), joint.lock, arithmetic)
    number = arithmetic.number
    # Rotation matrices from rpy, axes divided by their length and turned tensors are rounded; the rest is as written.
    turned = ROTATION_ERROR if joint.rotated else 0.0
    normalised = AXIS_ERROR if np.count_nonzero(joint.axis) > 1 else 0.0
    turned_tensor = 8 * ROTATION_ERROR * float(np.linalg.norm(link.inertia)) if link.rotated else 0.0
    return Body(
        type=joint.type,
        axis=Vector.of(joint.axis, lambda value: number(value, normalised * abs(value))),
        R=Matrix.of(joint.R, lambda value: number(value, turned)),
        p=Vector.of(joint.p, lambda value: number(value, 0.0)),
        M=number(link.mass, 0.0),
        r_C=Vector.of(link.com, lambda value: number(value, 0.0)),
        I=Matrix.of(link.inertia, lambda value: number(value, turned_tensor)),
        parameters=tuple(number(x, 0.0) for x in joint.type.parameters),
    )


def locked_body(body: Body, lock: Lock, arithmetic: Arithmetic) -> Body:
    """The link where its joint is locked: on a fixed joint, at the place that the joint's motion gives at rest."""
    q: Sequence[Scalar] = [arithmetic.number(x, 0.0) for x in lock.q]
    if lock.joint.mimic is not None:
        q = mimicked(lock.joint.mimic, JointState(q, [0], [0]), arithmetic).q
    at_rest = [0] * body.type.nv
    motion = body.type.motion(body, JointState(q, at_rest, at_rest), arithmetic.sincos)
    return replace(body, type=FIXED, R=motion.R, p=motion.p, parameters=())
