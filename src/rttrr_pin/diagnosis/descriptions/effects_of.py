"""What differences of two descriptions do to the torques: each alone, all together, and what none explains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import joint_states
from rttrr_pin.core.joint import Mimic
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.diagnosis.descriptions.difference import Difference
from rttrr_pin.diagnosis.descriptions.rigid_tree import RigidTree
from rttrr_pin.diagnosis.engine.evidence import rms
from rttrr_pin.diagnosis.variants.variant import run
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.validation.sampling import Sampler

ROUNDING = 64.0
"""Times the running error bound of the recursion: numbers that were put into other frames are rounded, too."""

Motion = dict[str, tuple[Array, Array, Array]]
"""Coordinates (N, nq), rates and accelerations (N, nv) of each joint that moves, by its name, those that follow too."""


@dataclass(frozen=True, slots=True, eq=False)
class Torques:
    """Torques of joints that move by themselves in both descriptions.

    Attributes:
        labels: the degrees of freedom, as the first calls them.
        joints: their joints.
        motion: the states.
        tau: of the first robot, (N, degrees of freedom) [N m or N].
        bound: on what rounding does to them, (degrees of freedom,).
    """

    labels: tuple[str, ...]
    joints: tuple[str, ...]
    motion: Motion
    tau: Array
    bound: Array

    @property
    def rms(self) -> Array:
        """Of the first robot's torques, (degrees of freedom,)."""
        return rms(self.tau)

    def of(self, model: Model) -> Array:
        """Torques of a robot with the same joints."""
        return torques(model, self.motion, self.joints)


@dataclass(frozen=True, slots=True)
class Effect:
    """What one difference does to the torques of the first robot, all else as it is.

    Attributes:
        difference: what differs.
        rms: of the change of each joint's torque over the states, by joint [N m or N]; empty where none changes.
        largest: the largest change, likewise.
        share: the rms as a part of that of the joint's torque, likewise.
    """

    difference: Difference
    rms: Mapping[str, float]
    largest: Mapping[str, float]
    share: Mapping[str, float]

    @property
    def matters(self) -> bool:
        """Whether a torque changes."""
        return bool(self.rms)

    @property
    def joint(self) -> str | None:
        """The joint whose torque changes most, in terms of itself."""
        return max(self.share, key=self.share.__getitem__, default=None)

    @property
    def worst(self) -> float:
        """Its share."""
        return max(self.share.values(), default=0.0)

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        numbers = {"rms": dict(self.rms), "max": dict(self.largest), "share": dict(self.share)}
        return {**self.difference.to_dict(), "matters": self.matters, "most_on": self.joint, "tau": numbers}


def first_torques(a: RigidTree, b: RigidTree, n_states: int, seed: int) -> Torques:
    """Random states of the first robot, and its torques there; a joint that only the second leads follows as there."""
    model = a.model
    batch = Sampler(model, "uniform", seed).draw(0, n_states)
    motion = motion_of(model, batch.q, batch.v, batch.a)
    pairs = [(x.joint, y.joint) for x, y in zip(a.bodies, b.bodies, strict=True)]
    led = {x.name: _led(y.mimic, motion, a) for x, y in pairs if y.mimic and x.independent and x.nq == 1}
    if led:
        motion = motion_of(model, *_states(model, motion | led))
    both = tuple(x.name for x, y in pairs if x.independent and y.independent)
    labels = tuple(label for joint in model.moving if joint.name in both for label in joint.v_labels())
    return Torques(labels, both, motion, *torques_and_bound(model, motion, both, "first"))


def _led(mimic: Mimic, motion: Motion, a: RigidTree) -> tuple[Array, Array, Array]:
    """The motion of a joint that follows one of the first robot."""
    q, v, a_ = motion[a.bodies[mimic.joint].joint.name]
    return mimic.multiplier * q + mimic.offset, mimic.multiplier * v, mimic.multiplier * a_


def motion_of(model: Model, q: Array, v: Array, a: Array) -> Motion:
    """The states joint by joint."""
    states = joint_states(model, FLOAT, *([*x.T] for x in (q, v, a)))
    return {
        joint.name: (_stacked(own.q), _stacked(own.v), _stacked(own.a))
        for joint, own in zip(model.joints, states, strict=True)
        if joint.nv
    }


def _stacked(values: Sequence[Any]) -> Array:
    return np.stack([np.asarray(x, dtype=np.float64) for x in values], axis=-1)


def torques_and_bound(model: Model, motion: Motion, joints: Sequence[str], which: str) -> tuple[Array, Array]:
    """Torques of some joints, and at most how far rounding takes them, (degrees of freedom,).

    Raises:
        InputError: torques overflow, of the robot of that name in the message.
    """
    values, bounds = Batch(model, *_states(model, motion)).recursion
    tau, bound = (_of_joints(model, joints, own.tau) for own in (values, bounds))
    if not np.isfinite(tau).all():
        raise InputError(f"the torques of the {which} robot overflow: its numbers are larger than those of a robot")
    return tau, bound.max(axis=0, initial=0.0)


def _states(model: Model, motion: Motion) -> tuple[Array, Array, Array]:
    own = [motion[joint.name] for joint in model.moving]
    q, v, a = (np.hstack([parts[k] for parts in own]) for k in range(3))
    return q, v, a


def torques(model: Model, motion: Motion, joints: Sequence[str]) -> Array:
    """Torques of some joints of a robot, (N, degrees of freedom), by the reference recursion."""
    return _of_joints(model, joints, run(model, Batch(model, *_states(model, motion)))["tau"])


def _of_joints(model: Model, joints: Sequence[str], tau: Array) -> Array:
    """The columns of some joints, in the order of their names."""
    at, columns_of = 0, {}
    for joint in model.moving:
        columns_of[joint.name] = range(at, at + joint.nv)
        at += joint.nv
    return np.ascontiguousarray(tau[:, [k for name in joints for k in columns_of[name]]])


def effect_of(difference: Difference, a: RigidTree, torques: Torques) -> Effect:
    """The change of the torques by one difference."""
    told = replace(difference, change=None)
    if difference.change is None:
        return Effect(told, {}, {}, {})
    return effect(told, torques.of(difference.change(a).model) - torques.tau, torques)


def effect(difference: Difference, change: Array, torques: Torques) -> Effect:
    """A change of torques in numbers; none where rounding explains it."""
    size, most = rms(change), np.abs(change).max(axis=0, initial=0.0)
    if bool((most <= ROUNDING * torques.bound).all()):
        return Effect(difference, {}, {}, {})
    with np.errstate(all="ignore"):
        share = np.where(size <= ROUNDING * torques.bound, 0.0, size / torques.rms)
    return Effect(difference, *(dict(zip(torques.labels, x.tolist(), strict=True)) for x in (size, most, share)))


def all_together(a: RigidTree, found: Sequence[Difference]) -> Model:
    """The first robot with every number of the second."""
    for own in found:
        if own.change is not None:
            a = own.change(a)
    return a.model
