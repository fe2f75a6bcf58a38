"""Pinocchio: each of the five quantities from Pinocchio's own numbers.

| quantity | from |
|---|---|
| tau | the return value of `rnea` |
| f, n of a moving joint | `data.f` |
| F, N | `data.a_gf`, `data.v` and the inertia, taken to the centre of mass |
| f, n of a fixed joint | the F, N of all links that it holds, and the `data.f` of the moving joints on them |

The payload enters through `fext`, with the opposite sign: `fext` is what the surroundings exert on the robot.

Pinocchio has a function for fixed joints, `computeSupportedForceByFrame`, but it adds every moving joint of the rigid
body, whichever link of it they hang on, and none if the body is the universe: it is right where the body has no branch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import ROOT_JOINT, UNIVERSE, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, ModelMismatchError
from rttrr_pin.implementations.allowance import of_library
from rttrr_pin.implementations.joint_maps import reduce_forces
from rttrr_pin.implementations.pinocchio_joints import Motion, driving_forces, expand, pin_joints, reach
from rttrr_pin.implementations.pinocchio_model import differences, pin_links, product
from rttrr_pin.implementations.pinocchio_rounding import OPERATIONS, rounding
from rttrr_pin.implementations.protocol import Batch, Evaluation
from rttrr_pin.implementations.registry import urdf_of


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
        reserved = {UNIVERSE, ROOT_JOINT} if model.floating else {UNIVERSE}
        taken = [joint.name for joint in model.joints[model.floating :] if joint.name in reserved]
        if taken:
            raise ImplementationError(
                f"joint {taken[0]!r} has a name that Pinocchio keeps for itself: give it another one"
            )
        try:
            root = (pin.JointModelFreeFlyer(),) if model.floating else ()
            self.pin_model = pin.buildModelFromXML(urdf, *root)
        except (ValueError, RuntimeError) as error:
            raise ImplementationError(f"Pinocchio refuses the URDF of {model.name!r}: {str(error).strip()}") from error
        found = differences(model, self.pin_model)
        if found:
            raise ModelMismatchError("Pinocchio", found)
        self.pin_model.gravity.linear = np.array(model.gravity)
        self.model = model
        self.joints = pin_joints(model, self.pin_model)
        for joint in self.joints:
            self.pin_model.armature[joint.v] = joint.effects.armature
        self.links = pin_links(model, self.pin_model)
        self.data = self.pin_model.createData()
        self._held = [self._held_by(i) for i in range(len(self.links))]
        hanging = {joint for held in self._held for joint in held.hanging}
        self._hanging = {joint: place for place, joint in enumerate(sorted(hanging))}

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n by Pinocchio; a continuous joint's coordinate is its angle."""
        motion = expand(self.joints, self.pin_model, batch.q, batch.v, batch.a)
        turned = self._in_link_axes(batch.loads, motion.q)
        record = self._run(motion, turned)
        F, N = self._net(record)
        f, n = self._across_joints(record, F, N, turned)
        tau, tau_joint = (
            reduce_forces(self.model, self.joints, x) for x in driving_forces(self.joints, record.tau, motion)
        )
        values = {"tau": tau, "F": F, "N": N, "f": f, "n": n}
        cancelling = self._rounding(record, motion, F, turned)
        return Evaluation(values, of_library(batch, values, tau_joint, cancelling), tau_joint)

    def _in_link_axes(self, loads: Sequence[Load], q: Array) -> list[Load]:
        """The loads with one force and one moment for each state, in the axes of their links."""
        out = []
        for load in loads:
            f, n = (np.broadcast_to(x, (len(q), 3)) for x in (load.f, load.n))
            if load.in_base:
                turns = self._base_to_link(load.link, q)
                f, n = (product(turns, x) for x in (f, n))
            out.append(Load(load.link, f, n))
        return out

    def _base_to_link(self, i: int, q: Array) -> Array:
        """The rotation from base axes to those of link i, (N, 3, 3), from Pinocchio's placements."""
        link, turns = self.links[i], np.empty((len(q), 3, 3))
        for k in range(len(q)):
            pin.forwardKinematics(self.pin_model, self.data, q[k])
            turns[k] = (self.data.oMi[link.joint].rotation @ link.R).T
        return turns

    def _run(self, motion: Motion, loads: Sequence[Load]) -> _Record:
        """Call `rnea` on each state and keep what it leaves in `data`, whose entries the next call overwrites."""
        model, data = self.pin_model, self.data
        rows = len(motion.q)
        views = [x.vector for name in ("f", "v", "a_gf") for x in getattr(data, name)]
        placements = [data.liMi[joint] for joint in self._hanging]
        parts = [x for M in placements for x in (*M.rotation.T, M.translation)]  # rows of R^T, then p: views too
        spatial, hanging = np.empty((rows, 18 * model.njoints)), np.empty((rows, 12 * len(placements)))
        tau = np.empty((rows, model.nv))
        external = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
        forces = self._external(loads, rows)
        targets = [(external[joint].vector, values) for joint, values in forces.items()]
        for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
            for target, values in targets:
                target[:] = values[k]
            tau[k] = pin.rnea(model, data, q, v, a, external)
            np.concatenate(views, out=spatial[k])
            if parts:
                np.concatenate(parts, out=hanging[k])
        return _Record(tau, spatial.reshape(rows, 3, model.njoints, 6), hanging.reshape(rows, len(placements), 4, 3))

    def _external(self, loads: Sequence[Load], rows: int) -> dict[int, Array]:
        """`fext` by joint, (N, 6): minus the sum of the loads."""
        total: dict[int, Array] = {}
        for load in loads:
            link = self.links[load.link]
            total[link.joint] = total.get(link.joint, np.zeros((rows, 6))) - link.to_joint(load.f, load.n)
        return total

    def _net(self, record: _Record) -> tuple[Array, Array]:
        """F, N: mass times acceleration of the centre of mass, and Euler's equation about it."""
        F, N = (np.empty((len(record.tau), len(self.links), 3)) for _ in "FN")
        for i, link in enumerate(self.links):
            v, w = np.split(record.spatial[:, 1, link.joint], 2, axis=-1)
            v_dot, w_dot = np.split(record.spatial[:, 2, link.joint], 2, axis=-1)
            c = link.p + link.R @ link.com
            # a_gf is a spatial acceleration: w x v makes it that of the point at the origin.
            at_com = v_dot + np.cross(w, v) + np.cross(w_dot, c) + np.cross(w, np.cross(w, c))
            F[:, i] = product(link.R.T, link.mass * at_com)
            w, w_dot = product(link.R.T, w), product(link.R.T, w_dot)
            N[:, i] = product(link.inertia, w_dot) + np.cross(w, product(link.inertia, w))
        return F, N

    def _across_joints(self, record: _Record, F: Array, N: Array, loads: Sequence[Load]) -> tuple[Array, Array]:
        """f, n: what crosses each joint, moving or fixed."""
        out = np.zeros((len(record.tau), len(self.links), 6))
        for i, link in enumerate(self.links):
            if not link.fixed:
                out[:, i] = record.spatial[:, 0, link.joint]
                continue
            held = self._held[i]
            total = np.zeros((len(record.tau), 6))
            for k in held.links:
                moment = N[:, k] + np.cross(self.links[k].com, F[:, k])
                total += self.links[k].to_joint(F[:, k], moment)
            for joint in held.hanging:
                R_T, p = record.hanging[:, self._hanging[joint], :3], record.hanging[:, self._hanging[joint], 3]
                R = np.swapaxes(R_T, -1, -2)
                f, n = (product(R, x) for x in np.split(record.spatial[:, 0, joint], 2, axis=-1))
                total += np.concatenate([f, n + np.cross(p, f)], axis=1)
            carried = [load for load in loads if load.link in held.links]
            for load in carried:
                if load.link != i:
                    total += self.links[load.link].to_joint(load.f, load.n)
            out[:, i] = link.from_joint(total)
            for load in carried:
                if load.link == i:
                    out[:, i] += np.concatenate([load.f, load.n], axis=1)
        return out[..., :3], out[..., 3:]

    def _held_by(self, i: int) -> _Held:
        """What link i is one rigid body with, further out, and the moving joints that hang on that."""
        parents = [joint.parent for joint in self.model.joints]
        links = [
            k for k, link in enumerate(self.links) if link.joint == self.links[i].joint and i in self.model.path(k)
        ]
        hanging = [link.joint for k, link in enumerate(self.links) if not link.fixed and parents[k] in links]
        return _Held(links, hanging if self.links[i].fixed else [])

    def _rounding(self, record: _Record, motion: Motion, F: Array, loads: Sequence[Load]) -> dict[str, Array]:
        """What Pinocchio's formulas round beyond ours, and what moving payloads and forces between frames does."""
        out = rounding(self.pin_model, self.links, record.spatial, reach(self.joints, self.pin_model, motion))
        arms = [float(np.linalg.norm(link.p)) for link in self.links]
        for i, link in enumerate(self.links):
            if not link.fixed:
                continue
            held = self._held[i]
            if not held.hanging and not any(self.links[k].mass or self.links[k].inertia.any() for k in held.links):
                out["f"][:, i] = out["n"][:, i] = 0.0  # nothing but loads acts there
            # Forces go to the joint's origin and from there to the link's: their moments about both round.
            moved = [(arms[k] + float(np.linalg.norm(self.links[k].com)), F[:, k]) for k in held.links]
            moved += [(arms[load.link], load.f) for load in loads if load.link in held.links and load.link != i]
            for joint in held.hanging:
                p, f = record.hanging[:, self._hanging[joint], 3], record.spatial[:, 0, joint, :3]
                moved.append((np.linalg.norm(p, axis=-1), f))
            for arm, f in moved:
                out["n"][:, i] += OPERATIONS * EPS * (arms[i] + arm) * np.linalg.norm(f, axis=-1)
        return out


@dataclass(frozen=True, slots=True)
class _Held:
    """Links of one rigid body, by our index, and moving joints that hang on them, by Pinocchio's."""

    links: list[int]
    hanging: list[int]


@dataclass(slots=True)
class _Record:
    """What is kept of a batch.

    Attributes:
        tau: of every joint moving by itself, (N, nv).
        spatial: data.f, data.v, data.a_gf of each joint, linear before angular, (N, 3, njoints, 6).
        hanging: data.liMi of the joints that hang on fixed links: the columns of R, then p, (N, joints, 4, 3).
    """

    tau: Array
    spatial: Array
    hanging: Array
