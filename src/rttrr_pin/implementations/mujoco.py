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
from functools import cached_property, partial
from typing import Any, NamedTuple

import mujoco
import numpy as np

from rttrr_pin.core.arrays import Array, norm, product
from rttrr_pin.core.conventions import convention
from rttrr_pin.core.joints import FLOATING, PLANAR
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations.allowance import add_inwards, levels, of_library
from rttrr_pin.implementations.library import LibraryJoint, Motion, driving_forces, own_states
from rttrr_pin.implementations.mujoco_model import PREFIX, build, mujoco_joints, own_refusal, rotation_of
from rttrr_pin.implementations.protocol import Batch, Evaluation

CONVENTION = convention("mujoco")
"""Of `cfrc_int`; the robot hangs on one body, so that C is the centre of mass of all."""

OPERATIONS = 4
"""Roundings in eps on the way of each term over one level: a quaternion product, its matrix, a sum."""

FIXED = 2
"""Levels that stand for what does not grow: lengths mended only beyond 1e-15, inertias turned, the way back."""


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
        self.axes = np.array([rotation_of(self.compiled.body_iquat[body]) for body in self.bodies]).reshape(-1, 3, 3)
        self.data = mujoco.MjData(self.compiled)

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """What MuJoCo makes of the file as it stands, which it has to compile once more for that."""
        refusal = own_refusal(self.model.urdf)
        return (f"MuJoCo itself refuses this file; placeholders were compiled. It says: {refusal}",) if refusal else ()

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n by MuJoCo."""
        turns: dict[int, Array] = {}  # by first rate of each planar or floating joint: from {i} to its frame at zero
        convert = partial(_in_slides, turns)
        states = own_states(self.model, batch)
        motion = Motion.of(self.joints, states, len(batch), self.compiled.nq, self.compiled.nv, convert)
        record = self._run(motion, batch.loads)
        moved = self._in_links(record.tau, turns)
        tau, tau_joint = driving_forces(self.model, self.joints, states, moved, has_armature=False)
        values = {"tau": tau} | self._wrenches(record)
        cancelling = _rounding(self.compiled, self.bodies, motion, record, batch.loads)
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

    def _wrenches(self, record: _Record) -> dict[str, Array]:
        """F, N: mass times acceleration of the centre of mass, and Euler's equation; f, n: what crosses each joint."""
        bodies, axes = self.bodies, self.axes
        turn, C = np.swapaxes(record.xmat[:, bodies], -1, -2), record.C[:, None]
        w, v = np.split(record.cvel[:, bodies], 2, axis=-1)
        w_dot, v_dot = np.split(record.cacc[:, bodies], 2, axis=-1)
        c = record.xipos[:, bodies] - C
        # cacc is a spatial acceleration, about C: w x v makes it that of the point at the centre of mass.
        at_com = v_dot + np.cross(w_dot, c) + np.cross(w, v + np.cross(w, c))
        F = self.compiled.body_mass[bodies, None] * product(turn, at_com)
        w, w_dot = (product(np.swapaxes(axes, -1, -2), product(turn, x)) for x in (w, w_dot))
        moments = self.compiled.body_inertia[bodies]
        N = product(axes, moments * w_dot + np.cross(w, moments * w))
        moment, force = np.split(record.cfrc_int[:, bodies], 2, axis=-1)
        f, n = CONVENTION.to_link(force, moment, record.xmat[:, bodies], C - record.xpos[:, bodies])
        return {"F": F, "N": N, "f": f, "n": n}


class _Record(NamedTuple):
    """What is kept of a batch, in world axes, by body."""

    tau: Array  # of every joint moving by itself, (N, nv)
    xpos: Array  # origins of the frames of the links, (N, bodies, 3)
    xipos: Array  # centres of mass, (N, bodies, 3)
    xmat: Array  # maps vectors of the links' frames to the world, (N, bodies, 3, 3)
    cvel: Array  # spatial velocities about C, angular before linear, (N, bodies, 6)
    cacc: Array  # spatial accelerations, with gravity, likewise
    cfrc_int: Array  # moment about C and force that cross the joint of each body, likewise
    C: Array  # the robot's centre of mass, (N, 3)


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


