"""What each parser does with faults of a file, with newer versions of the format, and with what no tree has."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from math import hypot

from rttrr_pin.inspection import parser_rules as rules
from rttrr_pin.inspection.rule import (
    DRAKE,
    MUJOCO,
    PINOCCHIO,
    URDFDOM,
    YOURDFPY,
    Behaviour,
    Places,
    Rule,
    faults,
    joints,
)
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.faults import Fault
from rttrr_pin.urdf.vocabulary import LIMITS_1_2

NO_MASS = (("mass", "inertial"), ("mass", "mass"))
NO_TENSOR = (("inertia", "inertial"), ("inertia", "inertia"))
"""Kinds of faults, and the elements that they stand in."""


def _in_joint(fault: Fault) -> bool:
    return fault.tag == "joint"


def _turned_by_quaternion(document: UrdfDocument) -> Iterator[str]:
    """Links and joints whose frame a quat_xyzw turns."""
    placements = [(name, inertial.origin) for name, inertial in rules.inertials(document)]
    placements += [(joint.name, joint.origin) for joint in document.joints.values()]
    return (name for name, origin in placements if origin.quaternion is not None and origin.rotated)


def _of_version(holds: Callable[[tuple[int, int]], bool]) -> Places:
    """The robot, if the version of its format is such a one."""
    return lambda document: [document.name] if holds(document.version) else []


def not_one_root(document: UrdfDocument) -> Iterator[str]:
    """The robot, if it has several roots or none."""
    wrong = (fault for fault in document.faults if fault.tag == "robot")
    if any(fault.kind == "tree" or (fault.kind == "loop" and "no root" in fault.message) for fault in wrong):
        yield document.name


def _late_declaration(document: UrdfDocument) -> Iterator[str]:
    """The robot, if a declaration stands behind a comment or the like."""
    if any(fault.kind == "declaration" for fault in document.faults) and re.match(
        r"\s*<(?!\?xml)(?:(?!<robot\b).)*<\?xml\b", document.file_text, flags=re.DOTALL
    ):
        yield document.name


def _text_behind(document: UrdfDocument) -> Iterator[str]:
    """The robot, if text, and no element, stands behind it."""
    tail = re.sub(r"<!--.*?-->", "", document.file_text.partition("</robot>")[2], flags=re.DOTALL).strip()
    if any(fault.kind == "behind" for fault in document.faults) and not tail.startswith("<"):
        yield document.name


def _inertials(*elements: tuple[str, str]) -> Places:
    """Links with faults of such kinds in such elements."""
    return lambda document: (
        fault.name for fault in document.faults if fault.tag == "link" and (fault.kind, fault.element) in elements
    )


def _in_elements(element: str, holds: Callable[[Fault], object]) -> Places:
    """Links and joints with such faults in such an element."""
    return lambda document: (fault.name for fault in document.faults if fault.element == element and holds(fault))


def _missing_moment(document: UrdfDocument) -> Iterator[str]:
    """Links whose <inertial> lacks a mass, a moment, or all of the tensor."""
    for fault in document.faults:
        entry = fault.kind == "inertia" and fault.attribute not in ("ixy", "ixz", "iyz")
        if entry or (fault.kind == "mass" and (fault.missing or fault.element == "inertial")):
            yield fault.name


def unreadable_numbers(document: UrdfDocument) -> Iterator[Fault]:
    """Numbers that cannot be read, but of quat_xyzw, which only a reader of URDF 1.1 looks at."""
    numbers = (fault for fault in document.faults if fault.kind == "number" or fault.element == "mass" == fault.kind)
    return (fault for fault in numbers if not fault.missing and fault.attribute != "quat_xyzw")


def _unreadable(document: UrdfDocument) -> Iterator[str]:
    """Links and joints with a number that cannot be read."""
    return (fault.name for fault in unreadable_numbers(document))


def _zero_axis(document: UrdfDocument) -> Iterator[str]:
    """Joints whose axis is zero."""
    undirected = (fault.name for fault in document.faults if fault.kind == "direction")
    return (name for name in undirected if document.joints[name].type != "planar")


def shorter_axis(length: float) -> Places:
    """Joints whose axis is not zero, and no longer than that."""
    with_axis = ("revolute", "continuous", "prismatic")
    return joints(lambda joint: joint.type in with_axis and hypot(*joint.axis.floats) <= length)


def _with_capsule(document: UrdfDocument) -> Iterator[str]:
    """Links that are drawn as capsules."""
    links = document.links.values()
    return (link.name for link in links if any(shape.tag == "capsule" for shape in link.shapes))


FAULT_RULES = (
    Rule("tinyxml-behind", (*URDFDOM, MUJOCO, DRAKE), Behaviour.REFUSE,
         "text stands behind </robot>",
         "tinyxml2: tinyxml2.cpp, XMLDocument::Parse", _text_behind),
    Rule("tinyxml-declaration", (*URDFDOM, MUJOCO, DRAKE), Behaviour.REFUSE,
         "an XML declaration stands behind a comment",
         "tinyxml2: tinyxml2.cpp, XMLNode::ParseDeep", _late_declaration),
    Rule("no-name", (*URDFDOM, DRAKE, YOURDFPY), Behaviour.REFUSE,
         "the robot has no name",
         "urdfdom: urdf_parser/src/model.cpp, parseURDF",
         faults("unnamed")),
    Rule("names", (*URDFDOM, MUJOCO, DRAKE), Behaviour.REFUSE,
         "a link or joint has no name, or that of another",
         "urdfdom: urdf_parser/src/model.cpp, parseURDF", faults("name", lambda fault: fault.tag != "robot")),
    Rule("yourdfpy-unnamed", (YOURDFPY,), Behaviour.REFUSE,
         "a link or joint has no name",
         "yourdfpy: urdf.py, URDF._parse_link", faults("name", lambda fault: fault.tag != "robot" and not fault.name)),
    Rule("yourdfpy-names", (YOURDFPY,), Behaviour.ALTER,
         "of links or joints of one name the last counts",
         "yourdfpy: urdf.py, URDF._determine_actuated_joints",
         faults("name", lambda fault: fault.tag != "robot" and fault.name)),
    Rule("urdfdom-version", URDFDOM, Behaviour.REFUSE,
         "the version is none of 1.0, 1.1 and 1.2",
         "urdfdom: urdf_parser/src/model.cpp, parseURDF", faults("version")),
    Rule("urdfdom-newer", URDFDOM, Behaviour.EITHER,
         "older versions of urdfdom refuse what is of another version than 1.0",
         "urdfdom: urdf_parser/src/model.cpp, parseURDF", _of_version(lambda version: version > (1, 0))),
    Rule("quaternion", (MUJOCO, DRAKE, YOURDFPY), Behaviour.ALTER,
         "quat_xyzw is ignored: the frame is not turned",
         "yourdfpy: urdf.py, URDF._parse_origin", _turned_by_quaternion),
    Rule("urdfdom-quaternion", URDFDOM, Behaviour.ALTER,
         "before version 1.1 of the format quat_xyzw is ignored: the frame is not turned",
         "urdfdom: urdf_parser/src/pose.cpp, parsePoseInternal", faults("quaternion")),
    Rule("urdfdom-rotations", URDFDOM, Behaviour.REFUSE,
         "a joint's frame has both rpy and quat_xyzw",
         "urdfdom: urdf_parser/src/pose.cpp, parsePoseInternal", faults("rotations", _in_joint)),
    Rule("urdfdom-dropped", URDFDOM, Behaviour.ALTER,
         "an <inertial> without a readable mass or origin is dropped, with a line on stderr",
         "urdfdom: urdf_parser/src/link.cpp, parseInertial",
         _inertials(*NO_MASS, ("number", "origin"), ("rotations", "origin"))),
    Rule("urdfdom-tensor", URDFDOM, Behaviour.ALTER,
         "without all six entries, and readable, the tensor is 0, with a line on stderr",
         "urdfdom: urdf_parser/src/link.cpp, parseInertial", _inertials(*NO_TENSOR, ("number", "inertia"))),
    Rule("mujoco-entries", (MUJOCO,), Behaviour.REFUSE,
         "an <inertial> has no mass or not all six entries",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Body", _inertials(*NO_MASS, *NO_TENSOR)),
    Rule("yourdfpy-entries", (YOURDFPY,), Behaviour.ALTER,
         "a missing ixx, iyy or izz is 1, a missing mass or inertia None",
         "yourdfpy: urdf.py, URDF._parse_inertia", _missing_moment),
    Rule("urdfdom-number", URDFDOM, Behaviour.REFUSE,
         "a number of a joint cannot be read",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint",
         faults("number", lambda fault: _in_joint(fault) and not fault.missing)),
    Rule("number", (MUJOCO, YOURDFPY), Behaviour.REFUSE,
         "a number cannot be read",
         "mujoco: src/xml/xml_util.cc, mjXUtil::ReadAttr", _unreadable),
    Rule("mujoco-axis", (MUJOCO,), Behaviour.REFUSE,
         "an axis has no xyz, or that of a fixed joint cannot be read",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint",
         _in_elements("axis", lambda fault: fault.kind == "unused" or (fault.kind == "number" and fault.missing))),
    Rule("unused-limit", URDFDOM, Behaviour.REFUSE,
         "a limit that no moving joint uses cannot be read, or is negative",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint", _in_elements("limit", lambda fault: fault.kind == "unused")),
    Rule("yourdfpy-unused", (YOURDFPY,), Behaviour.REFUSE,
         "the axis or a limit of a fixed joint cannot be read",
         "yourdfpy: urdf.py, URDF._parse_axis and URDF._parse_limit",
         faults("unused", lambda fault: not fault.missing and fault.attribute not in LIMITS_1_2)),
    Rule("urdfdom-asked", URDFDOM, Behaviour.REFUSE,
         "<limit>, <dynamics>, <calibration> or <safety_controller> lacks a number",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint", faults("asked")),
    Rule("material", (*URDFDOM, DRAKE), Behaviour.REFUSE,
         "two materials of the robot have one name",
         "urdfdom: urdf_parser/src/model.cpp, parseURDF", faults("material")),
    Rule("zero-axis", (MUJOCO, DRAKE), Behaviour.REFUSE,
         "an axis is 0 0 0",
         "mujoco: src/user/user_objects.cc, mjCJoint::Compile", _zero_axis),
    Rule("mujoco-short", (MUJOCO,), Behaviour.REFUSE,
         "an axis is not longer than 1e-7, its square than mjEPS",
         "mujoco: src/user/user_objects.cc, mjCJoint::Compile", shorter_axis(1e-7)),
    Rule("twice", (MUJOCO,), Behaviour.REFUSE,
         "an element that counts once stands twice",
         "mujoco: src/xml/xml_util.cc, mjXSchema::Check", faults("twice")),
    Rule("mujoco-reversed", (MUJOCO,), Behaviour.ALTER,
         "a range whose lower limit is above the upper one is no limit: the joint moves freely",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint", faults("range")),
    Rule("negative-limit", (PINOCCHIO,), Behaviour.REFUSE,
         "a limit of effort or velocity is negative",
         "pinocchio: include/pinocchio/multibody/model.hxx, ModelTpl::addJoint", faults("limit")),
    Rule("mimic-nothing", (*URDFDOM, MUJOCO), Behaviour.REFUSE,
         "a <mimic> names no joint",
         "urdfdom: urdf_parser/src/joint.cpp, parseJointMimic", faults("mimic", lambda fault: not fault.value)),
    Rule("mujoco-itself", (MUJOCO,), Behaviour.REFUSE,
         "a joint follows itself",
         "mujoco: src/user/user_objects.cc, mjCEquality::Compile",
         faults("mimic", lambda fault: fault.value == fault.name)),
    Rule("yourdfpy-mimic", (YOURDFPY,), Behaviour.ALTER,
         "a joint whose <mimic> leads to no joint that could be followed does not move",
         "yourdfpy: urdf.py, URDF._determine_actuated_joints", faults("mimic")),
    Rule("joint", (*URDFDOM, MUJOCO, DRAKE, YOURDFPY), Behaviour.REFUSE,
         "a joint has no known type, or lacks a parent or a child that exists",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint; urdf_parser/src/model.cpp, initTree", faults("joint")),
    Rule("roots", (*URDFDOM,), Behaviour.REFUSE,
         "the links are no tree with one root",
         "urdfdom: urdf_parser/src/model.cpp, initRoot", not_one_root),
    Rule("loop", (*URDFDOM, YOURDFPY), Behaviour.ALTER,
         "links that hang on a loop of joints beside the tree are left out without a word",
         "pinocchio: src/parsers/urdf/model.cpp, parseTree", faults("loop")),
    Rule("loop-refused", (MUJOCO, DRAKE), Behaviour.REFUSE,
         "joints form a loop beside the tree",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Parse", faults("loop")),
    Rule("two-parents", URDFDOM, Behaviour.ALTER,
         "of two joints that carry one link, one is left out without a word",
         "urdfdom: urdf_parser/src/model.cpp, initTree", faults("tree", _in_joint)),
    Rule("two-parents-refused", (MUJOCO, DRAKE, YOURDFPY), Behaviour.REFUSE,
         "two joints carry one link",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Parse", faults("tree", _in_joint)),
    Rule("not-modelled", (*URDFDOM, MUJOCO, YOURDFPY), Behaviour.ALTER,
         "an element that carries mechanics, or closes a loop, is skipped without a word",
         "urdfdom: urdf_parser/src/model.cpp, parseURDF", faults("not-modelled")),
    Rule("yourdfpy-namespace", (YOURDFPY,), Behaviour.ALTER,
         "elements in a default namespace are not found",
         "yourdfpy: urdf.py, URDF._parse_robot", faults("namespace", lambda fault: fault.element == "robot")),
    Rule("yourdfpy-outside", (YOURDFPY,), Behaviour.REFUSE,
         "a link or joint in a default namespace is not found",
         "yourdfpy: urdf.py, URDF._parse_robot",
         faults("namespace", lambda fault: fault.element not in ("", "robot"))),
    Rule("yourdfpy-capsule", (YOURDFPY,), Behaviour.REFUSE,
         "a link has a <capsule>",
         "yourdfpy: urdf.py, URDF._parse_geometry", _with_capsule),
)  # fmt: skip
