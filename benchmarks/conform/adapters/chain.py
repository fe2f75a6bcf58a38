"""A chain as Modern Robotics has it: frames at the centres of mass, spatial inertias, screws in the space frame."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import Any

import numpy as np
from door import Array, NotOfferedError, Robot


@dataclass(frozen=True)
class Chain:
    """Mlist, whose last entry places the frame of the last link, Glist and Slist."""

    M: list[Array]
    G: list[Array]
    S: Array


def chain_of(robot: Robot) -> Chain:
    """The chain of a robot whose links on fixed joints have no mass, and come last."""
    urdf = ET.fromstring(robot.text)
    links = {link.get("name"): link for link in urdf.findall("link")}
    joints = {joint.get("name"): joint for joint in urdf.findall("joint")}
    T, last, M, G, S = np.eye(4), np.eye(4), [], [], []
    for joint in robot.joints:
        element = joints[joint.name]
        if joint.type == "fixed":
            if links[joint.child].find("inertial") is not None or joint is not robot.joints[-1]:
                raise NotOfferedError("bodies on fixed joints (the adapter writes no sums of inertias)")
            T = T @ placement(element.find("origin"))
            continue
        T = T @ placement(element.find("origin"))
        axis = T[:3, :3] @ numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0))
        S.append([*axis, *-np.cross(axis, T[:3, 3])] if joint.type != "prismatic" else [0.0, 0.0, 0.0, *axis])
        inertial = links[joint.child].find("inertial")
        C, spatial = np.eye(4), np.zeros((6, 6))
        if inertial is not None:
            C = placement(inertial.find("origin"))
            spatial[:3, :3] = tensor(inertial.find("inertia"))
            spatial[3:, 3:] = np.eye(3) * float(inertial.find("mass").get("value"))
        M.append(np.linalg.inv(last) @ T @ C)
        G.append(spatial)
        last = T @ C
    return Chain([*M, np.linalg.inv(last) @ T], G, np.array(S).T)


def numbers(element: Any, name: str, default: tuple[float, ...]) -> Array:
    text = None if element is None else element.get(name)
    return np.array(default if text is None else [float(x) for x in text.split()])


def placement(origin: Any) -> Array:
    """The matrix of an <origin>: x, y, z and roll, pitch, yaw about fixed axes."""
    out = np.eye(4)
    out[:3, 3] = numbers(origin, "xyz", (0.0, 0.0, 0.0))
    (cr, cp, cy), (sr, sp, sy) = (own(numbers(origin, "rpy", (0.0, 0.0, 0.0))) for own in (np.cos, np.sin))
    out[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return out


def tensor(element: Any) -> Array:
    xx, xy, xz, yy, yz, zz = (float(element.get(key)) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
