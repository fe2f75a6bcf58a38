"""MuJoCo as most people call it: `mj_inverse` in a Python loop."""

from __future__ import annotations

import numpy as np
from mujoco_model import load
from protocol import Array, Job, Work, serve

MOST = 20_000


def prepare(job: Job) -> Work:
    import mujoco

    model, names = load(job)
    data = mujoco.MjData(model)
    q, v, a = job.columns(names)
    tau: Array = np.empty_like(v)

    def run() -> None:
        for k in range(len(q)):
            data.qpos, data.qvel, data.qacc = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            tau[k] = data.qfrc_inverse

    return Work(run, lambda: job.torques(names, tau), note=f"mj_inverse in a Python loop, first {len(q)} states")


if __name__ == "__main__":
    serve(["mujoco"], prepare, MOST)
