"""The robot as MuJoCo reads it, for MuJoCo, MJX and MuJoCo Warp."""

from __future__ import annotations

from typing import Any

import numpy as np
from door import Array, Robot, States, back, in_world

CONVENTIONS = (
    "root link as a body of its own, welded to the world or on a free joint: quaternion (w, x, y, z), velocity of its "
    "origin in world axes; limits off, as inverse dynamics else adds their forces"
)

FRICTION = (
    "Coulomb friction as a force of joints: frictionloss is a constraint, whose sign follows the acceleration as well"
)


def load(robot: Robot, fused: bool = False) -> tuple[Any, list[str]]:
    """MuJoCo's model, and the names of its joints in order."""
    import mujoco

    spec = mujoco.MjSpec.from_string(robot.text)
    spec.compiler.fusestatic = fused
    spec.option.gravity = robot.gravity
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    if robot.floating:
        spec.body(robot.root).add_freejoint()
    model = spec.compile()
    names = [model.joint(k).name for k in range(int(robot.floating), model.njnt)]
    for name in names:
        model.dof_armature[model.joint(name).dofadr] = robot.joint(name).armature
    return model, names


def inputs(robot: Robot, names: list[str], states: States) -> tuple[Array, Array, Array]:
    """qpos, qvel, qacc."""
    at_q, at_v = robot.columns(names)
    q, v, a = states.q[:, at_q], states.v[:, at_v], states.a[:, at_v]
    if robot.floating:
        _, v_world, _, v_dot, _ = in_world(states)
        q = np.hstack([states.q[:, [0, 1, 2, 6, 3, 4, 5]], q])
        v, a = np.hstack([v_world, states.v[:, 3:6], v]), np.hstack([v_dot, states.a[:, 3:6], a])
    return q, v, a


def base(robot: Robot, forces: Array, states: States) -> tuple[Array, Array]:
    """Tau of the joints, and of the base in its axes, from generalised forces."""
    if not robot.floating:
        return forces, np.zeros((len(forces), 0))
    R = in_world(states)[0]
    return forces[:, 6:], np.hstack([back(R, forces[:, :3]), forces[:, 3:6]])
