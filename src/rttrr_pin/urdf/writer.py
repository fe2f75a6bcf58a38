"""A model as the text of a URDF, each number with all the digits of its double.

Rotations are written as angles, which give the matrices back to a few eps. What URDF has no words for stays behind:
armature, gravity, an axis of less than two limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from xml.etree import ElementTree as ET

from rttrr_pin.core.arrays import Array, angles_of
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import CONTINUOUS, JointType
from rttrr_pin.core.model import Link, Model
from rttrr_pin.urdf.inertial import ENTRIES
from rttrr_pin.urdf.vocabulary import ATTRIBUTES


def urdf_text(model: Model) -> str:
    """The URDF of a model; a floating base, which no URDF has, is left out.

    Args:
        model: its names must be texts that XML can hold.

    Returns:
        The text. A revolute joint without a lower and an upper limit is continuous, which moves the same way; where
        one limit alone is missing it is 0, or the other.
    """
    robot = ET.Element("robot", name=model.name)
    links, joints = (model.root, *model.links), model.joints
    if model.floating:
        links, joints = model.links, joints[1:]
    for link in links:
        _link(robot, link)
    for joint, link in zip(joints, links[1:], strict=True):
        _joint(robot, model, joint, link.name)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode")


def written(values: Iterable[float]) -> str:
    """Numbers that are read back as the same doubles."""
    return " ".join(repr(float(value)) for value in values)


def tensor_words(tensor: Array) -> dict[str, str]:
    """The six attributes of <inertia>."""
    return {name: written([tensor[at]]) for name, at in ENTRIES.items()}


def _link(robot: ET.Element, link: Link) -> None:
    element = ET.SubElement(robot, "link", name=link.name)
    if link.mass == 0.0 and not link.com.any() and not link.inertia.any():
        return
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=written(link.com), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=written([link.mass]))
    ET.SubElement(inertial, "inertia", tensor_words(link.inertia))


def _joint(robot: ET.Element, model: Model, joint: Joint, child: str) -> None:
    joint_type, limits = _limits(joint)
    element = ET.SubElement(robot, "joint", name=joint.name, type=joint_type.name)
    ET.SubElement(element, "parent", link=(model.root if joint.parent < 0 else model.links[joint.parent]).name)
    ET.SubElement(element, "child", link=child)
    ET.SubElement(element, "origin", xyz=written(joint.p), rpy=written(angles_of(joint.R)))
    if joint.type.has_direction:
        ET.SubElement(element, "axis", xyz=written(joint.axis))
    if limits:
        ET.SubElement(element, "limit", {key: written([value]) for key, value in limits.items()})
    effects = {key: getattr(joint.effects, key) for key in ATTRIBUTES["dynamics"]}
    if any(effects.values()):
        ET.SubElement(element, "dynamics", {key: written([value]) for key, value in effects.items()})
    if joint.mimic is not None:
        numbers = {key: written([getattr(joint.mimic, key)]) for key in ("multiplier", "offset")}
        ET.SubElement(element, "mimic", {"joint": model.joints[joint.mimic.joint].name} | numbers)


def _limits(joint: Joint) -> tuple[JointType, dict[str, float]]:
    """What to call the joint's type, and its <limit>: 0 stands for a largest rate or effort that is not set."""
    joint_type, own = joint.type, asdict(joint.limits)
    finite = {key: own[key] for key in ATTRIBUTES["limit"] if math.isfinite(own[key])}
    ends = finite.keys() & {"lower", "upper"}
    if joint_type.limits == "required" and joint_type.rotates and not ends:
        joint_type = CONTINUOUS
    if joint_type.limits == "required":
        lower = finite.get("lower", min(0.0, finite.get("upper", 0.0)))
        finite = {"lower": lower, "upper": finite.get("upper", max(0.0, lower))} | finite
    return joint_type, finite and {"velocity": 0.0, "effort": 0.0} | finite
