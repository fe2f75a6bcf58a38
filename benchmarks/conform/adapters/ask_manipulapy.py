"""ManipulaPy: `ManipulatorDynamics.inverse_dynamics`, of a chain."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from door import Adapter, Robot, States, serve


class ManipulaPy(Adapter):
    packages = ("ManipulaPy",)
    offers = frozenset({"prismatic", "payload"})
    call = "URDFToSerialManipulator(path).dynamics.inverse_dynamics(q, v, a, g, Ftip)"
    conventions = "payload as Ftip in the space frame, moment before force, by its own forward kinematics"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        os.environ["MANIPULAPY_QUIET"] = "1"
        from ManipulaPy.urdf_processor import URDFToSerialManipulator

        processor = URDFToSerialManipulator(robot.path)
        self.library = processor.dynamics
        self.names = list(processor.robot_data["joint_names"])

    def inputs(self, states: States) -> Any:
        tip = np.zeros(6)
        q, v, a = super().inputs(states)
        for load in states.payload:  # its Jacobian is that of the space frame
            T = np.asarray(self.library.forward_kinematics(q[0]))
            f = T[:3, :3] @ load.f[0]
            tip = np.array([*(T[:3, :3] @ load.n[0] + np.cross(T[:3, 3], f)), *f])
        return q, v, a, tip

    def run(self, inputs: Any) -> Any:
        q, v, a, tip = inputs
        gravity = self.robot.gravity.tolist()
        return np.array([self.library.inverse_dynamics(q[k], v[k], a[k], gravity, tip) for k in range(len(q))])


if __name__ == "__main__":
    serve(ManipulaPy)