def _rounding(
    compiled: Any, bodies: Sequence[int], motion: Motion, record: _Record, loads: Sequence[Load]
) -> dict[str, Array]:
    """What rounds in MuJoCo's formulas and not in the recursion's: sizes times eps and operations, (N, links) each.

    MuJoCo computes in world axes, about one point C for the whole robot, its centre of mass.

    - Orientations are quaternions, multiplied up from the root. Each level turns by a rounded rotation, and the length
      is mended only where it is off by more than 1e-15, that is 4.5 eps, which counts twice in the matrix. So vectors
      that go from link to world and back, and every part that a link adds, are off by some eps for each level above.
    - Positions are world coordinates, added up from the root. A lever is the difference of two.
    - Velocities, accelerations and momenta are spatial, about C: of a link at a distance rho they contain w rho,
      w_dot rho, m rho^2 w_dot, v x m v, which cancel in the moment about the link's own origin.

    Sizes add up like the terms: outwards for velocities and accelerations, inwards for forces and moments. Levers count
    with all the lengths that they were added up from, and each link's part counts once for each level, and `FIXED`
    times more for what does not grow with the level.
    """
    parents = [-1, *compiled.body_parentid[1:]]
    w, v, w_dot, v_dot, rho = _outwards(compiled, motion, record)
    mass = np.abs(compiled.body_mass)
    arm = rho + norm(compiled.body_ipos)
    tensor = norm(compiled.body_inertia)
    turning = w_dot + w**2
    force = mass * (v_dot + w * v + arm * turning)
    own_moment = tensor * turning
    moment = own_moment + mass * (v**2 + arm * (v_dot + 2 * w * v) + arm**2 * turning)

    weight = OPERATIONS * EPS * (levels(parents) - 1 + FIXED)
    out = {"F": weight * force, "N": weight * own_moment}
    f, n = weight * force, weight * moment
    for load in loads:
        body, f_load, n_load = bodies[load.link], norm(np.atleast_2d(load.f)), norm(np.atleast_2d(load.n))
        f[:, body] += weight[body] * f_load
        n[:, body] += weight[body] * (n_load + arm[:, body] * f_load)
    add_inwards(parents, f.T, n.T, np.zeros_like(rho.T))  # all moments are about C
    return {key: x[:, bodies] for key, x in (out | {"f": f, "n": n + rho * f}).items()}


def _outwards(compiled: Any, motion: Motion, record: _Record) -> Array:
    """Sizes of what moves, terms added up in absolute value: w, v, w_dot, v_dot and rho, (5, N, bodies).

    v and v_dot are those of the body's velocity field at C, and rho is the length of the way from C over the world's
    origin to the body's frame.
    """
    sizes = np.zeros((5, len(motion.q), compiled.nbody))
    w, v, w_dot, v_dot, rho = sizes
    v_dot[:, 0] = norm(compiled.opt.gravity)
    rho[:, 0] = norm(record.C)
    rates, accelerations = (_by_body(compiled, x) for x in (motion.v, motion.a))
    for body in range(1, compiled.nbody):
        p = compiled.body_parentid[body]
        (slid, turned), (slid_a, turned_a) = rates[body], accelerations[body]
        rho[:, body] = rho[:, p] + norm(record.xpos[:, body] - record.xpos[:, p])
        w[:, body] = w[:, p] + turned
        v[:, body] = v[:, p] + slid + rho[:, body] * turned
        w_dot[:, body] = w_dot[:, p] + turned_a + w[:, body] * turned
        own = slid + rho[:, body] * turned
        v_dot[:, body] = v_dot[:, p] + slid_a + rho[:, body] * turned_a + w[:, body] * own + v[:, body] * turned
    return sizes


def _by_body(compiled: Any, x: Array) -> list[tuple[Array, Array]]:
    """The norms of what slides and of what turns, for each body, (N,) each."""
    slides = compiled.jnt_type[compiled.dof_jntid] == mujoco.mjtJoint.mjJNT_SLIDE
    of_bodies = [compiled.dof_bodyid == body for body in range(compiled.nbody)]
    return [(norm(x[:, of_body & slides]), norm(x[:, of_body & ~slides])) for of_body in of_bodies]
