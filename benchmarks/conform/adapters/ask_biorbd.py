"""biorbd (RBDL): `Model.InverseDynamics`."""

from __future__ import annotations

from typing import Any

import numpy as np
from door import TREES, Adapter, Robot, serve


class Biorbd(Adapter):
    packages = ("biorbd",)
    offers = TREES
    call = "model.InverseDynamics(q, v, a).to_array()"
    conventions = "coordinates by nameDof"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import biorbd

        self.model = biorbd.Model(robot.path)
        self.model.setGravity(robot.gravity)
        self.dofs = [name.to_string() for name in self.model.nameDof()]
        self.names = [next(j.name for j in robot.moving if j.name in dof or j.child in dof) for dof in self.dofs]

    def run(self, inputs: Any) -> Any:
        q, v, a = inputs
        return np.array([self.model.InverseDynamics(q[k], v[k], a[k]).to_array() for k in range(len(q))])


if __name__ == "__main__":
    serve(Biorbd)
