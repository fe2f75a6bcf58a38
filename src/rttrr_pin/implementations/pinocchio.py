"""Pinocchio: each of the five quantities from Pinocchio's own numbers.

| quantity | from |
|---|---|
| tau | `rneaInParallel` on all states |
| f, n, F, N | the same, as driving forces of locked joints (`pinocchio_wrenches`) |

Where a robot is too large for that, `rnea` runs state by state, and they come from its data (`pinocchio_loop`).

| joint | our q | Pinocchio's q |
|---|---|---|
| continuous | angle | cosine, sine |
| planar | x, y, theta | x, y, cosine, sine |
| floating | position, quaternion (x, y, z, w) | the same |
| one that follows another | none | its own |

Pinocchio's mimic joints raise where the followed joint sorts later. So every joint moves by itself here.

Pinocchio has a function for fixed joints, `computeSupportedForceByFrame`, but it adds every moving joint of the rigid
body, whichever link of it they hang on, and none if the body is the universe: it is right where the body has no branch.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.core.joints import CONTINUOUS, PLANAR
from rttrr_pin.core.model import UNIVERSE, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, ModelMismatchError, RefusalError
from rttrr_pin.implementations.allowance import of_other_numbers
from rttrr_pin.implementations.library import (
    LibraryJoint,
    Motion,
    driving_forces,
    own_states,
    shown,
    urdf_of,
)
from rttrr_pin.implementations.pinocchio_loop import StateByState
from rttrr_pin.implementations.pinocchio_model import (
    Assembly,
    built_model,
    differences,
    merged_apart,
    pin_joints,
    pin_links,
    snapped_axes,
)
from rttrr_pin.implementations.pinocchio_parallel import Wrenches
from rttrr_pin.implementations.pinocchio_rounding import Rounding
from rttrr_pin.implementations.pinocchio_wrenches import WrenchModels, data_bytes
from rttrr_pin.implementations.protocol import Batch, Evaluation


class Pinocchio:
    """Pinocchio's RNEA on the model that Pinocchio built from the same text."""

    name = "pinocchio"
    version: str = pin.__version__
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        """Build Pinocchio's model, and hold it against what the file says.

        Raises:
            RefusalError: the model has no URDF text, or Pinocchio refuses it.
            ModelMismatchError: Pinocchio built something else.
        """
        urdf = urdf_of(model, "Pinocchio")
        _check_memory(sum(joint.nv for joint in model.joints))
        if any(joint.name == UNIVERSE for joint in model.joints):
            raise RefusalError(f"joint {UNIVERSE!r} has a name that Pinocchio keeps for itself: give it another one")
        try:
            root = (pin.JointModelFreeFlyer(), model.joints[0].name) if model.floating else ()
            self.pin_model, said = built_model(urdf, *root)
        except ImplementationError as error:
            raise RefusalError(f"Pinocchio refuses the URDF of {model.name!r}: {error}") from error
        assembly = Assembly(model, self.pin_model)
        if lines := differences(assembly):
            raise ModelMismatchError("Pinocchio", lines, said)
        self.pin_model.gravity.linear = np.array(model.gravity)
        self.model = model
        axes = snapped_axes(assembly)
        joints = (replace(joint, axis=axes.get(i, joint.axis)) for i, joint in enumerate(model.joints))
        self.built = replace(model, joints=tuple(joints)) if axes else model
        self.notes = tuple(filter(None, (_snapped(model, axes), said)))
        self.joints = pin_joints(model, self.pin_model)
        for joint in self.joints:
            self.pin_model.armature[joint.v] = joint.joint.effects.armature
        self.links = pin_links(assembly)
        self._apart = merged_apart(assembly)
        self.data = assembly.data
        self._wrenches: dict[tuple[int, ...], WrenchModels | StateByState] = {}
        self._rounding: dict[tuple[object, ...], Rounding] = {}

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n by Pinocchio; a continuous joint's coordinate is its angle."""
        states = own_states(self.model, batch)
        motion = Motion.of(self.joints, states, len(batch), self.pin_model.nq, self.pin_model.nv, _in_cosines)
        loads = self._in_link_axes(batch.loads, motion.q)
        wrenches = self._run(motion, loads)
        f, n = self._across_joints(wrenches, loads)
        F, N = (np.moveaxis(x, -1, 0) for x in (wrenches.F, wrenches.N))
        tau, tau_joint = driving_forces(self.model, self.joints, states, wrenches.tau.T, has_armature=True)
        values = {"tau": tau, "F": F, "N": N, "f": f, "n": n}
        allowance = self._rounding_of(batch)(batch, values, tau_joint)
        if self.built is not self.model:
            changed = of_other_numbers(batch, self.built)
            allowance = {key: x + changed[key] for key, x in allowance.items()}
        return Evaluation(values, allowance, tau_joint)

    def _run(self, motion: Motion, loads: Sequence[Load]) -> Wrenches:
        """The wrenches of all states; of those without any payload by a model without it, so that zeros are zeros."""
        carries = np.any([load.f.any(axis=1) | load.n.any(axis=1) for load in loads], axis=0) if loads else np.False_
        if carries.all() or not carries.any():
            acting = loads if carries.any() else ()
            return self._programs(tuple(load.link for load in acting)).wrenches(motion, acting)
        parts = []
        for which, acting in ((carries, loads), (~carries, ())):
            own = Motion(*(x[which] for x in (motion.q, motion.v, motion.a)))
            parts.append(self._run(own, [Load(load.link, load.f[which], load.n[which]) for load in acting]))
        order = np.argsort(np.concatenate([np.flatnonzero(carries), np.flatnonzero(~carries)]))
        return Wrenches(*(np.concatenate(pair, axis=-1)[..., order] for pair in zip(*parts, strict=True)))

    def _programs(self, loaded: tuple[int, ...]) -> WrenchModels | StateByState:
        """What runs Pinocchio, with payloads at these links."""
        if loaded not in self._wrenches:
            try:
                self._wrenches[loaded] = WrenchModels(self.model, self.pin_model, self.links, loaded)
            except MemoryError:
                self._wrenches[loaded] = StateByState(self.model, self.pin_model, self.links)
        return self._wrenches[loaded]

    def _rounding_of(self, batch: Batch) -> Rounding:
        loads = tuple((load.link, load.in_base) for load in batch.loads)
        key = (loads, batch.compiled)
        if key not in self._rounding:
            self._rounding[key] = Rounding(
                self.built, self.pin_model, self.links, self._apart, loads, compiled=batch.compiled
            )
        return self._rounding[key]

    def _in_link_axes(self, loads: Sequence[Load], q: Array) -> list[Load]:
        """The loads with one force and one moment for each state, in the axes of their links."""
        out = []
        for load in loads:
            f, n = (np.broadcast_to(x, (len(q), 3)) for x in (load.f, load.n))
            if load.in_base:
                link, turns = self.links.at(load.link), np.empty((len(q), 3, 3))
                for k in range(len(q)):
                    pin.forwardKinematics(self.pin_model, self.data, q[k])
                    turns[k] = (self.data.oMi[int(link.joint)].rotation @ link.R).T
                f, n = (product(turns, x) for x in (f, n))
            out.append(Load(load.link, f, n))
        return out

    def _across_joints(self, wrenches: Wrenches, loads: Sequence[Load]) -> tuple[Array, Array]:
        """f, n at the links' origins, in their axes, from what crosses their joints."""
        fixed, out = self.links.fixed, wrenches.crossing
        for i in np.flatnonzero(fixed).tolist():
            out[i] = self.links.from_joint(i, out[i])
        for load in loads:
            if fixed[load.link]:
                out[load.link] += np.concatenate([load.f, load.n], axis=1).T
        return np.moveaxis(out[:, :3], -1, 0), np.moveaxis(out[:, 3:], -1, 0)


