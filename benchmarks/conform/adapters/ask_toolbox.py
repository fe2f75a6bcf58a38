"""Robotics Toolbox for Python: `Robot.rne`."""

from __future__ import annotations

from typing import Any

from door import TREES, Adapter, Robot, serve


class Toolbox(Adapter):
    packages = ("roboticstoolbox-python",)
    offers = TREES
    call = "Robot.URDF(path).rne(q, qd, qdd, gravity=gravity)"
    conventions = "joints in order of jindex, found by their child links"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from roboticstoolbox import Robot as Library

        self.library = Library.URDF(robot.path)
        links = sorted((link for link in self.library.links if link.isjoint), key=lambda link: link.jindex)
        self.names = [robot.carrier(link.name).name for link in links]

    def run(self, inputs: Any) -> Any:
        q, v, a = inputs
        tau = self.library.rne(q, v, a, gravity=self.robot.gravity)
        return tau.reshape(q.shape)


if __name__ == "__main__":
    serve(Toolbox)
