"""Brax, generalized pipeline: tau = M a + bias, as it has no inverse dynamics with accelerations."""

from __future__ import annotations

from typing import Any

import mujoco_model
from door import TREES, Robot, serve
from mujoco_jax import MujocoJaxAdapter


class Brax(MujocoJaxAdapter):
    packages = ("brax", "mujoco", "jax")
    offers = TREES | {"floating", "armature"}
    call = "jit(vmap(lambda q, v, a: mass.matrix(sys, state) @ a + dynamics.inverse(sys, state)))"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from brax import kinematics
        from brax.generalized import dynamics, mass
        from brax.generalized.base import State
        from brax.io import mjcf

        model, self.names = mujoco_model.load(robot, fused=True)
        system = mjcf.load_model(model)

        def one(q: Any, v: Any, a: Any) -> Any:
            x, xd = kinematics.forward(system, q, v)
            state = State.init(q, v, x, xd)
            state = dynamics.transform_com(system, state)
            return mass.matrix(system, state) @ a + dynamics.inverse(system, state)

        self.one = one


if __name__ == "__main__":
    serve(Brax)
