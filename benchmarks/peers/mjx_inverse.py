"""MJX (MuJoCo in JAX): kinematics, centres of mass, velocities, `rne`, on the processor."""

from __future__ import annotations

from typing import Any

import jax_batch
from mujoco_model import load
from protocol import Job, Work, serve

FLAGS = "--xla_cpu_use_fusion_emitters=false"
"""Without it XLA compiles MJX more slowly, to code that was 20 times slower on UR5 (jax 0.10.2)."""


def prepare(job: Job) -> Work:
    jax_batch.start(FLAGS)
    from mujoco import mjx
    from mujoco.mjx._src import smooth

    model, names = load(job)
    put = mjx.put_model(model)
    blank = mjx.make_data(put)

    def rnea(q: Any, v: Any, a: Any) -> Any:
        data = blank.replace(qpos=q, qvel=v, qacc=a)
        for stage in (smooth.kinematics, smooth.com_pos, smooth.com_vel):
            data = stage(put, data)
        return smooth.rne(put, data, flg_acc=True).qfrc_bias

    return jax_batch.work(job, rnea, names, "kinematics, com_pos, com_vel, rne")


if __name__ == "__main__":
    serve(["mujoco-mjx", "mujoco"], prepare, jax_batch.MOST)
