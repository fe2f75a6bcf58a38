"""The robot of a `mujoco.MjModel`, read through its attributes; bodies and joints keep their order.

| MuJoCo | ours |
|---|---|
| hinge, slide | revolute (continuous where it has no range), prismatic; the coordinate is `qpos`, `ref` included |
| free joint | floating: the twist in link axes, the quaternion (x, y, z, w) |
| several joints of one body, or one beside its origin | links without mass between |
| body without a joint | a link on a fixed joint |
| a linear joint equality | a joint that follows another, exactly |
| ball joint | none: refused |

A link's frame is that of its body. Forces that inverse dynamics of MuJoCo have and a tree of links has not (springs,
tendons, fluid, ...) are noted as left out. Contacts and limits act in some states alone, and are no part of a robot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import Vector, quaternion_rotation, rotation
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import JointEffects, Limits, Mimic
from rttrr_pin.core.joints import CONTINUOUS, FLOATING, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.errors import listed
from rttrr_pin.urdf.object_tree import ObjectTree, limit

FREE, BALL, SLIDE, HINGE = range(4)
"""`mjtJoint`."""

JOINT_EQUALITY = 2
"""`mjtEq`."""

LEFT_OUT = {
    "springs": ("jnt_stiffness", "jnt_stiffnesspoly"),
    "nonlinear damping": ("dof_dampingpoly",),
    "plastic joints, tendons or flexes": ("nplastic",),
    "forces of tendons": (
        "tendon_stiffness",
        "tendon_stiffnesspoly",
        "tendon_damping",
        "tendon_dampingpoly",
        "tendon_frictionloss",
        "tendon_armature",
    ),
    "armature and damping of actuators": ("actuator_armature", "actuator_damping", "actuator_dampingpoly"),
    "compensation of gravity": ("body_gravcomp",),
    "forces of plugins": ("nplugin",),
    "flexible bodies": ("nflex",),
}
"""What is left out where any of the numbers is not 0; not every version has all of them."""


def as_model(compiled: Any, library: Any, source: str) -> Model:
    """The robot.

    Args:
        compiled: a `mujoco.MjModel`.
        library: the module `mujoco`.
        source: what to call the model in messages.

    Raises:
        UrdfError: a joint has no counterpart, or numbers are none that a robot can have.
    """
    return _Reader(compiled, library, source).read()


def name_of(compiled: Any) -> str:
    """The model's name, which stands before all others."""
    name: bytes = compiled.names.split(b"\0", 1)[0]
    return name.decode(errors="replace")


