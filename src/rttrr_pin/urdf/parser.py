"""From XML to a document: each element is checked as it is read, and each rule says what it got and how to mend it.

Nothing is guessed. What the format itself defines where it is left out is taken as defined: an <origin>, also that of
an <inertial>, is the identity (so the centre of mass is at the link's origin), lower and upper limits are 0, a
multiplier is 1. One default is refused all the same: a joint that moves must name its <axis>, since 1 0 0 is so rarely
meant.

A fault does not end the reading: it is logged with what was read in its place (`faults.py`), and in the end the log
decides. The tree of elements is changed to what was assumed, so that other programs can be handed the same robot.
"""

from __future__ import annotations

import re
from collections import Counter
from typing import Any

from lxml import etree

from rttrr_pin.core.joints import JOINT_TYPES, JointType
from rttrr_pin.errors import UrdfError, shortened
from rttrr_pin.urdf.decimals import Number, NumberList
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint, UrdfLink, UrdfMimic, UrdfShape
from rttrr_pin.urdf.elements import Element
from rttrr_pin.urdf.faults import Log
from rttrr_pin.urdf.inertial import ENTRIES, Placement, UrdfInertial
from rttrr_pin.urdf.limits import read_dynamics, read_limit
from rttrr_pin.urdf.sources import AS_IT_STANDS, AnySource, Reading, find
from rttrr_pin.urdf.tree import check_mimics, check_tree
from rttrr_pin.urdf.unused import check_asked, transmissions_of
from rttrr_pin.urdf.vocabulary import ATTRIBUTES, check_words, not_modelled
from rttrr_pin.urdf.xml_text import parse_xml

LONGEST_NAME = 10_000
"""Characters."""

SUPPORTED = tuple(JOINT_TYPES)

VERSIONS = ((1, 0), (1, 1), (1, 2))
"""Of the format: 1.1 brought quat_xyzw, 1.2 limits of acceleration, deceleration and jerk."""


def read_document(source: AnySource, reading: Reading = AS_IT_STANDS, tolerant: bool = False) -> UrdfDocument:
    """Read and check a robot's file.

    Args:
        source: a name, a path, a text, ...: see `sources.py`.
        reading: what the user allows.
        tolerant: whether to go on with what is left of any file, to list its faults.

    Raises:
        UnknownNameError: there is no such robot or file.
        InputError: the source is of another type, or an extra is missing.
        UrdfError: the file is no URDF, is damaged, or says something that has no dynamics; with line, element, value
            and fix.
    """
    file = find(source, reading)
    log = Log(file.name, reading.lenient)
    root = parse_xml(file, log)
    check_words(root, log)
    robot, names_version = Element(root, log), "version" in root.attrib
    for follower in root.findall("joint/mimic") if not reading.mimic else ():
        Element(follower, log).remove()
    name, version = _name(robot), _version(robot)
    links, joints = (_by_name(robot, tag) for tag in ("link", "joint"))
    if not links:
        fix = "a robot needs one at least; of a part of a robot, name the file that includes it"
        raise UrdfError(f"has no <link>: {fix}", source=file.name, line=robot.line, element="robot")
    read_links = {name: _link(name, link, version) for name, link in links.items()}
    pairs = ((name, _joint(name, joint, version)) for name, joint in joints.items())
    read_joints = {name: joint for name, joint in pairs if joint is not None}
    check_tree(read_links, read_joints, robot, joints)
    check_mimics(read_joints, joints)
    not_modelled(root, log)
    check_asked(robot, joints)
    transmissions = transmissions_of(robot, joints)
    if not tolerant:
        log.check()
    file_text = file.text.decode("utf-8-sig")
    rewritten = log.changed and (reading.lenient or not reading.mimic)
    return UrdfDocument(
        source=file.name,
        text=etree.tostring(root, encoding="unicode") if rewritten else file_text,
        file_text=file_text,
        folder=file.folder,
        name=name,
        version=version,
        names_version=names_version,
        links=read_links,
        joints=read_joints,
        transmissions=transmissions,
        faults=tuple(log.faults),
        packages=reading.packages,
        made_from=file.made_from,
    )


def _name(robot: Element) -> str:
    """The robot's name; nothing depends on it."""
    name = _short(robot)
    if not name:
        kind, has = ("name", "an empty") if "name" in robot.xml.attrib else ("unnamed", "no")
        robot.note(kind, f'<robot> has {has} name, and URDF requires one: write <robot name="...">')
        robot.write(name="robot")
    return name or "robot"


