"""A JAX function in MuJoCo's coordinates, for MJX and Brax."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco_model
import numpy as np
from door import Array, States
from jax_batch import JaxAdapter, as_real


class MujocoJaxAdapter(JaxAdapter):
    """`names` are MuJoCo's joints in order; `one` is of qpos, qvel, qacc and gives generalised forces."""

    conventions = mujoco_model.CONVENTIONS
    names: list[str]

    def inputs(self, states: States) -> Any:
        return as_real(mujoco_model.inputs(self.robot, self.names, states), self.real)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(*mujoco_model.base(self.robot, np.asarray(raw), states))}
