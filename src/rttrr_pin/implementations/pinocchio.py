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
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.joints import CONTINUOUS, PLANAR
from rttrr_pin.core.model import UNIVERSE, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, ModelMismatchError
from rttrr_pin.implementations.allowance import add_inwards, of_library, of_other_numbers
from rttrr_pin.implementations.library import (
    LibraryJoint,
    Motion,
    driving_forces,
    norms,
    own_states,
    product,
    shown,
    urdf_of,
)
from rttrr_pin.implementations.pinocchio_model import (
    PinLink,
    built_model,
    differences,
    pin_joints,
    pin_links,
    snapped_axes,
)
from rttrr_pin.implementations.protocol import Batch, Evaluation

TENSORS = 4
"""Arrays of nv^3 numbers in Pinocchio's data, for second derivatives: of 500 joints they take 4 GB."""

OPERATIONS = 4
"""Roundings on the way of each term over one joint: a vector product, a sum, a change of frame."""


class Pinocchio:
    """Pinocchio's RNEA on the model that Pinocchio built from the same text."""

    name = "pinocchio"
    version: str = pin.__version__
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        """Build Pinocchio's model, and hold it against what the file says.

        Raises:
            ImplementationError: the model has no URDF text, or Pinocchio refuses it.
            ModelMismatchError: Pinocchio built something else.
        """
        urdf = urdf_of(model, "Pinocchio")
        _check_memory(sum(joint.nv for joint in model.joints))
        if any(joint.name == UNIVERSE for joint in model.joints):
            raise ImplementationError(
                f"joint {UNIVERSE!r} has a name that Pinocchio keeps for itself: give it another one"
            )
        try:
            root = (pin.JointModelFreeFlyer(), model.joints[0].name) if model.floating else ()
            self.pin_model, said = built_model(urdf, *root)
        except ImplementationError as error:
            raise ImplementationError(f"Pinocchio refuses the URDF of {model.name!r}: {error}") from error
        if lines := differences(model, self.pin_model):
            raise ModelMismatchError("Pinocchio", lines, said)
        self.pin_model.gravity.linear = np.array(model.gravity)
        self.model = model
        axes = snapped_axes(model, self.pin_model)
        joints = (replace(joint, axis=axes.get(i, joint.axis)) for i, joint in enumerate(model.joints))
        self.built = replace(model, joints=tuple(joints)) if axes else model
        self.notes = tuple(filter(None, (_snapped(model, axes), said)))
        self.joints = pin_joints(model, self.pin_model)
        for joint in self.joints:
            self.pin_model.armature[joint.v] = joint.joint.effects.armature
        self.links = pin_links(model, self.pin_model)
        self._mass = np.array([link.mass for link in self.links])
        self._com = np.array([link.p + link.R @ link.com for link in self.links])
        self._to_link = np.array([link.R.T for link in self.links])
        self._tensor = np.array([link.inertia for link in self.links])
        self.data = self.pin_model.createData()
        self._held = {i: self._held_by(i) for i, link in enumerate(self.links) if link.fixed}
        hanging = {joint for _, joints in self._held.values() for joint in joints}
        self._hanging = {joint: column for column, joint in enumerate(sorted(hanging))}

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n by Pinocchio; a continuous joint's coordinate is its angle."""
        states = own_states(self.model, batch)
        motion = Motion.of(self.joints, states, len(batch), self.pin_model.nq, self.pin_model.nv, _in_cosines)
        loads = self._in_link_axes(batch.loads, motion.q)
        record = self._run(motion, loads)
        F, N = self._net(record)
        f, n, moments = self._across_joints(record, F, N, loads)
        tau, tau_joint = driving_forces(self.model, self.joints, states, record.tau, has_armature=True)
        values = {"tau": tau, "F": F, "N": N, "f": f, "n": n}
        cancelling = _rounding(self.pin_model, self.links, record.spatial, self._reach(motion))
        for i, (links, hanging) in self._held.items():
            if not hanging and not any(self.links[k].massive for k in links):
                cancelling["f"][:, i] = cancelling["n"][:, i] = 0.0  # nothing but loads acts there
        cancelling["n"] += OPERATIONS * EPS * moments
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
                link, turns = self.links[load.link], np.empty((len(q), 3, 3))
                for k in range(len(q)):
                    pin.forwardKinematics(self.pin_model, self.data, q[k])
                    turns[k] = (self.data.oMi[link.joint].rotation @ link.R).T
                f, n = (product(turns, x) for x in (f, n))
            out.append(Load(load.link, f, n))
        return out

    def _run(self, motion: Motion, loads: Sequence[Load]) -> _Record:
        """Call `rnea` on each state and keep what it leaves in `data`, whose entries the next call overwrites."""
        model, data, rows = self.pin_model, self.data, len(motion.q)
        views = [x.vector for name in ("f", "v", "a_gf") for x in getattr(data, name)]
        placements = [data.liMi[joint] for joint in self._hanging]
        parts = [x for M in placements for x in (*M.rotation.T, M.translation)]  # rows of R^T, then p: views too
        spatial, hanging = np.empty((rows, 18 * model.njoints)), np.empty((rows, 12 * len(placements)))
        tau = np.empty((rows, model.nv))
        external = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
        forces: dict[int, Array] = {}  # minus the sum of the loads, by joint
        for load in loads:
            link = self.links[load.link]
            forces[link.joint] = forces.get(link.joint, np.zeros((rows, 6))) - link.to_joint(load.f, load.n)
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
        at = [link.joint for link in self.links]
        v, w = np.split(record.spatial[:, 1, at], 2, axis=-1)
        v_dot, w_dot = np.split(record.spatial[:, 2, at], 2, axis=-1)
        c, R_T, I = self._com, self._to_link, self._tensor
        # a_gf is a spatial acceleration: w x v makes it that of the point at the origin.
        at_com = v_dot + np.cross(w, v) + np.cross(w_dot, c) + np.cross(w, np.cross(w, c))
        F = product(R_T, self._mass[:, None] * at_com)
        w, w_dot = product(R_T, w), product(R_T, w_dot)
        return F, product(I, w_dot) + np.cross(w, product(I, w))

    def _across_joints(self, record: _Record, F: Array, N: Array, loads: Sequence[Load]) -> tuple[Array, Array, Array]:
        """f, n: what crosses each joint, moving or fixed; and the moments that round on the way, (N, links).

        Behind a fixed joint, forces go to the body's origin and from there to the link's: their moments about both
        round.
        """
        rows = len(record.tau)
        out, moments = np.zeros((rows, len(self.links), 6)), np.zeros((rows, len(self.links)))
        for i, link in enumerate(self.links):
            if not link.fixed:
                out[:, i] = record.spatial[:, 0, link.joint]
                continue
            # Pinocchio keeps no force across a fixed joint: it is what moves the links behind it and all they carry.
            total = np.zeros((rows, 6))
            for arm, f, at_body in self._behind(i, record, F, N, loads):
                total += at_body
                moments[:, i] += (link.arm + arm) * norm(f)
            out[:, i] = link.from_joint(total)
            for load in loads:
                if load.link == i:
                    out[:, i] += np.concatenate([load.f, load.n], axis=1)
        return out[..., :3], out[..., 3:], moments

    def _behind(
        self, i: int, record: _Record, F: Array, N: Array, loads: Sequence[Load]
    ) -> Iterator[tuple[float | Array, Array, Array]]:
        """All that acts behind fixed joint i: its distance from the body's origin, force, and wrench there, (N, 6)."""
        links, hanging = self._held[i]
        for k in links:
            link = self.links[k]
            at_body = link.to_joint(F[:, k], N[:, k] + np.cross(link.com, F[:, k]))
            yield link.arm + float(norm(link.com)), F[:, k], at_body
        for joint in hanging:
            placement = record.hanging[:, self._hanging[joint]]
            R, p = np.swapaxes(placement[:, :3], -1, -2), placement[:, 3]
            force, moment = np.split(record.spatial[:, 0, joint], 2, axis=-1)
            f, n = product(R, force), product(R, moment)
            yield norm(p), force, np.concatenate([f, n + np.cross(p, f)], axis=1)
        for load in loads:
            if load.link in links and load.link != i:
                link = self.links[load.link]
                yield link.arm, load.f, link.to_joint(load.f, load.n)

    def _held_by(self, i: int) -> tuple[list[int], list[int]]:
        """The links that are one rigid body with link i, further out, and Pinocchio's moving joints on them."""
        body, parents = self.links[i].joint, [joint.parent for joint in self.model.joints]
        links = [k for k, link in enumerate(self.links) if link.joint == body and i in self.model.path(k)]
        return links, [link.joint for k, link in enumerate(self.links) if not link.fixed and parents[k] in links]

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
        ImplementationError: it does not.
    """
    needed, there = TENSORS * 8 * nv**3, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        raise ImplementationError(
            f"Pinocchio's data grows with the cube of the degrees of freedom: {needed / 1e9:,.0f} GB for the {nv:,} of "
            f"this robot, on a machine with {there / 1e9:,.0f} GB; pass reference='recursion' instead",
            {"reference='recursion'": "--reference recursion"},
        )


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


def _rounding(pin_model: pin.Model, links: Sequence[PinLink], spatial: Array, reach: Array) -> dict[str, Array]:
    """What rounds in Pinocchio's formulas and does not occur in ours: sizes times `OPERATIONS` eps, (N, links) each.

    - Spatial accelerations and momenta about the joint's origin O contain terms that cancel in the result: w x v_O in
      `a_gf`, v_O x m v_O and m |c|^2 (|w_dot| + |w|^2) in the moment.
    - Rotations about an axis that is not x, y or z itself, -z for one, come from 1 - cos q, so that even what lies
      along the axis is rounded when it is carried over the joint. Ours carries it over exactly, and its bound knows.

    Sizes add up like the terms: outwards for velocities and accelerations, inwards for forces and moments. `reach` is
    at most how far a joint's origin is from that of the joint further in, (N, njoints) [m].
    """
    v, w = (norm(x) for x in np.split(spatial[:, 1], 2, axis=-1))
    v_dot, w_dot = (norm(x) for x in np.split(spatial[:, 2], 2, axis=-1))
    parents = [int(parent) for parent in pin_model.parents]
    turning = w_dot + w**2
    acceleration = v_dot + w * v
    for joint in range(1, len(parents)):
        turning[:, joint] += turning[:, parents[joint]]
        acceleration[:, joint] += acceleration[:, parents[joint]] + reach[:, joint] * turning[:, parents[joint]]

    inertias = pin_model.inertias
    mass = norms(inertia.mass for inertia in inertias)  # a size, also where a file has it negative
    c, tensor = norms(inertia.lever for inertia in inertias), norms(inertia.inertia for inertia in inertias)
    force = mass * (acceleration + c * turning)
    moment = mass * (v**2 + c * acceleration + c**2 * turning) + tensor * turning
    add_inwards([-1, *parents[1:]], force, moment, reach)

    at = [link.joint for link in links]
    arm = norms(link.p for link in links)
    own_arm = arm + norms(link.com for link in links)
    out = {
        "F": norms(link.mass for link in links) * (acceleration[:, at] + own_arm * turning[:, at]),
        "N": norms(link.inertia for link in links) * turning[:, at],
        "f": force[:, at],
        "n": moment[:, at] + arm * force[:, at],
    }
    return {key: OPERATIONS * EPS * size for key, size in out.items()}
