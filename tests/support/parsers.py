"""What a program makes of a file, against what the file says: the behaviour that our rules should tell."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pinocchio
import pytest
import yourdfpy
from numpy.typing import ArrayLike

from rttrr_pin.inspection import Behaviour
from rttrr_pin.inspection.merged import merged_links
from rttrr_pin.urdf.document import UrdfDocument
from support.tolerances import CONSUMER, CONSUMER_AXES

FREEDOM = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6, "fixed": 0}


def near(x: ArrayLike, y: ArrayLike) -> bool:
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    return bool(np.linalg.norm(x - y) <= CONSUMER * np.linalg.norm(y))


def freedom(document: UrdfDocument) -> int:
    return sum(FREEDOM[joint.type] for joint in document.joints.values() if joint.mimic is None)


def moments(tensor: ArrayLike) -> np.ndarray:
    return np.linalg.eigvalsh(np.asarray(tensor))


def pinocchio_behaviour(text: str, document: UrdfDocument) -> Behaviour:
    try:
        model = pinocchio.buildModelFromXML(text)
    except ValueError:
        return Behaviour.REFUSE
    same = model.nv == freedom(document)
    for name, merged in merged_links(document).items():
        if name != document.root:
            loaded = model.inertias[model.getJointId(document.carried_by[name].name)]
            same &= near(loaded.mass, merged.mass) and near(moments(loaded.inertia), moments(merged.inertia))
            if merged.mass:
                same &= np.allclose(loaded.lever, merged.moment / merged.mass, rtol=CONSUMER, atol=CONSUMER)
    return Behaviour.ACCEPT if same else Behaviour.ALTER


def tensor_of(body: Any) -> np.ndarray:
    """In link axes, about the centre of mass."""
    R = np.empty(9)
    mujoco.mju_quat2Mat(R, body.iquat)
    return R.reshape(3, 3) * body.inertia @ R.reshape(3, 3).T


def mujoco_behaviour(text: str, document: UrdfDocument) -> Behaviour:
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return Behaviour.REFUSE
    same = model.nv == freedom(document)
    for name, merged in merged_links(document).items():
        if name != document.root:
            body = model.body(name)
            off, size = np.linalg.norm(tensor_of(body) - merged.inertia), abs(np.trace(merged.inertia))
            same &= near(body.mass[0], merged.mass) and bool(off <= CONSUMER_AXES * size)
            same &= not merged.mass or bool(np.linalg.norm(body.ipos - merged.moment / merged.mass) <= CONSUMER)
    for link in document.joints.values():
        if link.type in ("revolute", "prismatic") and link.limit is not None:
            wanted = (link.limits.get("lower", 0.0), link.limits.get("upper", 0.0))
            same &= bool(model.joint(link.name).limited[0]) and near(model.joint(link.name).range, wanted)
        same &= link.type != "continuous" or not model.joint(link.name).limited[0]
    return Behaviour.ACCEPT if same else Behaviour.ALTER


def drake_behaviour(text: str, document: UrdfDocument) -> Behaviour:
    import logging

    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    logging.getLogger("drake").setLevel(logging.CRITICAL)
    plant = MultibodyPlant(0.0)
    try:
        (instance,) = Parser(plant).AddModelsFromString(text, "urdf")
        if document.root != "world":
            plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(document.root, instance))
        plant.Finalize()
    except (RuntimeError, ValueError, SystemExit):  # the last where its C++ gives up
        return Behaviour.REFUSE
    for joint in document.joints.values():
        if joint.type in ("revolute", "continuous", "prismatic"):
            limits, loaded = joint.limits, plant.GetJointByName(joint.name, instance)
            end = 0.0 if joint.limit is not None and joint.type != "continuous" else np.inf
            wanted = (limits.get("lower", -end), limits.get("upper", end)) if end == 0.0 else (-np.inf, np.inf)
            ranges = (loaded.position_lower_limits()[0], loaded.position_upper_limits()[0])
            if ranges != wanted or loaded.velocity_upper_limits()[0] != limits.get("velocity", np.inf):
                return Behaviour.ALTER
    same = plant.num_velocities(instance) - plant.num_constraints() == freedom(document)
    same &= all(plant.HasJointNamed(name, instance) for name in document.joints)
    for name, body in document.links.items():
        if name == "world":
            continue
        loaded, inertial = plant.GetBodyByName(name, instance), body.inertial
        mass = 0.0 if inertial is None else float(inertial.mass)
        same &= near(loaded.default_mass(), mass)
        if inertial is not None and mass > 0.0:
            spatial = loaded.default_spatial_inertia()
            tensor = spatial.Shift(spatial.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
            lever = mass * float(
                np.dot(inertial.origin.p, inertial.origin.p)
            )  # added and taken away again: its digits are lost
            same &= bool(np.linalg.norm(tensor - inertial.inertia) <= CONSUMER * (np.linalg.norm(tensor) + lever))
    return Behaviour.ACCEPT if same else Behaviour.ALTER


def yourdfpy_behaviour(text: str, document: UrdfDocument) -> Behaviour:
    try:
        robot = yourdfpy.URDF.load(io.BytesIO(text.encode()), load_meshes=False)
    except Exception:  # whatever it stumbles over
        return Behaviour.REFUSE
    same = robot.num_dofs == freedom(document)
    if not robot.link_map:
        return Behaviour.ALTER
    for name, link in document.links.items():
        loaded, inertial = robot.link_map[name].inertial, link.inertial
        same &= (loaded is None) == (inertial is None)
        if loaded is not None and inertial is not None:
            same &= loaded.mass == float(inertial.mass) and np.array_equal(loaded.inertia, inertial.tensor)
    still = {each.name: robot.get_transform(each.child, each.parent) for each in document.joints.values()}
    robot.update_cfg(np.full(robot.num_actuated_joints, 0.1))
    for name, each in document.joints.items():
        free = each.moves and each.mimic is None
        same &= free <= (not np.array_equal(robot.get_transform(each.child, each.parent), still[name]))
        limit = robot.joint_map[name].limit
        same &= {key: getattr(limit, key) for key in each.limits} == each.limits
    return Behaviour.ACCEPT if same else Behaviour.ALTER


PROGRAMS: list = [
    pytest.param("yourdfpy", yourdfpy_behaviour, id="yourdfpy"),
    pytest.param("Pinocchio", pinocchio_behaviour, id="Pinocchio"),
    pytest.param("MuJoCo", mujoco_behaviour, id="MuJoCo"),
    pytest.param("Drake", drake_behaviour, id="Drake", marks=pytest.mark.drake),
]

Program = Callable[[str, UrdfDocument], Behaviour]
