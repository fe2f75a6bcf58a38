"""Newton: `eval_inverse_dynamics_passive` and `eval_inverse_dynamics_force`, on the processor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, Robot, States, serve


class Newton(Adapter):
    packages = ("newton", "warp-lang")
    offers = TREES | {"armature"}
    call = "newton.eval_fk; newton.eval_inverse_dynamics_passive; newton.eval_inverse_dynamics_force"
    conventions = (
        "joints by label; many states as worlds; a floating base is driven at its centre of mass: not converted"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import newton
        import warp

        if real is not np.float32:
            raise ValueError("Newton computes in float32 alone")
        warp.config.quiet = True
        self.newton, self.warp, self.worlds = newton, warp, 0
        self._build(1)
        labels = list(self.model.joint_label)
        starts = self.model.joint_qd_start.numpy()
        own = [(int(starts[j]), label.split("/")[-1]) for j, label in enumerate(labels)]
        moving = {joint.name for joint in robot.moving}
        self.names = [name for _, name in sorted(own) if name in moving]

    def _build(self, worlds: int) -> None:
        """The model with the robot in each of many worlds."""
        newton, warp, robot = self.newton, self.warp, self.robot
        one = newton.ModelBuilder(gravity=tuple(robot.gravity.tolist()))
        one.add_urdf(robot.text, floating=robot.floating)
        if worlds > 1:
            many = newton.ModelBuilder(gravity=tuple(robot.gravity.tolist()))
            many.replicate(one, worlds)
            one = many
        self.model, self.worlds = one.finalize(device="cpu"), worlds
        self.state = self.model.state()
        count, dofs = self.model.articulation_count, self.model.max_dofs_per_articulation
        self.M = warp.zeros((count, dofs, dofs), dtype=warp.float32, device="cpu")
        self.out = [warp.zeros(self.model.joint_dof_count, dtype=warp.float32, device="cpu") for _ in range(3)]

    def inputs(self, states: States) -> Any:
        if len(states) != self.worlds:
            self._build(len(states))
        wrap = self.warp.array
        return tuple(wrap(x.reshape(-1), dtype=self.warp.float32, device="cpu") for x in super().inputs(states))

    def run(self, inputs: Any) -> Any:
        q, v, a = inputs
        newton, model, state, (gravity, coriolis, tau) = self.newton, self.model, self.state, self.out
        newton.eval_fk(model, q, v, state)
        state.joint_q.assign(q)
        state.joint_qd.assign(v)
        newton.eval_inverse_dynamics_passive(
            model, state, mass_matrix=self.M, gravity_force=gravity, coriolis_force=coriolis
        )
        newton.eval_inverse_dynamics_force(
            model, state, mass_matrix=self.M, joint_qdd=a, coriolis_force=coriolis, gravity_force=gravity, joint_f=tau
        )
        return tau.numpy().reshape(self.worlds, -1)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(np.asarray(raw, np.float64), np.zeros((len(states), 0)))}


if __name__ == "__main__":
    serve(Newton)
