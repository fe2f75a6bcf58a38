"""MuJoCo: each of the five quantities from MuJoCo's own numbers.

| quantity | from |
|---|---|
| tau | `mj_rne`, and `mj_applyFT` for payloads (J^T f) |
| f, n | `cfrc_int` of `mj_rnePostConstraint`, moved from the robot's centre of mass to the link's origin |
| F, N | `cacc`, `cvel`, mass and principal moments |

Both functions are asked directly: `mj_inverse` would add damping, friction, limits, contacts and armature, and leave
payloads out. Payloads enter `cfrc_int` as `xfrc_applied`, with the opposite sign: that is what the surroundings exert
on the robot, at the link's centre of mass, in world axes.

| joint | our q, v | MuJoCo's |
|---|---|---|
| continuous | angle | the same |
| planar | x, y, theta; twist in {i} | two slides and a hinge; slides along the joint frame at zero |
| floating | position, quaternion (x, y, z, w); twist in {i} | three slides likewise and a ball, (w, x, y, z) |
| one that follows another | none | its own |

Armature, damping and friction are added by the rule of `JointEffects`, as MuJoCo's own are other things: its friction
is a constraint that holds still what it can.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joints import FLOATING, PLANAR
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations.allowance import of_library
from rttrr_pin.implementations.library import LibraryJoint, Motion, joint_forces, product, reduce_forces
from rttrr_pin.implementations.mujoco_model import PREFIX, build, mujoco_joints, rotation_of
from rttrr_pin.implementations.mujoco_rounding import rounding
from rttrr_pin.implementations.protocol import Batch, Evaluation


class Mujoco:
    """MuJoCo's recursive Newton-Euler on the model that MuJoCo read from the same text."""

    name = "mujoco"
    version: str = mujoco.__version__
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        """Build MuJoCo's model, and hold it against what the file says.

        Raises:
            ImplementationError: the model has no URDF text, or MuJoCo refuses it.
            ModelMismatchError: MuJoCo read something else.
        """
        self.model = model
        self.compiled = build(model)
        self.joints = mujoco_joints(model, self.compiled)
        self.bodies = [self.compiled.body(PREFIX + name).id for name in model.link_names]
        self.data = mujoco.MjData(self.compiled)

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n by MuJoCo."""
        turns: dict[int, Array] = {}  # by first rate of each planar or floating joint: from {i} to its frame at zero
        convert = partial(_in_slides, turns)
        motion = Motion.of(self.joints, batch, self.compiled.nq, self.compiled.nv, convert)
        record = self._run(motion, batch.loads)
        F, N = self._net(record)
        f, n = self._across_joints(record)
        own = joint_forces(self.joints, batch, self.compiled.nv)
        whole = self._in_links(record.tau, turns) + own
        tau, tau_joint = (reduce_forces(self.model, self.joints, x) for x in (whole, own))
        values = {"tau": tau, "F": F, "N": N, "f": f, "n": n}
        cancelling = self._rounding(record, motion, batch.loads)
        return Evaluation(values, of_library(batch, values, tau_joint, cancelling), tau_joint)

    def _run(self, motion: Motion, loads: Sequence[Load]) -> _Record:
        """Call MuJoCo on each state and keep what it leaves in `data`, which the next call overwrites."""
        model, data, rows = self.compiled, self.data, len(motion.q)
        names = ("xpos", "xipos", "xmat", "cvel", "cacc", "cfrc_int")
        views = [getattr(data, name).reshape(-1) for name in names] + [data.subtree_com[1]]
        kept = np.empty((rows, sum(view.size for view in views)))
        tau = np.zeros((rows, model.nv))
        acting = [(self.bodies[x.link], x.in_base, *(np.broadcast_to(y, (rows, 3)) for y in (x.f, x.n))) for x in loads]
        for k in range(rows):
            data.qpos, data.qvel, data.qacc = motion.q[k], motion.v[k], motion.a[k]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, tau[k])
            data.xfrc_applied[:] = 0.0
            for body, in_base, f, n in acting:
                self._apply(body, f[k], n[k], in_base, tau[k])
            mujoco.mj_rnePostConstraint(model, data)
            np.concatenate(views, out=kept[k])
        cut = np.split(kept, np.cumsum([view.size for view in views])[:-1], axis=1)
        xpos, xipos, xmat, cvel, cacc, cfrc_int = (x.reshape(rows, model.nbody, -1) for x in cut[:-1])
        return _Record(tau, xpos, xipos, xmat.reshape(rows, -1, 3, 3), cvel, cacc, cfrc_int, C=cut[-1])

    def _apply(self, body: int, f: Array, n: Array, in_base: bool, tau: Array) -> None:
        """A payload: minus it acts on the robot, at the centre of mass, in world axes; tau takes J^T of it."""
        data = self.data
        if not in_base:
            turn = data.xmat[body].reshape(3, 3)
            f, n = turn @ f, turn @ n
        moment = n + np.cross(data.xpos[body] - data.xipos[body], f)
        data.xfrc_applied[body, :3] -= f
        data.xfrc_applied[body, 3:] -= moment
        mujoco.mj_applyFT(self.compiled, data, f, n, data.xpos[body], body, tau)

    def _in_links(self, tau: Array, turns: dict[int, Array]) -> Array:
        """MuJoCo's generalised forces as components of f and n in {i}."""
        out = tau.copy()
        for joint in self.joints:
            if joint.v.start in turns:
                slides = slice(joint.v.start, joint.v.start + joint.joint.type.rotations.index(True))
                back = np.swapaxes(turns[joint.v.start], 1, 2)
                out[:, slides] = product(back, _in_space(tau[:, slides]))[:, : slides.stop - slides.start]
        return out

    def _net(self, record: _Record) -> tuple[Array, Array]:
        """F, N: mass times acceleration of the centre of mass, and Euler's equation about it."""
        F, N = (np.empty((len(record.tau), len(self.bodies), 3)) for _ in "FN")
        for i, body in enumerate(self.bodies):
            turn = np.swapaxes(record.xmat[:, body], 1, 2)
            w, v = np.split(record.cvel[:, body], 2, axis=-1)
            w_dot, v_dot = np.split(record.cacc[:, body], 2, axis=-1)
            c = record.xipos[:, body] - record.C
            # cacc is a spatial acceleration, about C: w x v makes it that of the point at the centre of mass.
            at_com = v_dot + np.cross(w_dot, c) + np.cross(w, v + np.cross(w, c))
            F[:, i] = self.compiled.body_mass[body] * product(turn, at_com)
            axes = rotation_of(self.compiled.body_iquat[body])
            w, w_dot = (product(axes.T, product(turn, x)) for x in (w, w_dot))
            moments = self.compiled.body_inertia[body]
            N[:, i] = product(axes, moments * w_dot + np.cross(w, moments * w))
        return F, N

    def _across_joints(self, record: _Record) -> tuple[Array, Array]:
        """f, n: what crosses each joint, moving or fixed."""
        f, n = (np.empty((len(record.tau), len(self.bodies), 3)) for _ in "fn")
        for i, body in enumerate(self.bodies):
            moment, force = np.split(record.cfrc_int[:, body], 2, axis=-1)
            turn = np.swapaxes(record.xmat[:, body], 1, 2)
            f[:, i] = product(turn, force)
            n[:, i] = product(turn, moment + np.cross(record.C - record.xpos[:, body], force))
        return f, n

    def _rounding(self, record: _Record, motion: Motion, loads: Sequence[Load]) -> dict[str, Array]:
        """What MuJoCo's formulas round beyond ours, of each link."""
        sizes: dict[int, Array] = {}
        for load in loads:
            size = np.stack([np.broadcast_to(np.linalg.norm(x, axis=-1), len(motion.q)) for x in (load.f, load.n)], 1)
            sizes[self.bodies[load.link]] = sizes.get(self.bodies[load.link], 0.0) + size
        out = rounding(self.compiled, motion.v, motion.a, record.xpos, record.C, sizes)
        return {key: x[:, self.bodies] for key, x in out.items()}