def _short(element: Element) -> str:
    """The name of an element, of a length that can be shown."""
    name = element.text("name")
    if len(name) > LONGEST_NAME:
        message = f"a name has {len(name):,} characters, expected {LONGEST_NAME:,} at most: give it a shorter one"
        raise UrdfError(message, source=element.log.source, line=element.line)
    return name


def _version(robot: Element) -> tuple[int, int]:
    """The version of the format, 1.0 where none is written; of another, what is known is read."""
    text = robot.xml.get("version", "1.0")
    match = re.fullmatch(r"\s*([0-9]{1,9})\.([0-9]{1,9})\s*", text)
    version = (int(match[1]), int(match[2])) if match else None
    if version is not None and version in VERSIONS:
        return version
    message = f"<robot version={shortened(text)!r}>: URDF has the versions 1.0, 1.1 and 1.2; write one of them"
    newest = VERSIONS[-1]
    robot.assume("version", message, f"version {newest[0]}.{newest[1]}")
    robot.write(version=f"{newest[0]}.{newest[1]}")
    return newest


def _by_name(robot: Element, tag: str) -> dict[str, Element]:
    """The links or joints by their names, which differ."""
    elements = robot.children(tag)
    named: dict[str, Element] = {}
    counts = Counter(element.text("name") for element in elements)
    for element in elements:
        element.tag, element.name = tag, _short(element)
        if not element.name:
            element.error("name", f"<{tag}> has no name, which URDF requires", "the element is left out")
        elif element.name not in named:
            named[element.name] = element
            if (times := counts[element.name]) > 1:
                element.error("name", f"the name stands {times} times: give each its own", "the first is read")
    return named


def _link(name: str, link: Element, version: tuple[int, int]) -> UrdfLink:
    inertial = link.child("inertial")
    shapes = [_shape(shape, version) for role in ("visual", "collision") for shape in link.xml.findall(role)]
    return UrdfLink(
        name=name,
        line=link.line,
        inertial=None if inertial is None else _inertial(inertial, version),
        shapes=tuple(shape for shape in shapes if shape is not None),
    )


def _inertial(inertial: Element, version: tuple[int, int]) -> UrdfInertial | None:
    """Mass, centre of mass and tensor; None where there is no mass."""
    origin = _placement(inertial, version)
    mass, tensor = inertial.child("mass"), inertial.child("inertia")
    problem = "has no <mass>, which dynamics need" if mass is None else mass.problem("value")
    if mass is None or problem:
        at = mass or inertial
        fix = ': write <mass value="..."/> in kg' if mass is None else ""
        at.assume("mass", problem + fix, "no <inertial>: a link without mass", "" if mass is None else "value")
        inertial.remove()
        return None
    if tensor is None:
        message = "has no <inertia>, which dynamics need: write its six entries in kg m^2"
        inertial.assume("inertia", message, "a point mass: the six entries are 0")
        tensor = inertial.added("inertia", **dict.fromkeys(ENTRIES, "0"))
    for entry in ENTRIES:
        if entry not in tensor.xml.attrib:
            tensor.assume("inertia", tensor.problem(entry), f'{entry}="0"', entry)
            tensor.write(**{entry: "0"})
    return UrdfInertial(origin, mass.number("value"), {name: tensor.number(name) for name in ENTRIES})


def _placement(element: Element, version: tuple[int, int]) -> Placement:
    origin = element.child("origin")
    if origin is None:
        return Placement()
    xyz = origin.numbers("xyz", 3, "0 0 0", "0 0 0")
    if "quat_xyzw" not in origin.xml.attrib:
        return Placement(xyz, origin.numbers("rpy", 3, "0 0 0", "0 0 0"))
    if version < (1, 1):
        message = "<origin> has an attribute quat_xyzw, which URDF has from version 1.1 on"
        origin.assume("quaternion", f'{message}: write <robot version="1.1">', "version 1.1")
        Element(origin.xml.getroottree().getroot(), origin.log).write(version="1.1")
    if "rpy" in origin.xml.attrib:
        message = "<origin> has both rpy and quat_xyzw: write one of them"
        origin.assume("rotations", message, "quat_xyzw")
        origin.log.changed = True
        del origin.xml.attrib["rpy"]
    quaternion = origin.numbers("quat_xyzw", 4, None, "0 0 0 1")
    if not any(number.exact for number in quaternion.each):
        message = "its quat_xyzw is 0 0 0 0, which is no rotation: write a unit quaternion"
        origin.assume("quaternion", message, "0 0 0 1, no rotation")
        origin.write(quat_xyzw="0 0 0 1")
        quaternion = NumberList("0 0 0 1")
    return Placement(xyz, quaternion=quaternion)


