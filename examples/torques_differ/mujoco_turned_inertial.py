"""MuJoCo before 3.14, `mj_inverse` of a URDF: the `rpy` of `<inertial><origin>` is lost, without a word.

    pip install mujoco==3.13.0

Threads: google-deepmind/mujoco#3559, mended by #3560. Six decimals are written: MuJoCo before 3.14 finds principal axes
to about nine digits.
"""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from table import Array, States, main


def torques(file: str, states: States) -> dict[str, Array]:
    model = mujoco.MjModel.from_xml_string(Path(file).read_text())
    model.opt.gravity = [0.0, 0.0, -9.81]
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT  # the limits of joints push back
    data = mujoco.MjData(model)
    joints = [model.joint(k).name for k in range(model.njnt)]
    q, v, a = (np.column_stack([states[f"{letter}_{joint}"] for joint in joints]) for letter in "qva")
    tau = np.empty_like(v)
    for k in range(len(q)):
        data.qpos, data.qvel, data.qacc = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        tau[k] = data.qfrc_inverse
    return dict(zip(joints, tau.T, strict=True))


if __name__ == "__main__":
    main(torques, form=".6f")
