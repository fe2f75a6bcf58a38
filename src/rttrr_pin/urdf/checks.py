"""What a URDF must fulfil before anything is computed with it; each rule says what it got and how to mend it.

Nothing is guessed. What the format itself defines where it is left out is taken as defined: an <origin>, also that of
an <inertial>, is the identity (so the centre of mass is at the link's origin), lower and upper limits are 0, a
multiplier is 1. One default is refused all the same: a joint that moves must name its <axis>, since 1 0 0 is so rarely
meant.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from typing import Any

from rttrr_pin.core.joints import JOINT_TYPES, JointType
from rttrr_pin.errors import UrdfError, nearest, shortened
from rttrr_pin.urdf.vocabulary import ATTRIBUTES, check_words

NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
"""A decimal number as XML Schema writes it, in ASCII; no unit, comma, hexadecimal digits, `nan` or `inf`."""

BETWEEN = re.compile("[ \t\r\n]+")
"""What stands between numbers: the blanks of XML, no others (Python knows more)."""

INERTIA_ENTRIES = ATTRIBUTES["inertia"]

LIMITS = ATTRIBUTES["limit"]

SUPPORTED = tuple(JOINT_TYPES)

LONGEST_CHAIN = 100
"""Joints that follow one another; to follow a chain takes time with the square of its length."""

CHILD_ONCE = {
    "link": ("inertial",),
    "joint": ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics"),
    "inertial": ("origin", "mass", "inertia"),
}
"""Elements of which URDF allows one; parsers silently take the first or the last of several."""


class Element:
    """An XML element with what is needed to say where it is."""

    def __init__(self, xml: Any, source: str, label: str) -> None:
        self.xml, self.source, self.label = xml, source, label

    def error(self, message: str) -> UrdfError:
        """An error at this element's line."""
        return UrdfError(message, source=self.source, line=self.xml.sourceline, element=self.label)

    def child(self, tag: str) -> Element | None:
        """The only child of that tag, if there is one."""
        children = self.xml.findall(tag)
        if len(children) > 1:
            raise self.error(f"has {len(children)} <{tag}> elements, expected at most one: remove the others")
        return Element(children[0], self.source, self.label) if children else None

    def needed(self, tag: str, why: str) -> Element:
        """The child of that tag, which must be there."""
        child = self.child(tag)
        if child is None:
            raise self.error(f"has no <{tag}>, {why}")
        return child

    def text(self, attribute: str, why: str) -> str:
        """An attribute that must be there and not be empty."""
        value = self.xml.get(attribute)
        if value is None or not value.strip():
            raise self.error(f"<{self.xml.tag}> has no {attribute}, {why}")
        return str(value)

    def numbers(self, attribute: str, count: int, default: str | None = None) -> list[float]:
        """`count` finite decimal numbers.

        Raises:
            UrdfError: there are more or fewer, or one of them is not a number that float64 can hold.
        """
        text = self.xml.get(attribute, default)
        if text is None:
            raise self.error(f'<{self.xml.tag}> has no {attribute}: write {attribute}="..." with the value')
        words = BETWEEN.split(text.strip(" \t\r\n")) if text.strip() else []
        where = f'<{self.xml.tag} {attribute}="{shortened(text)}">'
        if len(words) != count:
            raise self.error(f"{where} has {len(words)} values, expected {count}{_hint(text)}")
        return [self._number(word, where) for word in words]

    def _number(self, word: str, where: str) -> float:
        if not NUMBER.fullmatch(word):
            raise self.error(f"{where}: {shortened(word)!r} is not a decimal number{_hint(word)}")
        value = float(word)
        if not math.isfinite(value):
            raise self.error(f"{where}: {shortened(word)} is larger than float64 can hold: check the exponent")
        if value == 0.0 and re.search(r"[1-9]", re.split("[eE]", word)[0]):
            raise self.error(
                f"{where}: {shortened(word)} is smaller than float64 can hold: write 0, or check the exponent"
            )
        return value


