"""Brax, generalized pipeline: tau = M a + bias, as it has no inverse dynamics with accelerations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco_model
import numpy as np
from door import TREES, Array, Robot, States, serve
from jax_batch import JaxAdapter, as_real


class Brax(JaxAdapter):
    packages = ("brax", "mujoco", "jax")
    offers = TREES | {"floating", "armature"}
    call = "jit(vmap(lambda q, v, a: mass.matrix(sys, state) @ a + dynamics.inverse(sys, state)))"
    conventions = mujoco_model.CONVENTIONS

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

    def inputs(self, states: States) -> Any:
        return as_real(mujoco_model.inputs(self.robot, self.names, states), self.real)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(*mujoco_model.base(self.robot, np.asarray(raw), states))}


if __name__ == "__main__":
    serve(Brax)
