"""Where each of our joints has its numbers in a library's arrays, and in our own.

Libraries let every joint move by itself: those that follow another are driven along, and their forces are summed up by
virtual work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import generalised_forces, joint_effects, mimicked
from rttrr_pin.core.joint import JointEffects, Mimic
from rttrr_pin.core.joints import JointType
from rttrr_pin.core.joints.base import JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT


@dataclass(frozen=True, slots=True)
class LibraryJoint:
    """A moving joint of ours, where a library has it.

    Attributes:
        type: how it moves.
        q: where its coordinates are in the library's q.
        v: where its rates are in the library's v, a, tau.
        own_q: where its coordinates are in our q; of a follower those of the joint it follows.
        own_v: where its rates are in our v, a, tau; likewise.
        mimic: whom it follows.
        effects: what it adds to its driving force.
    """

    type: JointType
    q: slice
    v: slice
    own_q: slice
    own_v: slice
    mimic: Mimic | None
    effects: JointEffects

    def own(self, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
        """Its coordinates, rates and accelerations from ours, (N, nq) and (N, nv): a follower's from its leader's."""
        q, v, a = q[:, self.own_q], v[:, self.own_v], a[:, self.own_v]
        if self.mimic is not None:
            state: Any = mimicked(self.mimic, JointState([q], [v], [a]), FLOAT)
            (q,), (v,), (a,) = state.q, state.v, state.a
        return q, v, a


def own_slices(model: Model) -> list[tuple[slice, slice]]:
    """For each joint, where its coordinates and its rates are in ours; those of a follower are its leader's."""
    found: dict[int, tuple[slice, slice]] = {}
    at_q = at_v = 0
    for i in model.independent:
        joint = model.joints[i]
        found[i] = slice(at_q, at_q + joint.nq), slice(at_v, at_v + joint.nv)
        at_q, at_v = at_q + joint.nq, at_v + joint.nv
    none = slice(0, 0), slice(0, 0)
    return [found.get(joint.mimic.joint if joint.mimic else i, none) for i, joint in enumerate(model.joints)]


def effects_force(effects: JointEffects, v: Array, a: Array) -> Array:
    """The force that a joint takes itself at rates and accelerations, (N, nv) each."""
    force: Any
    (force,) = joint_effects(effects, JointState((), [v], [a]), FLOAT)
    out: Array = np.zeros_like(v) + force
    return out


def reduce_forces(model: Model, joints: Sequence[LibraryJoint], forces: Array) -> Array:
    """Forces of a library's joints, (N, its nv), as forces along the degrees of freedom of the robot, (N, nv)."""
    columns = iter([*forces[:, joint.v].T] for joint in joints)
    by_joint: list[Any] = [next(columns) if joint.nv else [] for joint in model.joints]
    out = np.empty((len(forces), model.nv))
    for k, force in enumerate(generalised_forces(model, FLOAT, by_joint)):
        out[:, k] = np.asarray(force)
    return out
