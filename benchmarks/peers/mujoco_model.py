"""The robot as MuJoCo reads it, with nothing in it but rigid bodies, joints and gravity."""

from __future__ import annotations

from typing import Any

from protocol import Job


def load(job: Job) -> tuple[Any, list[str]]:
    """MuJoCo's model and the names of its joints in order."""
    import mujoco

    spec = mujoco.MjSpec.from_string(job.bare_urdf())
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.option.gravity = job.gravity
    off = mujoco.mjtDisableBit
    spec.option.disableflags |= off.mjDSBL_CONSTRAINT | off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_ACTUATION
    model = spec.compile()
    model.dof_damping[:] = model.dof_frictionloss[:] = model.dof_armature[:] = 0.0
    model.jnt_stiffness[:] = 0.0
    return model, [model.joint(k).name for k in range(model.njnt)]
