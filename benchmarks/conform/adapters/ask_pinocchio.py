"""Pinocchio: `rnea`, and `rneaInParallel` for many states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, Robot, States, serve


class Pinocchio(Adapter):
    packages = ("pin",)
    offers = TREES | {"floating", "mimic", "payload", "armature"}
    call = "pin.rnea(model, data, q, v, a, fext); many: pin.rneaInParallel"
    conventions = (
        "continuous joints as (cos, sin); payload as minus fext, at the joint; f, n from data.f, of fixed joints from "
        "computeSupportedForceByFrame"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import pinocchio as pin

        self.pin = pin
        root = (pin.JointModelFreeFlyer(), robot.joints[0].name) if robot.floating else ()
        follows = any(joint.follows for joint in robot.joints)
        self.model = pin.buildModelFromXML(robot.text, *root, **({"mimic": True} if follows else {}))
        self.model.gravity.linear = robot.gravity
        self.data = self.model.createData()
        self.pool = pin.ModelPool(self.model, 1)
        self.moving = [j for j in range(1, self.model.njoints) if self.model.nvs[j] and not self._follows(j)]
        self.joints = [robot.joint(self.model.names[j]) for j in self.moving]
        for j, joint in zip(self.moving, self.joints, strict=True):
            self.model.armature[self._v(j)] = joint.armature

    def _follows(self, j: int) -> bool:
        return self.model.joints[j].shortname().startswith("JointModelMimic")

    def _v(self, j: int) -> slice:
        return slice(self.model.idx_vs[j], self.model.idx_vs[j] + self.model.nvs[j])

    def inputs(self, states: States) -> Any:
        q, v, a = np.zeros((len(states), self.model.nq)), *(np.zeros((2, len(states), self.model.nv)))
        for j, joint in zip(self.moving, self.joints, strict=True):
            at, x = self.model.idx_qs[j], states.q[:, joint.q]
            own = np.hstack([np.cos(x), np.sin(x)]) if joint.type == "continuous" else x
            q[:, at : at + own.shape[1]] = own
            v[:, self._v(j)], a[:, self._v(j)] = states.v[:, joint.v], states.a[:, joint.v]
        forces = None
        if states.payload:
            forces = [self.pin.Force.Zero() for _ in range(self.model.njoints)]
            for load in states.payload:
                frame = self.model.frames[self.model.getFrameId(load.link)]
                forces[frame.parentJoint] -= frame.placement.act(self.pin.Force(load.f[0], load.n[0]))
        return q, v, a, forces

    def run(self, inputs: Any) -> Any:
        q, v, a, forces = inputs
        rest = () if forces is None else (forces,)
        return np.array([self.pin.rnea(self.model, self.data, q[k], v[k], a[k], *rest) for k in range(len(q))])

    def many(self, inputs: Any) -> Any:
        q, v, a = (x.T for x in inputs[:3])  # Fortran-ordered (n, N)
        return self.pin.rneaInParallel(1, self.pool, q, v, a, np.zeros_like(v, order="F"))

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        tau = np.zeros((len(states), self.robot.nv))
        for j, joint in zip(self.moving, self.joints, strict=True):
            tau[:, joint.v] = raw[:, self._v(j)]
        if len(states) > 1:
            return {"tau": tau}
        f, n = np.zeros((2, 1, len(self.robot.links), 3))
        for i, joint in enumerate(self.robot.joints):
            force = self._across(joint.name, joint.child, states)
            f[0, i], n[0, i] = force.linear, force.angular
        return {"tau": tau, "f": f, "n": n}

    def _across(self, joint: str, link: str, states: States) -> Any:
        """What crosses a joint, in the frame of its link."""
        if self.model.existJointName(joint):
            return self.data.f[self.model.getJointId(joint)]
        q, v, a, forces = self.inputs(states)
        self.pin.forwardKinematics(self.model, self.data, q[0], v[0], a[0])
        self.pin.rnea(self.model, self.data, q[0], v[0], a[0], *(() if forces is None else (forces,)))
        return self.pin.computeSupportedForceByFrame(self.model, self.data, self.model.getFrameId(link))


if __name__ == "__main__":
    serve(Pinocchio)
