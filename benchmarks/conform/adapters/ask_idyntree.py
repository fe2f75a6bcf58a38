"""iDynTree: `KinDynComputations.inverseDynamics`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, Robot, States, placements, serve


class IDynTree(Adapter):
    packages = ("idyntree",)
    offers = TREES | {"floating", "payload"}
    call = "dyn.setRobotState(H, s, v, sdot, g); dyn.inverseDynamics(base_a, a, wrenches, out)"
    conventions = (
        "BODY_FIXED_REPRESENTATION; payload with the opposite sign; its binding has no internal wrenches of joints"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import idyntree.bindings as idt

        self.idt, loader = idt, idt.ModelLoader()
        if not loader.loadModelFromString(robot.text):
            raise ValueError("loadModelFromString returned False")
        self.dyn = dyn = idt.KinDynComputations()
        dyn.loadRobotModel(loader.model())
        dyn.setFloatingBase(robot.root)
        dyn.setFrameVelocityRepresentation(idt.BODY_FIXED_REPRESENTATION)
        self.model = dyn.model()
        joints = [j for j in range(self.model.getNrOfJoints()) if self.model.getJoint(j).getNrOfDOFs()]
        joints.sort(key=lambda j: self.model.getJoint(j).getDOFsOffset())
        self.names = [self.model.getJointName(j) for j in joints]
        self.external = idt.LinkWrenches(self.model)
        self.generalized = idt.FreeFloatingGeneralizedTorques(self.model)

    def inputs(self, states: States) -> Any:
        H, base_v, base_a = np.tile(np.eye(4), (len(states), 1, 1)), *np.zeros((2, len(states), 6))
        if self.robot.floating:
            H, base_v, base_a = placements(states.q), states.v[:, :6].copy(), states.a[:, :6].copy()
        self.external.zero()
        for load in states.payload:
            wrench = self.idt.Wrench()
            for i, x in enumerate((*-load.f[0], *-load.n[0])):
                wrench.setVal(i, float(x))
            self.external[self.model.getLinkIndex(load.link)] = wrench
        return (H, base_v, base_a, *super().inputs(states))

    def run(self, inputs: Any) -> Any:
        H, base_v, base_a, q, v, a = inputs
        gravity, out, bases = self.robot.gravity, np.empty_like(v), np.empty((len(v), 6))
        for k in range(len(q)):
            self.dyn.setRobotState(H[k], q[k], base_v[k], v[k], gravity)
            self.dyn.inverseDynamics(base_a[k], a[k], self.external, self.generalized)
            out[k] = self.generalized.jointTorques().toNumPy()
            bases[k] = self.generalized.baseWrench().toNumPy()
        return out, bases

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(raw[0], raw[1] if self.robot.floating else np.zeros((len(states), 0)))}


if __name__ == "__main__":
    serve(IDynTree)