@dataclass(slots=True)
class _Record:
    """What is kept of a batch, in world axes, by body.

    Attributes:
        tau: of every joint moving by itself, (N, nv).
        xpos: origins of the frames of the links, (N, bodies, 3).
        xipos: centres of mass, (N, bodies, 3).
        xmat: maps vectors of the links' frames to the world, (N, bodies, 3, 3).
        cvel: spatial velocities about C, angular before linear, (N, bodies, 6).
        cacc: spatial accelerations, with gravity, likewise.
        cfrc_int: moment about C and force that cross the joint of each body, likewise.
        C: the robot's centre of mass, (N, 3).
    """

    tau: Array
    xpos: Array
    xipos: Array
    xmat: Array
    cvel: Array
    cacc: Array
    cfrc_int: Array
    C: Array


def _in_slides(
    turns: dict[int, Array], joint: LibraryJoint, q: Array, v: Array, a: Array
) -> tuple[Array, Array, Array]:
    """Our coordinates of a joint as MuJoCo's; the rotation R of a planar or floating one, (N, 3, 3), goes to `turns`.

    Their rates and accelerations have the linear part along the frame at zero: R v and R (a + w x v).
    """
    if joint.joint.type == PLANAR:
        half, none = q[:, 2] / 2, 0 * q[:, 2]
        quaternions, w = np.stack([np.cos(half), none, none, np.sin(half)], axis=1), np.pad(v[:, 2:], ((0, 0), (2, 0)))
    elif joint.joint.type == FLOATING:
        q = q[:, [0, 1, 2, 6, 3, 4, 5]]
        quaternions, w = q[:, 3:], v[:, 3:]
    else:
        return q, v, a
    turn = turns[joint.v.start] = np.array([rotation_of(x) for x in quaternions]).reshape(-1, 3, 3)
    linear = joint.joint.type.rotations.index(True)
    v_l, a_l = _in_space(v[:, :linear]), _in_space(a[:, :linear])
    v_out, a_out = (product(turn, x)[:, :linear] for x in (v_l, a_l + np.cross(w, v_l)))
    return q, np.hstack([v_out, v[:, linear:]]), np.hstack([a_out, a[:, linear:]])


def _in_space(x: Array) -> Array:
    """Vectors of the plane or of space, (N, 2) or (N, 3), in space."""
    return np.pad(x, ((0, 0), (0, 3 - x.shape[1])))
