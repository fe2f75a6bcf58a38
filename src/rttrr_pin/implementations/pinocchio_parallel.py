"""One call of Pinocchio's recursion for all states of a batch, on a model in which wrenches are driving forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.implementations.library import Motion

FEATHER = 2.0**-500
"""Mass [kg] and principal moments [kg m^2] of a feather, which weighs nothing beside any payload."""


class Wrenches(NamedTuple):
    """What Pinocchio says of a batch, consecutive states side by side.

    Attributes:
        tau: of every joint moving by itself, (nv, N).
        crossing: by link, what crosses its joint, at the origin of its body, in the body's axes; force, then moment,
            (links, 6, N). The payload of a link on a fixed joint is not in its own.
        F, N: of each link, (links, 3, N).
    """

    tau: Array
    crossing: Array
    F: Array
    N: Array


@dataclass
class Draft:
    """A model with locked joints, as it is built.

    Attributes:
        model: Pinocchio's.
        crossing, F, N, feathers: by link, the locked joint from which f, n, F, N are read, or that has its payload.
        moving: by Pinocchio's number of a joint, the number here.
        driven: those whose driving force is read.
    """

    model: Any = field(default_factory=pin.Model)
    crossing: dict[int, int] = field(default_factory=dict)
    F: dict[int, int] = field(default_factory=dict)
    N: dict[int, int] = field(default_factory=dict)
    feathers: dict[int, int] = field(default_factory=dict)
    moving: dict[int, int] = field(default_factory=dict)
    driven: set[int] = field(default_factory=set)

    def locked(self, parent: int, placement: Any, kind: Any = pin.JointModelFreeFlyer) -> int:
        """Hang a locked joint on a joint."""
        number: int = self.model.addJoint(parent, kind(), placement, f"locked {self.model.njoints}")
        return number


class WrenchModel:
    """A model of some part of a robot, from which some wrenches are read."""

    def __init__(self, draft: Draft, pin_model: Any, threads: int) -> None:
        built = draft.model
        for body in draft.driven:
            own, here = pin_model.joints[body], built.joints[draft.moving[body]]
            built.armature[here.idx_v : here.idx_v + here.nv] = pin_model.armature[own.idx_v : own.idx_v + own.nv]
        self._pool, self._threads, self._neutral, self.nv = (
            pin.ModelPool(built, threads),
            threads,
            pin.neutral(built),
            built.nv,
        )
        self._arrays: list[Array] = [np.empty(0)]
        pairs = [(pin_model.joints[body], built.joints[number]) for body, number in draft.moving.items()]
        self._q = [(_q_of(here), _q_of(own)) for own, here in pairs]
        self._v = [(_v_of(here), _v_of(own)) for own, here in pairs]
        self._tau = [
            (_v_of(built.joints[draft.moving[body]]), _v_of(pin_model.joints[body])) for body in sorted(draft.driven)
        ]
        self._feathers, self._crossing, self._F, self._N = (
            [(link, _v_of(built.joints[number])) for link, number in x.items()]
            for x in (draft.feathers, draft.crossing, draft.F, draft.N)
        )

    def run(self, motion: Motion, loads: Sequence[Load], result: Wrenches) -> None:
        """Compute, and write what is read here."""
        q, v, a, forces = self._memory(len(motion.q))
        for here, own in self._q:
            q[:, here] = motion.q[:, own]
        for here, own in self._v:
            v[:, here], a[:, here] = motion.v[:, own], motion.a[:, own]
        for link, here in self._feathers:
            a[:, here] = 0.0
            for load in (load for load in loads if load.link == link):
                a[:, here] += np.concatenate([load.f, load.n], axis=1) / FEATHER
        pin.rneaInParallel(self._threads, self._pool, q.T, v.T, a.T, forces.T)
        columns = np.ascontiguousarray(forces.T)
        for here, own in self._tau:
            result.tau[own] = columns[here]
        read = ((self._crossing, result.crossing), (self._F, result.F), (self._N, result.N))
        for places, target in read:
            for link, here in places:
                target[link] = columns[here]

    def _memory(self, rows: int) -> list[Array]:
        """q, v, a and forces of so many states; what is locked stands still in them for good."""
        if len(self._arrays[0]) != rows:
            self._arrays = [np.tile(self._neutral, (rows, 1)), *(np.zeros((rows, self.nv)) for _ in range(3))]
        return self._arrays


def _q_of(joint: Any) -> slice:
    return slice(joint.idx_q, joint.idx_q + joint.nq)


def _v_of(joint: Any) -> slice:
    return slice(joint.idx_v, joint.idx_v + joint.nv)