def _shape(xml: Any, version: tuple[int, int]) -> UrdfShape | None:
    """A shape; None where its element is empty or its placement is no placement, which dynamics do not depend on."""
    shape = next((tag for tag in xml.findall("geometry/*") if isinstance(tag.tag, str)), None)
    if shape is None:
        return None
    draft = Element(etree.Element(xml.tag), Log(""))
    if (origin := xml.find("origin")) is not None:
        words = ATTRIBUTES["origin"] if version >= (1, 1) else ("xyz", "rpy")
        draft.added("origin", **{key: origin.get(key) for key in words if key in origin.attrib})
    placement = _placement(draft, version)
    return None if draft.log.faults else UrdfShape(xml.tag, shape.tag, dict(shape.attrib), placement)


def _joint(name: str, joint: Element, version: tuple[int, int]) -> UrdfJoint | None:
    """A joint; None where it joins nothing, or in no way that is known."""
    left_out = "the joint is left out"
    type_name = joint.text("type")
    if type_name not in SUPPORTED:
        what = f"type {type_name!r} is not supported" if type_name else "<joint> has no type"
        fix = joint.nearest(type_name, SUPPORTED) if type_name else f"expected one of {', '.join(SUPPORTED)}"
        joint.error("joint", f"{what}: {fix}", left_out)
        return None
    joint_type = JOINT_TYPES[type_name]
    ends = []
    for tag in ("parent", "child"):
        element = joint.child(tag)
        link = "" if element is None else element.text("link")
        if not link:
            has = f"has no <{tag}>, which every joint needs" if element is None else f"<{tag}> has no link"
            joint.error("joint", f'{has}: write <{tag} link="..."/>', left_out)
            return None
        ends.append(link)
    return UrdfJoint(
        name=name,
        line=joint.line,
        type=type_name,
        parent=ends[0],
        child=ends[1],
        origin=_placement(joint, version),
        axis=_axis(joint, joint_type),
        limit=read_limit(joint, joint_type, version),
        mimic=_mimic(joint, joint_type),
        **read_dynamics(joint),
    )


def _axis(joint: Element, joint_type: JointType) -> NumberList:
    """The axis of a joint that has one; 1 0 0 where the file does not say, or +z for a planar joint."""
    axis = joint.child("axis", used=joint_type.has_direction)
    if not joint_type.has_direction:
        if axis is not None and (problem := axis.problem("xyz", 3)):
            axis.note("unused", problem, "xyz")
        return NumberList("1 0 0")
    default = "0 0 1" if joint_type.axis_direction else "1 0 0"
    if axis is None:
        message = 'has no <axis>, which a joint that moves needs: write <axis xyz="..."/>'
        joint.assume("axis", message, f'<axis xyz="{default}"/>')
        return NumberList(joint.added("axis", xyz=default).xml.get("xyz"))
    vector = axis.numbers("xyz", 3, None, default)
    x, y, z = vector.floats
    message = ""
    if not any((x, y, z)):
        message = "its axis is 0 0 0, which has no direction: write a unit vector"
    elif joint_type.axis_direction and not (x == y == 0.0 < z):
        message = (
            "the axis of a planar joint is not along +z: URDF does not say which directions x and y then are; "
            "turn the joint by the rpy of its <origin> instead"
        )
    if message:
        axis.assume("direction", message, f'<axis xyz="{default}"/>')
        axis.write(xyz=default)
        return NumberList(default)
    return vector


def _mimic(joint: Element, joint_type: JointType) -> UrdfMimic | None:
    """What a joint follows; that of a fixed joint counts for nothing, and may say anything."""
    mimic = joint.child("mimic", used=joint_type.nv > 0)
    if mimic is None:
        return None
    if joint_type.nv == 0:
        words = mimic.xml.attrib
        return UrdfMimic(words.get("joint", ""), Number(words.get("multiplier", "1")), Number(words.get("offset", "0")))
    multiplier, offset = mimic.number("multiplier", "1", "1"), mimic.number("offset", "0")
    return UrdfMimic(mimic.text("joint"), multiplier, offset)