class _Reader:
    def __init__(self, compiled: Any, library: Any, source: str) -> None:
        self.mj, self.library, self.tree = compiled, library, ObjectTree(source)
        self.links = {0: -1}
        """By MuJoCo's number of a body, its link."""
        self.joints: dict[int, int] = {}
        """By MuJoCo's number of a joint, ours."""

    def read(self) -> Model:
        mj, tree = self.mj, self.tree
        tree.root(mj.body(0).name or "world")
        for body in range(1, mj.nbody):
            self._body(body)
        followers = self._equalities()
        self._note_left_out(followers)
        gravity = np.zeros(3) if self._disabled("GRAVITY") else np.array(mj.opt.gravity)
        return tree.model(name_of(mj), gravity)

    def _disabled(self, flag: str) -> bool:
        bit = getattr(self.library.mjtDisableBit, f"mjDSBL_{flag}", None)
        if bit is None and flag in ("SPRING", "DAMPER"):  # one flag for both in older versions
            bit = getattr(self.library.mjtDisableBit, "mjDSBL_PASSIVE", None)
        return bit is not None and bool(self.mj.opt.disableflags & int(bit))

    def _body(self, b: int) -> None:
        """The joints that carry a body, in a row; then the body."""
        mj, tree = self.mj, self.tree
        name = mj.body(b).name
        parent, R, p = self.links[int(mj.body_parentid[b])], _rotation(mj.body_quat[b]), np.array(mj.body_pos[b])
        axes = _rotation(mj.body_iquat[b])
        tensor = axes @ np.diag(mj.body_inertia[b]) @ axes.T
        inertial = float(mj.body_mass[b]), np.array(mj.body_ipos[b]), (tensor + tensor.T) / 2
        joints = range(int(mj.body_jntadr[b]), int(mj.body_jntadr[b] + mj.body_jntnum[b]))
        for j in joints:
            joint_type, anchor = int(mj.jnt_type[j]), np.array(mj.jnt_pos[j])
            own = tree.name("joint", mj.joint(j).name, f"joint_{j}")
            if joint_type == FREE:  # its coordinates are those of the body in the world
                R, p, anchor = np.eye(3), np.zeros(3), np.zeros(3)
            elif joint_type == SLIDE:
                anchor = np.zeros(3)
            elif joint_type == BALL:
                raise tree.error(
                    "is a ball joint, which is none of our joint types: put three hinges in its place",
                    f'joint "{own}"',
                )
            R, p = self._at_zero(j, R, p + R @ anchor)
            last = j == joints[-1] and not anchor.any()
            parent = tree.add(
                joint=own,
                link=tree.name("link", name if last else own, f"body_{b}"),
                parent=parent,
                R=R,
                p=p,
                type=self._type(j),
                axis=mj.jnt_axis[j],
                inertial=inertial if last else None,
                limits=self._limits(j),
                effects=self._effects(j, own),
            )
            self.joints[j] = parent
            R, p = np.eye(3), -anchor
        if not joints or p.any():
            link = tree.name("link", name, f"body_{b}")
            fixed = tree.name("joint", f"{link}_fixed", f"body_{b}_fixed")
            parent = tree.add(fixed, link, parent, R, p, inertial=inertial)
        self.links[b] = parent

    def _at_zero(self, j: int, R: Array, p: Array) -> tuple[Array, Array]:
        """The placement of a joint where its coordinate is 0, from that where it is `ref`."""
        ref, axis = float(self.mj.qpos0[self.mj.jnt_qposadr[j]]), np.array(self.mj.jnt_axis[j])
        if self.mj.jnt_type[j] == FREE or ref == 0.0:
            return R, p
        if self.mj.jnt_type[j] == SLIDE:
            return R, p - R @ axis * ref
        return R @ rotation(Vector.of(axis), -ref, FLOAT.sincos).array, p

    def _type(self, j: int) -> Any:
        joint_type = int(self.mj.jnt_type[j])
        return {FREE: FLOATING, SLIDE: PRISMATIC}.get(joint_type, REVOLUTE if self.mj.jnt_limited[j] else CONTINUOUS)

    def _limits(self, j: int) -> Limits:
        mj = self.mj
        if mj.jnt_type[j] == FREE:
            return Limits()
        lower, upper = map(limit, mj.jnt_range[j]) if mj.jnt_limited[j] else (-math.inf, math.inf)
        effort = limit(np.abs(mj.jnt_actfrcrange[j]).max()) if mj.jnt_actfrclimited[j] else math.inf
        return Limits(lower, upper, effort=effort)

    def _effects(self, j: int, name: str) -> JointEffects:
        """Armature, damping and friction, each one number for all rates of a joint."""
        mj = self.mj
        first = int(mj.jnt_dofadr[j])
        at = slice(first, first + (6 if mj.jnt_type[j] == FREE else 1))
        values = {"armature": mj.dof_armature[at], "damping": mj.dof_damping[at], "friction": mj.dof_frictionloss[at]}
        for key, flag in (("damping", "DAMPER"), ("friction", "FRICTIONLOSS")):
            if self._disabled(flag):
                values[key] = np.zeros(1)
        for key, each in values.items():
            if len(set(each.tolist())) > 1:
                raise self.tree.error(
                    f"its {key} is {each.tolist()}: expected one number for all its rates", f'joint "{name}"'
                )
        return JointEffects(**{key: float(each[0]) for key, each in values.items()})

    def _equalities(self) -> list[str]:
        """Linear equalities of two joints become joints that follow others; their names."""
        mj, mimics = self.mj, dict[int, tuple[int, float, float]]()
        others = []
        for e in range(mj.neq):
            if not mj.eq_active0[e] or self._disabled("EQUALITY") or self._disabled("CONSTRAINT"):
                continue
            y, x, numbers = int(mj.eq_obj1id[e]), int(mj.eq_obj2id[e]), mj.eq_data[e]
            if self._follows(e) and y not in mimics and y not in _chain(mimics, x):
                y_0, x_0 = (float(mj.qpos0[mj.jnt_qposadr[j]]) for j in (y, x))
                mimics[y] = x, float(numbers[1]), y_0 + float(numbers[0]) - float(numbers[1]) * x_0
            else:
                others.append(mj.equality(e).name or f"number {e}")
        if others:
            self.tree.note(f"equality constraints are left out: {listed(others)}", left_out=True)
        for y in mimics:
            multiplier, offset, x = 1.0, 0.0, y
            chain = 0
            while x in mimics:
                x, ratio, shift = mimics[x]
                offset, multiplier, chain = offset + multiplier * shift, multiplier * ratio, chain + 1
            self.tree.follow(self.joints[y], Mimic(self.joints[x], multiplier, offset, rounded=chain > 1))
        return [mj.joint(y).name or f"number {y}" for y in mimics]

    def _follows(self, e: int) -> bool:
        """Whether an equality ties a hinge or slide to another by a straight line."""
        mj = self.mj
        if int(mj.eq_type[e]) != JOINT_EQUALITY or int(mj.eq_obj2id[e]) < 0 or mj.eq_data[e][2:5].any():
            return False
        return all(int(mj.jnt_type[int(j)]) in (SLIDE, HINGE) for j in (mj.eq_obj1id[e], mj.eq_obj2id[e]))

    def _note_left_out(self, followers: list[str]) -> None:
        mj, tree = self.mj, self.tree
        missing = [what for what, numbers in LEFT_OUT.items() if any(np.any(getattr(mj, key, 0)) for key in numbers)]
        if self._disabled("SPRING") and "springs" in missing:
            missing.remove("springs")
        if mj.opt.density or mj.opt.viscosity:
            missing.append("forces of the fluid around")
        if missing:
            tree.note(f"left out of tau, though MuJoCo's mj_inverse has it: {'; '.join(missing)}", left_out=True)
        tree.note_effects("MuJoCo's mj_inverse", left_out=True)
        if followers:
            tree.note(f"equality constraints let {listed(followers)} follow others: exactly, and without coordinates")
        if mj.nu:
            tree.note(f"actuators ({mj.nu}): tau is what the joints need (qfrc_inverse), before gears and gains")
        if mj.nmocap:
            moved = [mj.body(b).name for b in range(mj.nbody) if mj.body_mocapid[b] >= 0]
            tree.note(f"mocap bodies stand where the model has them: {listed(moved)}")


def _chain(mimics: dict[int, tuple[int, float, float]], x: int) -> Iterator[int]:
    """A joint, and those that it follows."""
    yield x
    while x in mimics:
        x = mimics[x][0]
        yield x


def _rotation(quaternion: Any) -> Array:
    """The rotation matrix of MuJoCo's quaternion (w, x, y, z), whatever its length."""
    w, x, y, z = np.array(quaternion, dtype=float) / np.linalg.norm(quaternion)
    return np.array(quaternion_rotation(float(x), float(y), float(z), float(w)).array) + 0.0