def _snapped(model: Model, axes: Mapping[int, Array]) -> str:
    """Which axes Pinocchio took as x, y or z, in one sentence; empty where there is none."""
    each = [
        f"the axis of joint {model.joints[i].name!r} as {shown(axis)}, the file says {shown(model.joints[i].axis)}"
        for i, axis in axes.items()
    ]
    return f"Pinocchio takes {'; '.join(each)}: what that changes is allowed for" if each else ""


def _check_memory(nv: int) -> None:
    """Say before it is tried that Pinocchio's data does not fit in memory.

    Raises:
        RefusalError: it does not.
    """
    needed, there = data_bytes(nv), os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        raise RefusalError(
            f"Pinocchio's data grows with the cube of the degrees of freedom: {needed / 1e9:,.0f} GB for the {nv:,} of "
            f"this robot, on a machine with {there / 1e9:,.0f} GB; pass reference='recursion' instead",
            {"reference='recursion'": "--reference recursion"},
        )


def _in_cosines(joint: LibraryJoint, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
    """Our coordinates of a joint as Pinocchio's: an angle without limits as cosine and sine."""
    if joint.joint.type in (CONTINUOUS, PLANAR):
        q = np.hstack([q[:, :-1], np.cos(q[:, -1:]), np.sin(q[:, -1:])])
    return q, v, a
