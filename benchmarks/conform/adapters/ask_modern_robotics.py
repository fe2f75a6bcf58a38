"""Modern Robotics (the book's library): `InverseDynamics`, of a chain."""

from __future__ import annotations

from typing import Any

import numpy as np
from chain import chain_of
from door import Adapter, Robot, States, serve


class ModernRobotics(Adapter):
    packages = ("modern-robotics",)
    offers = frozenset({"prismatic", "payload"})
    call = "mr.InverseDynamics(q, v, a, g, Ftip, Mlist, Glist, Slist)"
    conventions = (
        "it reads no URDF: Mlist, Glist, Slist are the adapter's, with frames at the centres of mass in the axes of "
        "<inertial>; payload as Ftip, moment before force"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import modern_robotics

        self.library, self.chain = modern_robotics, chain_of(robot)
        self.names = [joint.name for joint in robot.moving]

    def inputs(self, states: States) -> Any:
        tip = np.zeros(6)
        for load in states.payload:
            tip = np.array([*load.n[0], *load.f[0]])
        return (*super().inputs(states), tip)

    def run(self, inputs: Any) -> Any:
        q, v, a, tip = inputs
        rest = self.robot.gravity, tip, self.chain.M, self.chain.G, self.chain.S
        return np.array([self.library.InverseDynamics(q[k], v[k], a[k], *rest) for k in range(len(q))])


if __name__ == "__main__":
    serve(ModernRobotics)
