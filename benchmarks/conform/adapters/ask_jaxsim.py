"""JaxSim: `js.model.inverse_dynamics`. It reads URDF through Gazebo's program; the adapter writes SDF instead."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import numpy as np
from chain import numbers
from door import TREES, Array, Robot, States, serve
from jax_batch import JaxAdapter, as_real


class JaxSim(JaxAdapter):
    packages = ("jaxsim", "rod", "jax")
    offers = TREES | {"floating", "payload"}
    call = "jit(vmap(lambda ...: js.model.inverse_dynamics(model, data, joint_accelerations=a, base_acceleration=...)))"
    conventions = (
        "VelRepr.Body; SDF written by the adapter, link by link, without frames at the end; payload as link_forces "
        "with the opposite sign"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import jaxsim.api as js
        from jaxsim import VelRepr

        model = js.model.JaxSimModel.build_from_model_description(sdf_of(robot), is_urdf=False,
                                                                  gravity=-float(robot.gravity[2]))  # fmt: skip
        self.names = list(model.joint_names())
        self.links = list(model.link_names())

        def one(place: Any, base_v: Any, base_a: Any, q: Any, v: Any, a: Any, forces: Any) -> Any:
            data = js.data.JaxSimModelData.build(
                model=model, base_position=place[:3], base_quaternion=place[3:], joint_positions=q,
                base_linear_velocity=base_v[:3], base_angular_velocity=base_v[3:], joint_velocities=v,
                velocity_representation=VelRepr.Body,
            )  # fmt: skip
            return js.model.inverse_dynamics(
                model, data, joint_accelerations=a, base_acceleration=base_a, link_forces=forces
            )

        self.one = one

    def inputs(self, states: States) -> Any:
        at_q, at_v = self.robot.columns(self.names)
        place, base_v, base_a = np.tile([0.0, 0, 0, 1, 0, 0, 0], (len(states), 1)), *np.zeros((2, len(states), 6))
        if self.robot.floating:
            place, base_v, base_a = states.q[:, [0, 1, 2, 6, 3, 4, 5]], states.v[:, :6], states.a[:, :6]
        forces = np.zeros((len(states), len(self.links), 6))
        for load in states.payload:
            forces[:, self.links.index(load.link)] = np.hstack([-load.f, -load.n])
        arrays = place, base_v, base_a, states.q[:, at_q], states.v[:, at_v], states.a[:, at_v], forces
        return as_real(arrays, self.real)

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        base, tau = (np.asarray(x) for x in raw)
        return {"tau": self.torques(tau, base if self.robot.floating else np.zeros((len(states), 0)))}


def sdf_of(robot: Robot) -> str:
    """The robot as SDF, with the poses that JaxSim asks for."""
    urdf = ET.fromstring(robot.text)
    model = ET.Element("model", name="robot")
    carriers = {joint.child: joint for joint in robot.joints if joint.type != "floating"}
    for link in urdf.findall("link"):
        name = link.get("name", "")
        inertial = link.find("inertial")
        if inertial is None and name != robot.root and all(joint.parent != name for joint in robot.joints):
            continue  # a frame
        out = ET.SubElement(model, "link", name=name)
        mass, entries = (None, None) if inertial is None else (inertial.find("mass"), inertial.find("inertia"))
        if name in carriers:
            ET.SubElement(out, "pose", relative_to=carriers[name].name).text = "0 0 0 0 0 0"
        body = ET.SubElement(out, "inertial")
        ET.SubElement(body, "pose").text = _pose(None if inertial is None else inertial.find("origin"))
        ET.SubElement(body, "mass").text = "0" if mass is None else mass.get("value")
        tensor = ET.SubElement(body, "inertia")
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"):
            ET.SubElement(tensor, key).text = "0" if entries is None else entries.get(key)
    if not robot.floating:
        _joint(model, "world_joint", "fixed", "world", robot.root)
    for joint in urdf.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        own = robot.joint(name)
        if model.find(f"link[@name='{own.child}']") is None:
            continue
        out = _joint(model, name, kind, own.parent, own.child)
        ET.SubElement(out, "pose", relative_to=own.parent).text = _pose(joint.find("origin"))
        if kind != "fixed":
            axis = ET.SubElement(out, "axis")
            ET.SubElement(axis, "xyz").text = " ".join(
                map(repr, numbers(joint.find("axis"), "xyz", (1.0, 0, 0)).tolist())
            )
            limit = ET.SubElement(axis, "limit")
            ET.SubElement(limit, "lower").text, ET.SubElement(limit, "upper").text = "-1e16", "1e16"
    sdf = ET.Element("sdf", version="1.7")
    sdf.append(model)
    return ET.tostring(sdf, encoding="unicode")


def _joint(model: Any, name: str, kind: str, parent: str, child: str) -> Any:
    out = ET.SubElement(model, "joint", name=name, type=kind)
    ET.SubElement(out, "parent").text, ET.SubElement(out, "child").text = parent, child
    return out


def _pose(origin: Any) -> str:
    return " ".join(repr(x) for key in ("xyz", "rpy") for x in numbers(origin, key, (0.0, 0.0, 0.0)).tolist())


if __name__ == "__main__":
    serve(JaxSim)