def check_document(root: Any, source: str) -> None:
    """Hold a parsed document against the rules.

    Raises:
        UrdfError: the first rule that is broken, with line, element, value and fix.
    """
    check_words(root, source)
    robot = Element(root, source, "robot")
    robot.text("name", 'which URDF requires: write <robot name="...">')
    links = [_named(xml, source) for xml in root.findall("link")]
    joints = [_named(xml, source) for xml in root.findall("joint")]
    if not links:
        raise robot.error("has no <link>: a robot needs one at least")
    _check_unique(links)
    _check_unique(joints)
    for link in links:
        _check_link(link)
    for joint in joints:
        _check_joint(joint)
    _check_tree(robot, links, joints)
    _check_mimics(joints)


def _named(xml: Any, source: str) -> Element:
    """A link or joint, labelled by its name."""
    name = Element(xml, source, xml.tag).text("name", "which URDF requires")
    return Element(xml, source, f'{xml.tag} "{shortened(name)}"')


def _check_unique(elements: list[Element]) -> None:
    counts = Counter(element.xml.get("name") for element in elements)
    for element in elements:
        if counts[element.xml.get("name")] > 1:
            raise element.error(f"the name stands {counts[element.xml.get('name')]} times: give each its own")


def _check_once(element: Element) -> None:
    for tag in CHILD_ONCE[element.xml.tag]:
        element.child(tag)


def _check_link(link: Element) -> None:
    """Mass, centre of mass and tensor are all there, and are numbers."""
    _check_once(link)
    inertial = link.child("inertial")
    if inertial is None:
        return
    _check_once(inertial)
    _check_origin(inertial)
    inertial.needed("mass", 'which dynamics need: write <mass value="..."/> in kg').numbers("value", 1)
    tensor = inertial.needed("inertia", "which dynamics need: write its six entries in kg m^2")
    for entry in INERTIA_ENTRIES:
        tensor.numbers(entry, 1)


def _check_joint(joint: Element) -> None:
    """Type, placement, axis and limits."""
    _check_once(joint)
    kind = joint.text("type", f"expected one of {', '.join(SUPPORTED)}")
    if kind not in SUPPORTED:
        raise joint.error(f"type {kind!r} is not supported: {nearest(kind, SUPPORTED)}")
    _check_origin(joint)
    _check_dynamics(joint)
    joint_type = JOINT_TYPES[kind]
    if not joint_type.has_axis and joint_type.axis_direction is None:
        _check_unused(joint)
        return
    axis = joint.needed("axis", 'which a joint that moves needs: write <axis xyz="..."/>')
    if not any(axis.numbers("xyz", 3)):
        raise axis.error("its axis is 0 0 0, which has no direction: write a unit vector")
    if joint_type.axis_direction and not (axis.numbers("xyz", 3)[:2] == [0.0, 0.0] and axis.numbers("xyz", 3)[2] > 0.0):
        raise axis.error(
            "the axis of a planar joint is not along +z: URDF does not say which directions x and y then are; "
            "turn the joint by the rpy of its <origin> instead"
        )
    limit = joint.child("limit")
    if limit is not None:
        _check_limit(limit, joint_type)


def _check_unused(joint: Element) -> None:
    """What a joint without an axis has no use for must still be numbers."""
    axis, limit = joint.child("axis"), joint.child("limit")
    if axis is not None:
        axis.numbers("xyz", 3)
    for key in LIMITS:
        if limit is not None and key in limit.xml.attrib:
            limit.numbers(key, 1)


def _check_dynamics(joint: Element) -> None:
    """Damping and friction, where given, are numbers that are not negative."""
    dynamics = joint.child("dynamics")
    for key in ("damping", "friction"):
        if dynamics is not None and key in dynamics.xml.attrib and dynamics.numbers(key, 1)[0] < 0.0:
            raise dynamics.error(f"{key} is {dynamics.xml.get(key)}: expected a number that is not negative")


