"""Where each of our joints has its numbers in an oracle's arrays, and in our own.

Oracles let every joint move by itself: those that follow another are driven along, and their forces are summed up by
virtual work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import JointEffects, Mimic
from rttrr_pin.core.joints import JointType
from rttrr_pin.core.model import Model


@dataclass(frozen=True, slots=True)
class LibraryJoint:
    """A moving joint of ours, where an oracle has it.

    Attributes:
        type: how it moves.
        q: where its coordinates are in the oracle's q.
        v: where its rates are in the oracle's v, a, tau.
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
        if self.mimic is None:
            return q, v, a
        m = self.mimic.multiplier
        return m * q + self.mimic.offset, m * v, m * a


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


def friction(effects: JointEffects, v: Array) -> Array:
    """Damping v + friction sign(v), as `JointEffects` has it."""
    return effects.damping * v + effects.friction * np.sign(v)


def reduce_forces(joints: Sequence[LibraryJoint], forces: Array) -> Array:
    """Forces of all joints as forces of those that follow no other: a follower adds its multiplier times its own."""
    nv = max((joint.own_v.stop for joint in joints), default=0)
    out = np.zeros((len(forces), nv))
    for joint in joints:
        weight = 1.0 if joint.mimic is None else joint.mimic.multiplier
        out[:, joint.own_v] += weight * forces[:, joint.v]
    return out
