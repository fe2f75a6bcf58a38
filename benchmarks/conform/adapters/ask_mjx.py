"""MJX (MuJoCo in JAX): `mjx.inverse`."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, ClassVar

import mujoco_model
from door import TREES, Robot, serve
from mujoco_jax import MujocoJaxAdapter

FLAGS = "--xla_cpu_use_fusion_emitters=false"
"""Without it XLA compiles MJX more slowly, to slower code."""


class Mjx(MujocoJaxAdapter):
    packages = ("mujoco-mjx", "mujoco", "jax")
    offers = TREES | {"floating", "armature", "damping"}
    words: ClassVar[Mapping[str, str]] = {"friction": mujoco_model.FRICTION}
    call = "jit(vmap(lambda data: mjx.inverse(model, data).qfrc_inverse))"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        os.environ["XLA_FLAGS"] = FLAGS
        from mujoco import mjx

        model, self.names = mujoco_model.load(robot)
        put = mjx.put_model(model)
        blank = mjx.make_data(put)

        def one(q: Any, v: Any, a: Any) -> Any:
            return mjx.inverse(put, blank.replace(qpos=q, qvel=v, qacc=a)).qfrc_inverse

        self.one = one


if __name__ == "__main__":
    serve(Mjx)
