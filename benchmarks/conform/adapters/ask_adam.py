"""adam on JAX: tau = M(q) a + h(q, v), as it has no inverse dynamics with accelerations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Array, Robot, States, placements, serve
from jax_batch import JaxAdapter, as_real


class Adam(JaxAdapter):
    packages = ("adam-robotics", "jax")
    offers = TREES | {"floating"}
    call = "jit(vmap(lambda ...: kin.mass_matrix(H, q) @ a + kin.bias_force(H, q, base_v, v)))"
    conventions = "gravity passed, as its own is 9.80665; BODY_FIXED_REPRESENTATION"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import jax.numpy as jnp
        from adam import Representations
        from adam.jax import KinDynComputations

        self.names = [joint.name for joint in robot.moving]
        gravity = np.array([*robot.gravity, 0.0, 0.0, 0.0])
        kin = KinDynComputations(robot.text, self.names, dtype=jnp.dtype(real), gravity=gravity)
        kin.set_frame_velocity_representation(Representations.BODY_FIXED_REPRESENTATION)

        def one(H: Any, base_v: Any, q: Any, v: Any, all_a: Any) -> Any:
            return kin.mass_matrix(H, q) @ all_a + kin.bias_force(H, q, base_v, v)

        self.one = one

    def inputs(self, states: States) -> Any:
        at_q, at_v = self.robot.columns(self.names)
        H, base_v, base_a = np.tile(np.eye(4), (len(states), 1, 1)), *np.zeros((2, len(states), 6))
        if self.robot.floating:
            H, base_v, base_a = placements(states.q), states.v[:, :6], states.a[:, :6]
        a = np.hstack([base_a, states.a[:, at_v]])
        return as_real((H, base_v, states.q[:, at_q], states.v[:, at_v], a), self.real)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        raw = np.asarray(raw)
        return {"tau": self.torques(raw[:, 6:], raw[:, : 6 if self.robot.floating else 0])}


if __name__ == "__main__":
    serve(Adam)
