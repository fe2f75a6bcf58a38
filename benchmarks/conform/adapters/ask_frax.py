"""frax: `Robot.rnea` in JAX."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Array, Robot, States, back, in_file, in_world, serve
from jax_batch import JaxAdapter, as_real


class Frax(JaxAdapter):
    packages = ("frax", "jax")
    offers = TREES | {"floating"}
    call = "jit(vmap(lambda q, v, a: robot.rnea(q, v, a, gravity_accel, None)))"
    conventions = (
        "an inertia for a root without one; gravity as an acceleration upwards; quaternion base (w, x, y, z), "
        "velocity of its origin in world axes, "
        "angular velocity in its own; F_ext is by moving joint in world axes, so no payload of a link"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from frax.core.robot import Robot as Library

        base = {"floating_base": "quaternion"} if robot.floating else {}
        library = Library(
            in_file(with_root_inertia(robot)), joint_ordering=[joint.name for joint in robot.moving], **base
        )
        self.names = list(library.joint_names)[6 if robot.floating else 0 :]
        upwards = np.array([*-robot.gravity, 0.0, 0.0, 0.0])  # linear before angular
        self.one = lambda q, v, a: library.rnea(q, v, a, upwards.astype(real), None)

    def inputs(self, states: States) -> Any:
        at_q, at_v = self.robot.columns(self.names)
        q, v, a = states.q[:, at_q], states.v[:, at_v], states.a[:, at_v]
        if self.robot.floating:
            _, v_world, _, v_dot, _ = in_world(states)
            q = np.hstack([states.q[:, [0, 1, 2, 6, 3, 4, 5]], q])
            v, a = np.hstack([v_world, states.v[:, 3:6], v]), np.hstack([v_dot, states.a[:, 3:6], a])
        return as_real((q, v, a), self.real)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        raw, base = np.asarray(raw), np.zeros((len(states), 0))
        if self.robot.floating:
            base = np.hstack([back(in_world(states)[0], raw[:, :3]), raw[:, 3:6]])
        return {"tau": self.torques(raw[:, base.shape[1] :], base)}


def with_root_inertia(robot: Robot) -> str:
    """The text; the root has an inertia, which frax wants to read, though a fixed base has no part in tau."""
    urdf = ET.fromstring(robot.text)
    (root,) = (link for link in urdf.findall("link") if link.get("name") == robot.root)
    if root.find("inertial") is None:
        inertial = ET.SubElement(root, "inertial")
        ET.SubElement(inertial, "origin", xyz="0 0 0", rpy="0 0 0")
        ET.SubElement(inertial, "mass", value="1")
        ET.SubElement(inertial, "inertia", ixx="1", ixy="0", ixz="0", iyy="1", iyz="0", izz="1")
    return ET.tostring(urdf, encoding="unicode")


if __name__ == "__main__":
    serve(Frax)