def _check_mimics(joints: list[Element]) -> None:
    """Each <mimic> names a joint with one coordinate, and following them comes to a joint that moves by itself."""
    by_name = {joint.xml.get("name"): joint for joint in joints}
    for joint in joints:
        mimic = joint.child("mimic")
        if mimic is None or JOINT_TYPES[joint.xml.get("type")].nv == 0:
            continue
        for key in ("multiplier", "offset"):
            mimic.numbers(key, 1, "0")
        seen = [joint.xml.get("name")]
        while mimic is not None:
            target = mimic.text("joint", "expected the name of the joint to follow")
            if target not in by_name:
                raise mimic.error(f"follows joint {target!r}, which does not exist: {nearest(target, by_name)}")
            for name in (seen[-1], target):
                if JOINT_TYPES[by_name[name].xml.get("type")].nq != 1:
                    raise mimic.error(
                        f"joint {name!r} is {by_name[name].xml.get('type')}: only joints with one coordinate follow"
                    )
            if target in seen:
                raise mimic.error(
                    f"follows itself through {' -> '.join([*seen, target])}: let one of them move by itself"
                )
            seen.append(target)
            if len(seen) > LONGEST_CHAIN:
                raise mimic.error(f"follows through more than {LONGEST_CHAIN} joints: let it follow the last of them")
            mimic = by_name[target].child("mimic")


def _check_limit(limit: Element, joint_type: JointType) -> None:
    set_ = {key: limit.numbers(key, 1)[0] for key in LIMITS if key in limit.xml.attrib}
    for key in ("velocity", "effort"):
        if set_.get(key, 0.0) < 0.0:
            raise limit.error(f"{key} limit is {set_[key]}: expected a positive number")
    if joint_type.limits != "none" and set_.get("lower", 0.0) > set_.get("upper", 0.0):
        raise limit.error(
            f"lower limit {set_.get('lower', 0.0)} is above the upper one, {set_.get('upper', 0.0)}: exchange them"
        )


def _check_origin(element: Element) -> None:
    origin = element.child("origin")
    if origin is not None:
        origin.numbers("xyz", 3, "0 0 0")
        origin.numbers("rpy", 3, "0 0 0")


def _check_tree(robot: Element, links: list[Element], joints: list[Element]) -> None:
    """Each link but one is the child of one joint, and all hang on that one."""
    names = {link.xml.get("name") for link in links}
    parent_of: dict[str, str] = {}
    for joint in joints:
        parent, child = (
            joint.needed(tag, "which every joint needs").text("link", "expected a link's name")
            for tag in ("parent", "child")
        )
        for tag, link in (("parent", parent), ("child", child)):
            if link not in names:
                raise joint.error(f"its {tag} link {link!r} does not exist: {nearest(link, sorted(names))}")
        if child in parent_of:
            raise joint.error(
                f"link {child!r} is already the child of another joint: a tree has one joint for each link"
            )
        parent_of[child] = parent
    roots = sorted(names - parent_of.keys())
    if len(roots) > 1:
        raise robot.error(
            f"has {len(roots)} root links ({', '.join(roots[:6])}), expected one: join them with fixed joints"
        )
    reached = _reachable(roots, parent_of)
    if len(reached) < len(names):
        loop = ", ".join(sorted(names - reached)[:6])
        raise robot.error(f"has a loop of joints through {loop}: a URDF is a tree; cut the loop at one joint")


def _reachable(roots: list[str], parent_of: dict[str, str]) -> set[str]:
    children: dict[str, list[str]] = {}
    for child, parent in parent_of.items():
        children.setdefault(parent, []).append(child)
    reached, waiting = set(roots), list(roots)
    while waiting:
        for child in children.get(waiting.pop(), []):
            reached.add(child)
            waiting.append(child)
    return reached


def _hint(text: str) -> str:
    """What is often meant by text that is no number."""
    if "," in text:
        return ": write a point for the decimals and spaces between values"
    if re.search(r"\d\s*[a-zA-Z]+$", text) and not text.lower().startswith(("0x", "-0x")):
        return ": write it without its unit (URDF is in m, kg, rad, s)"
    if "${" in text or "$(" in text:
        return ": this is xacro, run xacro on it first"
    return ": write digits with a point"
