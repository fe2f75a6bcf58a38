"""urdf2casadi: `URDFparser.get_inverse_dynamics_rnea`, of a chain."""

from __future__ import annotations

from typing import Any

import numpy as np
from door import Adapter, Robot, serve


class Urdf2casadi(Adapter):
    packages = ("urdf2casadi", "casadi")
    offers = frozenset({"prismatic"})
    call = "rnea = parser.get_inverse_dynamics_rnea(root, tip, gravity=g); rnea(q, v, a); many: rnea.map(N)"
    conventions = "a chain from the root to the last link"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from urdf2casadi import urdfparser

        parser = urdfparser.URDFparser({})
        parser.from_file(robot.path)
        tip = robot.links[-1]
        self.rnea = parser.get_inverse_dynamics_rnea(robot.root, tip, gravity=robot.gravity.tolist())
        self.names = list(parser.get_joint_info(robot.root, tip)[1])

    def run(self, inputs: Any) -> Any:
        return np.array(self.rnea(*(x.T for x in inputs))).T

    def many(self, inputs: Any) -> Any:
        return np.array(self.rnea.map(len(inputs[0]))(*(x.T for x in inputs))).T


if __name__ == "__main__":
    serve(Urdf2casadi)
