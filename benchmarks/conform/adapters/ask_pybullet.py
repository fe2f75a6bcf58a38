"""PyBullet: `calculateInverseDynamics`."""

from __future__ import annotations

from typing import Any

import numpy as np
from door import TREES, Adapter, Robot, serve


class PyBullet(Adapter):
    packages = ("pybullet",)
    offers = TREES
    call = "p.calculateInverseDynamics(body, q, v, a)"
    conventions = "useFixedBase, URDF_USE_INERTIA_FROM_FILE, setGravity; joints by name"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import pybullet

        self.library = pybullet
        pybullet.connect(pybullet.DIRECT)
        pybullet.setGravity(*robot.gravity.tolist())
        self.body = pybullet.loadURDF(robot.path, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        found = [pybullet.getJointInfo(self.body, k) for k in range(pybullet.getNumJoints(self.body))]
        self.names = [info[1].decode() for info in found if info[2] != pybullet.JOINT_FIXED]

    def inputs(self, states: Any) -> Any:
        return tuple(x.tolist() for x in super().inputs(states))

    def run(self, inputs: Any) -> Any:
        call, body = self.library.calculateInverseDynamics, self.body
        return np.array([call(body, q, v, a) for q, v, a in zip(*inputs, strict=True)])


if __name__ == "__main__":
    serve(PyBullet)
