"""MJX (MuJoCo in JAX): `mjx.inverse`."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, ClassVar

import mujoco_model
import numpy as np
from door import TREES, Array, Robot, States, serve
from jax_batch import JaxAdapter, as_real

FLAGS = "--xla_cpu_use_fusion_emitters=false"
"""Without it XLA compiles MJX more slowly, to slower code."""


class Mjx(JaxAdapter):
    packages = ("mujoco-mjx", "mujoco", "jax")
    offers = TREES | {"floating", "armature", "damping"}
    words: ClassVar[Mapping[str, str]] = {"friction": mujoco_model.FRICTION}
    call = "jit(vmap(lambda data: mjx.inverse(model, data).qfrc_inverse))"
    conventions = mujoco_model.CONVENTIONS

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

    def inputs(self, states: States) -> Any:
        return as_real(mujoco_model.inputs(self.robot, self.names, states), self.real)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(*mujoco_model.base(self.robot, np.asarray(raw), states))}


if __name__ == "__main__":
    serve(Mjx)
