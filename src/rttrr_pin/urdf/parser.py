"""From XML to a document: each element is checked as it is read, and each rule says what it got and how to mend it.

Nothing is guessed. What the format itself defines where it is left out is taken as defined: an <origin>, also that of
an <inertial>, is the identity (so the centre of mass is at the link's origin), lower and upper limits are 0, a
multiplier is 1. One default is refused all the same: a joint that moves must name its <axis>, since 1 0 0 is so rarely
meant.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from rttrr_pin.core.joints import JOINT_TYPES, JointType
from rttrr_pin.errors import nearest, shortened
from rttrr_pin.urdf.decimals import Number, NumberList
from rttrr_pin.urdf.document import Placement, UrdfDocument, UrdfInertial, UrdfJoint, UrdfLink, UrdfMimic, UrdfShape
from rttrr_pin.urdf.elements import Element, parse_xml
from rttrr_pin.urdf.sources import AS_IT_STANDS, AnySource, Reading, find
from rttrr_pin.urdf.vocabulary import ATTRIBUTES, check_words

SUPPORTED = tuple(JOINT_TYPES)

LONGEST_CHAIN = 100
"""Joints that follow one another; to follow a chain takes time with the square of its length."""


def read_document(source: AnySource, reading: Reading = AS_IT_STANDS) -> UrdfDocument:
    """Read and check a robot's file.

    Args:
        source: a name, a path, a text, ...: see `sources.py`.
        reading: what the user allows.

    Raises:
        UnknownNameError: there is no such robot or file.
        InputError: the source is of another type, or an extra is missing.
        UrdfError: the file is no URDF, is damaged, or says something that has no dynamics; with line, element, value
            and fix.
    """
    file = find(source, reading)
    root = parse_xml(file)
    check_words(root, file.name)
    robot = Element(root, file.name, "robot")
    name = robot.text("name", 'which URDF requires: write <robot name="...">')
    links, joints = (_by_name(robot, tag) for tag in ("link", "joint"))
    if not links:
        raise robot.error("has no <link>: a robot needs one at least")
    document = UrdfDocument(
        source=file.name,
        text=file.text.decode("utf-8-sig"),
        folder=file.folder,
        name=name,
        links={name: _link(name, link) for name, link in links.items()},
        joints={name: _joint(name, joint) for name, joint in joints.items()},
        made_from=file.made_from,
    )
    _check_tree(document, robot, joints)
    _check_mimics(document, joints)
    return document


def _by_name(robot: Element, tag: str) -> dict[str, Element]:
    """The links or joints, labelled by their names, which differ."""
    elements = robot.children(tag)
    names = [element.text("name", "which URDF requires") for element in elements]
    counts = Counter(names)
    for name, element in zip(names, elements, strict=True):
        element.label = f'{tag} "{shortened(name)}"'
        if counts[name] > 1:
            raise element.error(f"the name stands {counts[name]} times: give each its own")
    return dict(zip(names, elements, strict=True))


def _link(name: str, link: Element) -> UrdfLink:
    inertial = link.child("inertial")
    shapes = [_shape(shape) for role in ("visual", "collision") for shape in link.xml.findall(role)]
    return UrdfLink(
        name=name,
        line=link.line,
        inertial=None if inertial is None else _inertial(inertial),
        shapes=tuple(shape for shape in shapes if shape is not None),
    )


def _inertial(inertial: Element) -> UrdfInertial:
    """Mass, centre of mass and tensor are all there, and are numbers."""
    origin = _placement(inertial)
    mass = inertial.needed("mass", 'which dynamics need: write <mass value="..."/> in kg').number("value")
    tensor = inertial.needed("inertia", "which dynamics need: write its six entries in kg m^2")
    return UrdfInertial(origin, mass, {name: tensor.number(name) for name in ATTRIBUTES["inertia"]})


def _placement(element: Element) -> Placement:
    origin = element.child("origin")
    if origin is None:
        return Placement()
    return Placement(origin.numbers("xyz", 3, "0 0 0"), origin.numbers("rpy", 3, "0 0 0"))


def _shape(xml: Any) -> UrdfShape | None:
    """A shape; None where its element is empty or its placement is no placement, which dynamics do not depend on."""
    shape = next((tag for tag in xml.findall("geometry/*") if isinstance(tag.tag, str)), None)
    attributes = {} if (origin := xml.find("origin")) is None else origin.attrib
    xyz, rpy = (NumberList(attributes.get(key, "0 0 0")) for key in ("xyz", "rpy"))
    try:
        placed = len(xyz.floats) == len(rpy.floats) == 3
    except ValueError:
        placed = False
    if shape is None or not placed:
        return None
    return UrdfShape(xml.tag, shape.tag, dict(shape.attrib), Placement(xyz, rpy))


def _joint(name: str, joint: Element) -> UrdfJoint:
    type_name = joint.text("type", f"expected one of {', '.join(SUPPORTED)}")
    if type_name not in SUPPORTED:
        raise joint.error(f"type {type_name!r} is not supported: {nearest(type_name, SUPPORTED)}")
    joint_type = JOINT_TYPES[type_name]
    parent, child = (
        joint.needed(tag, "which every joint needs").text("link", "expected a link's name")
        for tag in ("parent", "child")
    )
    return UrdfJoint(
        name=name,
        line=joint.line,
        type=type_name,
        parent=parent,
        child=child,
        origin=_placement(joint),
        axis=_axis(joint, joint_type),
        limit=_limit(joint, joint_type),
        mimic=_mimic(joint, joint_type),
        **_dynamics(joint),
    )


def _has_direction(joint_type: JointType) -> bool:
    return joint_type.has_axis or joint_type.axis_direction is not None


def _dynamics(joint: Element) -> dict[str, Number]:
    """Damping and friction, where given, are numbers that are not negative."""
    dynamics = joint.child("dynamics")
    numbers = {key: Number("0") for key in ATTRIBUTES["dynamics"]}
    for key in numbers:
        if dynamics is not None and key in dynamics.xml.attrib:
            numbers[key] = dynamics.number(key)
            if float(numbers[key]) < 0.0:
                raise dynamics.error(f"{key} is {numbers[key].text}: expected a number that is not negative")
    return numbers


def _axis(joint: Element, joint_type: JointType) -> NumberList:
    """The axis of a joint that has one; what is written for another joint must be numbers all the same."""
    if not _has_direction(joint_type):
        unused = joint.child("axis")
        return NumberList("1 0 0") if unused is None else unused.numbers("xyz", 3)
    axis = joint.needed("axis", 'which a joint that moves needs: write <axis xyz="..."/>')
    vector = axis.numbers("xyz", 3)
    x, y, z = vector.floats
    if not any((x, y, z)):
        raise axis.error("its axis is 0 0 0, which has no direction: write a unit vector")
    if joint_type.axis_direction and not (x == y == 0.0 < z):
        raise axis.error(
            "the axis of a planar joint is not along +z: URDF does not say which directions x and y then are; "
            "turn the joint by the rpy of its <origin> instead"
        )
    return vector


def _limit(joint: Element, joint_type: JointType) -> dict[str, Number] | None:
    """Those limits that are written; of a joint that has no use for them they must still be numbers."""
    limit = joint.child("limit")
    if limit is None:
        return None
    numbers = {key: limit.number(key) for key in ATTRIBUTES["limit"] if key in limit.xml.attrib}
    if not _has_direction(joint_type):
        return numbers
    values = dict.fromkeys(ATTRIBUTES["limit"], 0.0) | {key: float(number) for key, number in numbers.items()}
    for key in ("velocity", "effort"):
        if values[key] < 0.0:
            raise limit.error(f"{key} limit is {values[key]}: expected a positive number")
    lower, upper = values["lower"], values["upper"]
    if joint_type.limits != "none" and lower > upper:
        raise limit.error(f"lower limit {lower} is above the upper one, {upper}: exchange them")
    return numbers


def _mimic(joint: Element, joint_type: JointType) -> UrdfMimic | None:
    """What a joint follows; that of a fixed joint counts for nothing, and may say anything."""
    mimic = joint.child("mimic")
    if mimic is None:
        return None
    if joint_type.nv == 0:
        words = mimic.xml.attrib
        return UrdfMimic(words.get("joint", ""), Number(words.get("multiplier", "1")), Number(words.get("offset", "0")))
    multiplier, offset = mimic.number("multiplier", "1"), mimic.number("offset", "0")
    return UrdfMimic(mimic.text("joint", "expected the name of the joint to follow"), multiplier, offset)


def _check_tree(document: UrdfDocument, robot: Element, joints: dict[str, Element]) -> None:
    """Each link but one is the child of one joint, and all hang on that one."""
    links, carried = document.links, set[str]()
    for joint in document.joints.values():
        element = joints[joint.name]
        for tag, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                raise element.error(f"its {tag} link {link!r} does not exist: {nearest(link, sorted(links))}")
        if joint.child in carried:
            raise element.error(
                f"link {joint.child!r} is already the child of another joint: a tree has one joint for each link"
            )
        carried.add(joint.child)
    roots = sorted(links.keys() - carried)
    if len(roots) > 1:
        raise robot.error(
            f"has {len(roots)} root links ({', '.join(roots[:6])}), expected one: join them with fixed joints"
        )
    # From a root no loop can be entered, since each link has one parent: the walk ends, and leaves the loops out.
    reached = {name for _, name in document.walk()} if roots else set()
    if len(reached) < len(links):
        loop = ", ".join(sorted(links.keys() - reached)[:6])
        raise robot.error(f"has a loop of joints through {loop}: a URDF is a tree; cut the loop at one joint")


def _check_mimics(document: UrdfDocument, joints: dict[str, Element]) -> None:
    """Each <mimic> names a joint with one coordinate, and following them comes to a joint that moves by itself."""
    for joint in document.joints.values():
        followed = [joint.name]
        while joint.moves and joint.mimic is not None:
            # The error stands at the link of the chain that is wrong, be it another joint's <mimic>.
            mimic, target = joints[joint.name].needed("mimic", ""), joint.mimic.joint
            if target not in document.joints:
                raise mimic.error(f"follows joint {target!r}, which does not exist: {nearest(target, document.joints)}")
            for follower in (joint, document.joints[target]):
                if JOINT_TYPES[follower.type].nq != 1:
                    raise mimic.error(
                        f"joint {follower.name!r} is {follower.type}: only joints with one coordinate follow"
                    )
            if target in followed:
                raise mimic.error(
                    f"follows itself through {' -> '.join([*followed, target])}: let one of them move by itself"
                )
            followed.append(target)
            if len(followed) > LONGEST_CHAIN:
                raise mimic.error(f"follows through more than {LONGEST_CHAIN} joints: let it follow the last of them")
            joint = document.joints[target]
