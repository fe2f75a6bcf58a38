"""Pinocchio: each of the five quantities from Pinocchio's own numbers.

| quantity | from |
|---|---|
| tau | the return value of `rnea` |
| f, n of a moving joint | `data.f` |
| F, N | `data.a_gf`, `data.v` and the inertia, taken to the centre of mass |
| f, n of a fixed joint | the F, N of all links that it holds, and the `data.f` of the moving joints on them |

The payload enters through `fext`, with the opposite sign: `fext` is what the surroundings exert on the robot.

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
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array, norm, product
from rttrr_pin.core.joints import CONTINUOUS, PLANAR
from rttrr_pin.core.model import UNIVERSE, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, ModelMismatchError, RefusalError
from rttrr_pin.implementations.allowance import of_library, of_other_numbers, sum_inwards
from rttrr_pin.implementations.library import (
    LibraryJoint,
    Motion,
    driving_forces,
    norms,
    own_states,
    shown,
    urdf_of,
)
from rttrr_pin.implementations.pinocchio_model import (
    Assembly,
    built_model,
    differences,
    merged_apart,
    pin_joints,
    pin_links,
    snapped_axes,
)
from rttrr_pin.implementations.pinocchio_rounding import LoadSizes, carrying, load_sizes, rounding
from rttrr_pin.implementations.protocol import Batch, Evaluation

TENSORS = 4
"""Arrays of nv^3 numbers in Pinocchio's data, for second derivatives: of 500 joints they take 4 GB."""


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
        fixed = self.links.fixed
        self._carrier = [p if p >= 0 and fixed[p] else -1 for p in (joint.parent for joint in model.joints)]
        self._inward = [p if own else -1 for p, own in zip(self._carrier, fixed, strict=True)]
        self._hanging = [i for i, p in enumerate(self._carrier) if p >= 0 and not fixed[i]]
        self._idle = self._without_inertia()

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n by Pinocchio; a continuous joint's coordinate is its angle."""
        states = own_states(self.model, batch)
        motion = Motion.of(self.joints, states, len(batch), self.pin_model.nq, self.pin_model.nv, _in_cosines)
        loads = self._in_link_axes(batch.loads, motion.q)
        record = self._run(motion, loads)
        F, N = self._net(record)
        sizes = load_sizes(self.pin_model, self.links, batch.loads, len(batch))
        behind = self._behind(record, F, N, loads, sizes)
        f, n = self._across_joints(record, behind, loads)
        tau, tau_joint = driving_forces(self.model, self.joints, states, record.tau, has_armature=True)
        values = {"tau": tau, "F": F, "N": N, "f": f, "n": n}
        cancelling = rounding(self.pin_model, self.links, self._apart, record.spatial, self._reach(motion), sizes)
        cancelling["f"][:, self._idle] = cancelling["n"][:, self._idle] = 0.0
        for key, size in carrying(self.links, behind[..., 6], behind[..., 7], sizes).items():
            cancelling[key] += size
        allowance = of_library(batch, values, tau_joint, cancelling)
        if self.built is not self.model:
            changed = of_other_numbers(batch, self.built)
            allowance = {key: x + changed[key] for key, x in allowance.items()}
        return Evaluation(values, allowance, tau_joint)

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

    def _run(self, motion: Motion, loads: Sequence[Load]) -> _Record:
        """Call `rnea` on each state and keep what it leaves in `data`, whose entries the next call overwrites."""
        model, data, rows = self.pin_model, self.data, len(motion.q)
        views = [x.vector for name in ("f", "v", "a_gf") for x in getattr(data, name)]
        placements = [data.liMi[int(self.links.joint[i])] for i in self._hanging]
        parts = [x for M in placements for x in (*M.rotation.T, M.translation)]  # rows of R^T, then p: views too
        spatial, hanging = np.empty((rows, 18 * model.njoints)), np.empty((rows, 12 * len(placements)))
        tau = np.empty((rows, model.nv))
        external = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
        forces: dict[int, Array] = {}  # minus the sum of the loads, by joint
        for load in loads:
            link = self.links.at(load.link)
            joint = int(link.joint)
            forces[joint] = forces.get(joint, np.zeros((rows, 6))) - link.to_joint(load.f, load.n)
        targets = [(external[joint].vector, values) for joint, values in forces.items()]
        for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
            for target, values in targets:
                target[:] = values[k]
            tau[k] = pin.rnea(model, data, q, v, a, external)
            np.concatenate(views, out=spatial[k])
            if parts:
                np.concatenate(parts, out=hanging[k])
        return _Record(tau, spatial.reshape(rows, 3, model.njoints, 6), hanging.reshape(rows, len(placements), 4, 3))

    def _net(self, record: _Record) -> tuple[Array, Array]:
        """F, N: mass times acceleration of the centre of mass, and Euler's equation about it."""
        links = self.links
        v, w = np.split(record.spatial[:, 1, links.joint], 2, axis=-1)
        v_dot, w_dot = np.split(record.spatial[:, 2, links.joint], 2, axis=-1)
        c, R_T, I = links.p + product(links.R, links.com), np.swapaxes(links.R, -1, -2), links.inertia
        # a_gf is a spatial acceleration: w x v makes it that of the point at the origin.
        at_com = v_dot + np.cross(w, v) + np.cross(w_dot, c) + np.cross(w, np.cross(w, c))
        F = product(R_T, links.mass[:, None] * at_com)
        w, w_dot = product(R_T, w), product(R_T, w_dot)
        return F, product(I, w_dot) + np.cross(w, product(I, w))

    def _across_joints(self, record: _Record, behind: Array, loads: Sequence[Load]) -> tuple[Array, Array]:
        """f, n: what crosses each joint, moving or fixed.

        Pinocchio keeps no force across a fixed joint: it is what moves the links behind it and all that they carry.
        These forces go to the body's origin, add up there, and go on to the link's.
        """
        links, fixed = self.links, self.links.fixed
        out = record.spatial[:, 0, links.joint]
        out[:, fixed] = links.at(fixed).from_joint(behind[:, fixed, :6])
        for load in loads:
            if fixed[load.link]:
                out[:, load.link] += np.concatenate([load.f, load.n], axis=1)
        return out[..., :3], out[..., 3:]

    def _behind(self, record: _Record, F: Array, N: Array, loads: Sequence[Load], sizes: Sequence[LoadSizes]) -> Array:
        """What crosses each fixed joint but the load at its own link, see `_acting`; zero for joints that move."""
        fixed, own = self.links.fixed, self.links.at(self.links.fixed)
        behind = np.zeros((*F.shape[:2], 8))
        F, N = F[:, fixed], N[:, fixed]
        force = norm(F)
        moment = norm(N) + norm(own.com) * force
        behind[:, fixed] = _acting(own.to_joint(F, N + np.cross(own.com, F)), force, moment, own.arm)
        for k, i in enumerate(self._hanging):
            R, p = np.swapaxes(record.hanging[:, k, :3], -1, -2), record.hanging[:, k, 3]
            force, moment = np.split(record.spatial[:, 0, self.links.joint[i]], 2, axis=-1)
            f, n = product(R, force), product(R, moment)
            at_body = np.concatenate([f, n + np.cross(p, f)], axis=1)
            behind[:, self._carrier[i]] += _acting(at_body, norm(force), norm(moment), norm(p))
        for load, size in zip(loads, sizes, strict=True):
            if (carrier := self._inward[load.link]) >= 0:
                link, times = self.links.at(load.link), 1 + size.turned
                at_body = link.to_joint(load.f, load.n)
                behind[:, carrier] += _acting(at_body, times * size.f, times * size.n, link.arm)
        sum_inwards(self._inward, behind)
        return behind

    def _without_inertia(self) -> NDArray[np.bool_]:
        """The fixed links on which, and behind which, nothing acts but loads."""
        acting = np.array(self.links.fixed & self.links.massive, dtype=int)
        for i in self._hanging:
            acting[self._carrier[i]] += 1
        sum_inwards(self._inward, acting[None])
        idle: NDArray[np.bool_] = self.links.fixed & (acting == 0)
        return idle

    def _reach(self, motion: Motion) -> Array:
        """At most how far each joint's origin is from that of the joint further in, (N, njoints) [m]."""
        out = np.tile(norms(x.translation for x in self.pin_model.jointPlacements), (len(motion.q), 1))
        for joint in self.joints:
            lengths = sum(own.unit == "m" for own in joint.joint.type.coordinates)  # they come first
            out[:, self.pin_model.getJointId(joint.joint.name)] += norm(motion.q[:, joint.q][:, :lengths])
        return out


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
    needed, there = TENSORS * 8 * nv**3, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        raise RefusalError(
            f"Pinocchio's data grows with the cube of the degrees of freedom: {needed / 1e9:,.0f} GB for the {nv:,} of "
            f"this robot, on a machine with {there / 1e9:,.0f} GB; pass reference='recursion' instead",
            {"reference='recursion'": "--reference recursion"},
        )


def _acting(wrench: Array, force: Array, moment: Array, arm: Array) -> Array:
    """A wrench at the body's origin, and what rounds of it: sizes of the force and of the moment, (N, ..., 8).

    Both are said where it came from, at the end of that arm.
    """
    return np.concatenate([wrench, np.stack([force, moment + arm * force], axis=-1)], axis=-1)


class _Record(NamedTuple):
    """What is kept of a batch."""

    tau: Array  # of every joint moving by itself, (N, nv)
    spatial: Array  # data.f, data.v, data.a_gf of each joint, linear before angular, (N, 3, njoints, 6)
    hanging: Array  # data.liMi of the joints that hang on fixed links: the columns of R, then p, (N, joints, 4, 3)


def _in_cosines(joint: LibraryJoint, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
    """Our coordinates of a joint as Pinocchio's: an angle without limits as cosine and sine."""
    if joint.joint.type in (CONTINUOUS, PLANAR):
        q = np.hstack([q[:, :-1], np.cos(q[:, -1:]), np.sin(q[:, -1:])])
    return q, v, a
