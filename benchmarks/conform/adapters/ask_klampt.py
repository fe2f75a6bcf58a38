"""Klampt: `RobotModel.torquesFromAccel`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, Robot, States, serve


class Klampt(Adapter):
    packages = ("Klampt",)
    offers = TREES
    call = "robot.setConfig(q); robot.setVelocity(v); robot.torquesFromAccel(a) + robot.getGravityForces(g)"
    conventions = "configuration by link, those of fixed joints and of the base at zero; links found by name"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from klampt import WorldModel

        self.world = WorldModel()
        self.library = self.world.loadRobot(robot.path)
        if self.library is None or self.library.index < 0:
            raise ValueError("WorldModel.loadRobot failed")
        links = [self.library.link(k).getName() for k in range(self.library.numLinks())]
        self.names = [joint.name for joint in robot.moving]
        self.at = [links.index(joint.child) for joint in robot.moving]

    def inputs(self, states: States) -> Any:
        wide = [np.zeros((len(states), self.library.numLinks())) for _ in range(3)]
        for x, own in zip(wide, super().inputs(states), strict=True):
            x[:, self.at] = own
        return [[row.tolist() for row in x] for x in wide]

    def run(self, inputs: Any) -> Any:
        library, gravity, out = self.library, self.robot.gravity.tolist(), []
        for q, v, a in zip(*inputs, strict=True):
            library.setConfig(q)
            library.setVelocity(v)
            out.append(np.add(library.torquesFromAccel(a), library.getGravityForces(gravity)))
        return np.array(out)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(raw[:, self.at], np.zeros((len(raw), 0)))}


if __name__ == "__main__":
    serve(Klampt)
