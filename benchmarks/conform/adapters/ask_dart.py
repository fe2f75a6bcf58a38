"""DART (dartpy): `Skeleton.computeInverseDynamics`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, Robot, States, back, in_world, placements, serve


class Dart(Adapter):
    packages = ("dartpy",)
    offers = TREES | {"floating", "payload", "damping"}
    call = "skel.setPositions/Velocities/Accelerations; skel.computeInverseDynamics(True, True); skel.getForces()"
    conventions = (
        "FreeJoint or WeldJoint at the root by DartLoaderRootJointType; base as (rotation vector, position), rates in "
        "world axes, angular before linear; payload by addExtForce and addExtTorque with the opposite sign; f, n "
        "from getBodyForce"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import dartpy

        loader, options = dartpy.utils.DartLoader(), dartpy.utils.DartLoaderOptions()
        kind = dartpy.utils.DartLoaderRootJointType
        options.mDefaultRootJointType = kind.FLOATING if robot.floating else kind.FIXED
        loader.setOptions(options)
        self.skel = loader.parseSkeleton(robot.path)
        if self.skel is None:
            raise ValueError("parseSkeleton returned None")
        self.skel.setGravity(robot.gravity)
        self.free = dartpy.dynamics.FreeJoint
        first = 6 if robot.floating else 0
        dofs = [self.skel.getDof(k) for k in range(first, self.skel.getNumDofs())]
        self.names = [dof.getName() for dof in dofs]

    def inputs(self, states: States) -> Any:
        q, v, a = super().inputs(states)
        if self.robot.floating:
            q = np.hstack([[self.free.convertToPositions(H) for H in self._isometries(states)], q])
            _, v_world, w, v_dot, w_dot = in_world(states)
            v, a = np.hstack([w, v_world, v]), np.hstack([w_dot, v_dot, a])
        self.skel.clearExternalForces()
        for load in states.payload:
            body = self.skel.getBodyNode(load.link)
            body.addExtForce(-load.f[0], np.zeros(3), True, True)
            body.addExtTorque(-load.n[0], True)
        return q, v, a

    def _isometries(self, states: States) -> list[Any]:
        import dartpy

        return [dartpy.math.Isometry3(H) for H in placements(states.q)]

    def run(self, inputs: Any) -> Any:
        q, v, a = inputs
        skel, out = self.skel, np.empty_like(v)
        for k in range(len(q)):
            skel.setPositions(q[k])
            skel.setVelocities(v[k])
            skel.setAccelerations(a[k])
            skel.computeInverseDynamics(True, True)
            out[k] = skel.getForces()
        return out

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        base = np.zeros((len(raw), 0))
        if self.robot.floating:
            R = in_world(states)[0]
            base = np.hstack([back(R, raw[:, 3:6]), back(R, raw[:, :3])])
        out = {"tau": self.torques(raw[:, base.shape[1] :], base)}
        if len(states) > 1:
            return out
        forces = np.array([self.skel.getBodyNode(link).getBodyForce() for link in self.robot.links])
        return out | {"f": forces[None, :, 3:], "n": forces[None, :, :3]}


if __name__ == "__main__":
    serve(Dart)
