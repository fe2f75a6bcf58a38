"""Our coordinates in Pinocchio's words, and its driving forces in ours.

| joint | our q | Pinocchio's q |
|---|---|---|
| continuous | angle | cosine, sine |
| planar | x, y, theta | x, y, cosine, sine |
| floating | position, quaternion (x, y, z, w) | the same |
| one that follows another | none | its own |

Pinocchio's mimic joints raise where the followed joint sorts later. So every joint moves by itself here, followers are
driven along, and their forces are summed up by virtual work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joints import CONTINUOUS, PLANAR
from rttrr_pin.core.model import Model
from rttrr_pin.implementations.joint_maps import LibraryJoint, effects_force, own_slices


@dataclass(frozen=True, slots=True)
class PinJoint(LibraryJoint):
    """A moving joint of ours, where Pinocchio has it.

    Attributes:
        id: Pinocchio's number of it.
    """

    id: int


@dataclass(frozen=True, slots=True)
class Motion:
    """A batch in Pinocchio's coordinates: q (N, nq), v and a (N, nv), every joint moving by itself."""

    q: Array
    v: Array
    a: Array


def pin_joints(model: Model, pin_model: Any) -> list[PinJoint]:
    """The moving joints, in our order."""
    found = []
    for joint, (own_q, own_v) in zip(model.joints, own_slices(model), strict=True):
        if joint.nv:
            number = pin_model.getJointId(joint.name)
            theirs = pin_model.joints[number]
            q, v = slice(theirs.idx_q, theirs.idx_q + theirs.nq), slice(theirs.idx_v, theirs.idx_v + theirs.nv)
            found.append(PinJoint(joint.type, q, v, own_q, own_v, joint.mimic, joint.effects, number))
    return found


def expand(joints: Sequence[PinJoint], pin_model: Any, q: Array, v: Array, a: Array) -> Motion:
    """Our q, v, a as Pinocchio's."""
    rows = len(q)
    motion = Motion(np.empty((rows, pin_model.nq)), np.empty((rows, pin_model.nv)), np.empty((rows, pin_model.nv)))
    for joint in joints:
        q_, v_, a_ = joint.own(q, v, a)
        if joint.type in (CONTINUOUS, PLANAR):
            angle = q_[:, -1:]
            q_ = np.hstack([q_[:, :-1], np.cos(angle), np.sin(angle)])
        motion.q[:, joint.q], motion.v[:, joint.v], motion.a[:, joint.v] = q_, v_, a_
    return motion


def driving_forces(joints: Sequence[PinJoint], tau: Array, motion: Motion) -> tuple[Array, Array]:
    """Tau with friction, which `rnea` leaves out (armature is in it), and the part that the joints take themselves."""
    own, total = np.zeros_like(tau), tau.copy()
    for joint in joints:
        v, a = motion.v[:, joint.v], motion.a[:, joint.v]
        own[:, joint.v] = effects_force(joint.effects, v, a)
        total[:, joint.v] += effects_force(replace(joint.effects, armature=0.0), v, a)
    return total, own


def reach(joints: Sequence[PinJoint], pin_model: Any, motion: Motion) -> Array:
    """At most how far each joint's origin is from that of the joint further in, (N, njoints) [m]."""
    out = np.tile([np.linalg.norm(x.translation) for x in pin_model.jointPlacements], (len(motion.q), 1))
    for joint in joints:
        lengths = sum(own.unit == "m" for own in joint.type.coordinates)  # they come first
        moved = motion.q[:, joint.q][:, :lengths]
        out[:, joint.id] += np.linalg.norm(moved, axis=1)
    return out
