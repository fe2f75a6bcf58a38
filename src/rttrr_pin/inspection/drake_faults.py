"""What Drake does with faults of a file: the rules that it shares with no other parser."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite

from rttrr_pin.inspection.parser_faults import not_one_root, shorter_axis, unreadable_numbers
from rttrr_pin.inspection.rule import DRAKE, Behaviour, Places, Rule, faults, joints
from rttrr_pin.inspection.structure import LIMITED
from rttrr_pin.urdf.decimals import NUMBER
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.faults import Fault


def _read_by_streams(fault: Fault) -> bool:
    """Whether as many numbers as there should be, and no more, stand at the start of an attribute."""
    text, count = (fault.value or "").lstrip(), 0
    while (number := NUMBER.match(text)) and isfinite(float(number[0])):
        text, count = text[number.end() :].lstrip(), count + 1
    return count == (3 if fault.attribute in ("xyz", "rpy") else 1)


def _numbers(read: bool) -> Places:
    """Links and joints with a number that Drake reads in part, or refuses."""
    return lambda document: (fault.name for fault in unreadable_numbers(document) if _read_by_streams(fault) is read)


def _reversed(document: UrdfDocument) -> Iterator[str]:
    """Joints whose lower limit is above the upper one, both written; also continuous ones."""
    yield from (fault.name for fault in document.faults if fault.kind == "range" and not fault.attribute)
    for joint in document.joints.values():
        if joint.type == "continuous" and joint.limits.get("lower", -inf) > joint.limits.get("upper", inf):
            yield joint.name


def _open(document: UrdfDocument) -> Iterator[str]:
    """Joints of whose range Drake makes another: an end that is left out is 0 in URDF."""
    both = {"lower", "upper"}
    half = {fault.name for fault in document.faults if fault.kind == "range" and fault.attribute}
    for joint in document.joints.values():
        ranged = joint.limit is not None and joint.type in LIMITED
        limited = joint.type == "continuous" and both & joint.limits.keys()
        if joint.name in half or limited or (ranged and not both <= joint.limits.keys()):
            yield joint.name


def _negative(document: UrdfDocument) -> Iterator[str]:
    """Joints with a negative limit of velocity, or, where an actuator drives them, of effort."""
    driven = {each.joint for each in document.transmissions if "SimpleTransmission" in each.type}
    for fault in document.faults:
        if fault.kind == "limit" and (fault.attribute == "velocity" or fault.name in driven):
            yield fault.name


def _damped(document: UrdfDocument) -> Iterator[str]:
    """Joints that move, with negative damping."""
    for fault in document.faults:
        joint = document.joints.get(fault.name)
        negative = fault.kind == "dynamics" and fault.attribute == "damping"
        if negative and joint is not None and joint.moves and joint.type != "floating":
            yield fault.name


def _names_version(document: UrdfDocument) -> Iterator[str]:
    """The robot, if it names the version of its format."""
    if document.names_version:
        yield document.name


def _transmission(document: UrdfDocument) -> Iterator[str]:
    """Simple transmissions without a joint or an actuator of their own; Drake skips those without effort."""
    drivers = set[str]()
    for each in document.transmissions:
        joint = document.joints.get(each.joint)
        if each.type and "SimpleTransmission" not in each.type:
            continue
        if not each.type or joint is None or not each.actuator or each.actuator in drivers:
            yield each.name or document.name
        elif joint.moves and joint.limits.get("effort", 1.0) > 0.0:
            drivers.add(each.actuator)


DRAKE_RULES = (
    Rule("drake-version", (DRAKE,), Behaviour.WARN,
         "the version is ignored, with a warning",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::Parse", _names_version),
    Rule("drake-number", (DRAKE,), Behaviour.REFUSE,
         "an attribute does not start with as many numbers as there should be",
         "drake: multibody/parsing/detail_tinyxml.cc, ConvertToDoubles", _numbers(False)),
    Rule("drake-rest", (DRAKE,), Behaviour.ALTER,
         "what stands behind the numbers of an attribute is skipped without a word: of 1,5 there remains 1",
         "drake: multibody/parsing/detail_tinyxml.cc, ConvertToDoubles", _numbers(True)),
    Rule("drake-massless", (DRAKE,), Behaviour.ALTER,
         "an <inertial> without a mass is that of a link without mass, or of 1 kg of water where it has moments",
         "drake: multibody/parsing/detail_common.cc, ParseSpatialInertia",
         faults("mass", lambda fault: fault.missing or fault.element == "inertial")),
    Rule("drake-axis", (DRAKE,), Behaviour.REFUSE,
         "an axis is shorter than 1e-8",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseJoint", shorter_axis(1e-8)),
    Rule("drake-range", (DRAKE,), Behaviour.ALTER,
         "an end of a range that is left out is no limit, and the range of a continuous joint limits it",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseJointLimits", _open),
    Rule("drake-damping", (DRAKE,), Behaviour.REFUSE,
         "damping is negative",
         "drake: multibody/tree/revolute_joint.h, RevoluteJoint", _damped),
    Rule("drake-planar", (DRAKE,), Behaviour.REFUSE,
         "a planar joint has damping, of which there should be three numbers",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseJoint",
         joints(lambda joint: joint.type == "planar" and joint.damping.exact != 0)),
    Rule("drake-name", (DRAKE,), Behaviour.REFUSE,
         "the robot's name is empty",
         "drake: multibody/tree/model_instance.cc, ModelInstance::set_name",
         faults("name", lambda fault: fault.tag == "robot")),
    Rule("drake-roots", (DRAKE,), Behaviour.ALTER,
         "the links are no tree with one root: each root is free in the world",
         "drake: multibody/plant/multibody_plant.cc, MultibodyPlant::Finalize", not_one_root),
    Rule("drake-reversed", (DRAKE,), Behaviour.REFUSE,
         "a lower limit is above the upper one",
         "drake: multibody/tree/joint.h, Joint", _reversed),
    Rule("drake-negative", (DRAKE,), Behaviour.REFUSE,
         "a limit of velocity is negative, or that of effort of a joint that an actuator drives",
         "drake: multibody/tree/joint.h, Joint::set_velocity_limits; UrdfParser::ParseTransmission", _negative),
    Rule("drake-follow", (DRAKE,), Behaviour.REFUSE,
         "a <mimic> leads to no joint that could be followed",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseMimicTag", faults("mimic")),
    Rule("drake-loop", (DRAKE,), Behaviour.REFUSE,
         "there is a <loop_joint>",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::Parse",
         faults("not-modelled", lambda fault: fault.element == "loop_joint")),
    Rule("drake-not-modelled", (DRAKE,), Behaviour.ALTER,
         "an element that carries mechanics, or closes a loop, and is not Drake's own is skipped",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::Parse",
         faults("not-modelled", lambda fault: not fault.element.startswith(("loop_joint", "drake:")))),
    Rule("drake-transmission", (DRAKE,), Behaviour.REFUSE,
         "a SimpleTransmission has no joint that exists, no actuator, or the actuator of another one",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseTransmission", _transmission),
)  # fmt: skip
