"""Dynibo (Rust): `Robot.inverse_dynamics`, `FloatingRobot.inverse_dynamics`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, NotOfferedError, Robot, States, back, in_world, serve

ITS_GRAVITY = 9.80665
"""Dynibo has no call to change it."""


class Dynibo(Adapter):
    packages = ("dynibo",)
    offers = TREES | {"floating", "payload"}
    call = "robot.inverse_dynamics(q, v, a, loads)"
    conventions = (
        "joint order found by Jacobians, as it does not tell it; gravity is 9.80665 for good: what is missing to the "
        "robot's is added in proportion to its own gravity(q); floating base angular before linear, in world axes"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import dynibo

        if robot.gravity[:2].any():
            raise NotOfferedError("gravity that is not vertical")
        self.dynibo = dynibo
        fixed = dynibo.Robot.from_urdf(robot.path)
        self.library = dynibo.FloatingRobot.from_urdf(robot.path) if robot.floating else fixed
        self.names = self._order(fixed)
        self.missing = -robot.gravity[2] / ITS_GRAVITY - 1.0

    def _order(self, fixed: Any) -> list[str]:
        """The coordinate of each joint is the one that moves its child but not its parent."""
        count, moved = fixed.joint_count, {}
        for link in {self.robot.root, *(joint.child for joint in self.robot.joints if joint.type != "floating")}:
            jacobian = np.array(fixed.jacobian(np.full(count, 0.1), fixed.link_id(link)))
            moved[link] = set(np.flatnonzero(jacobian.reshape(count, 6).any(axis=1)))
        order = [""] * count
        for joint in self.robot.moving:
            (k,) = moved[joint.child] - moved[joint.parent]
            order[k] = joint.name
        return order

    def inputs(self, states: States) -> Any:
        q, v, a = super().inputs(states)
        loads = [
            self.dynibo.Load(self.library.link_id(load.link), torque=load.n[0].tolist(), force=load.f[0].tolist())
            for load in states.payload
        ]
        if not self.robot.floating:
            return [() for _ in q], q, v, a, loads or None
        _, v_w, w, v_dot, w_dot = (x.tolist() for x in in_world(states))
        Pose, Twist, places = self.dynibo.Pose, self.dynibo.Twist, states.q.tolist()
        bases = [
            (
                self.dynibo.BaseState(
                    frame=Pose(translation=places[k][:3], rotation_xyzw=places[k][3:7]),
                    velocity=Twist(angular=w[k], linear=v_w[k]),
                    acceleration=Twist(angular=w_dot[k], linear=v_dot[k]),
                ),
            )
            for k in range(len(states))
        ]
        return bases, q, v, a, loads or None

    def run(self, inputs: Any) -> Any:
        bases, q, v, a, loads = inputs
        out = np.empty((len(q), self.library.generalized_count))
        for k in range(len(q)):
            self.library.inverse_dynamics(*bases[k], q[k], v[k], a[k], loads, out=out[k])
        return out

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        bases, q = self.inputs(states)[:2]
        raw = raw + self.missing * np.array([self.library.gravity(*base, x) for base, x in zip(bases, q, strict=True)])
        if not self.robot.floating:
            return {"tau": self.torques(raw, np.zeros((len(raw), 0)))}
        R = in_world(states)[0]
        return {"tau": self.torques(raw[:, 6:], np.hstack([back(R, raw[:, 3:6]), back(R, raw[:, :3])]))}


if __name__ == "__main__":
    serve(Dynibo)
