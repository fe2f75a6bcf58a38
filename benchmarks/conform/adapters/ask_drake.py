"""Drake: `MultibodyPlant.CalcInverseDynamics`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, Robot, States, back, in_world, serve


class Drake(Adapter):
    packages = ("drake",)
    offers = TREES | {"floating", "payload", "damping"}
    call = "plant.CalcForceElementsContribution(context, forces); plant.CalcInverseDynamics(context, a, forces)"
    conventions = (
        "base welded to the world, or quaternion (w, x, y, z) before position and velocity in world axes, angular "
        "before linear; payload by AddInForce with the opposite sign"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from pydrake.multibody.math import SpatialForce
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import MultibodyPlant
        from pydrake.multibody.tree import MultibodyForces

        self.SpatialForce = SpatialForce
        self.plant = plant = MultibodyPlant(0.0)
        (model,) = Parser(plant).AddModelsFromString(robot.text, "urdf")
        if not robot.floating:
            plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(robot.root))
        plant.mutable_gravity_field().set_gravity_vector(robot.gravity)
        plant.Finalize()
        self.context, self.forces = plant.CreateDefaultContext(), MultibodyForces(plant)
        joints = [plant.get_joint(k) for k in plant.GetJointIndices(model)]
        moving = sorted((x for x in joints if x.num_velocities() == 1), key=lambda joint: joint.velocity_start())
        self.names = [joint.name() for joint in moving]

    def inputs(self, states: States) -> Any:
        at_q, at_v = self.robot.columns(self.names)
        q, v, a = states.q[:, at_q], states.v[:, at_v], states.a[:, at_v]
        if self.robot.floating:
            _, v_world, w, v_dot, w_dot = in_world(states)
            q = np.hstack([states.q[:, [6, 3, 4, 5, 0, 1, 2]], q])
            v, a = np.hstack([w, v_world, v]), np.hstack([w_dot, v_dot, a])
        return np.hstack([q, v]), a, states.payload

    def run(self, inputs: Any) -> Any:
        qv, a, payload = inputs
        plant, context, forces, out = self.plant, self.context, self.forces, np.empty_like(a)
        for k in range(len(a)):
            plant.SetPositionsAndVelocities(context, qv[k])
            plant.CalcForceElementsContribution(context, forces)  # gravity
            for load in payload:
                body, exerted = plant.GetBodyByName(load.link), self.SpatialForce(-load.n[0], -load.f[0])
                body.AddInForce(context, np.zeros(3), exerted, body.body_frame(), forces)
            out[k] = plant.CalcInverseDynamics(context, a[k], forces)
        return out

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        base = np.zeros((len(raw), 0))
        if self.robot.floating:
            R = in_world(states)[0]
            base = np.hstack([back(R, raw[:, 3:6]), back(R, raw[:, :3])])
        return {"tau": self.torques(raw[:, raw.shape[1] - len(self.names) :], base)}


if __name__ == "__main__":
    serve(Drake)
