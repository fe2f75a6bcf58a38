"""The words of URDF, and where they may stand: a word elsewhere, or misspelt, would be skipped without a sound.

Every parser of URDF skips what it does not know, so `<inertail>` makes a link without mass and `<limit uper="1">` a
limit of 0. Extensions are let through: elements in a link, a joint or the robot, attributes of <limit> and <dynamics>,
and whatever stands inside <gazebo>, <transmission>, ..., as long as they do not resemble a word of URDF.
"""

from __future__ import annotations

from difflib import get_close_matches
from functools import lru_cache
from typing import Any

from rttrr_pin.errors import UrdfError, shortened

CHILDREN = {
    "robot": ("link", "joint", "material", "transmission", "gazebo"),
    "link": ("inertial", "visual", "collision"),
    "joint": ("origin", "parent", "child", "axis", "calibration", "dynamics", "limit", "mimic", "safety_controller"),
    "inertial": ("origin", "mass", "inertia"),
}
"""The elements of each element that dynamics are read from."""

ATTRIBUTES = {
    "robot": ("name",),
    "link": ("name",),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy"),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "axis": ("xyz",),
    "parent": ("link",),
    "child": ("link",),
    "limit": ("lower", "upper", "effort", "velocity"),
    "dynamics": ("damping", "friction"),
    "mimic": ("joint", "multiplier", "offset"),
}
"""The attributes of each element that dynamics are read from."""

CLOSED = ("inertial", "origin", "mass", "inertia", "axis", "parent", "child")
"""Elements that take no extension: whatever else stands in them is meant to change these numbers."""

MISPLACED = ("link", "joint", "inertial", "mass", "inertia", "axis", "limit", "mimic", "parent", "child", "dynamics")
"""Words that may not stand where URDF does not look for them, in the elements of `CHILDREN`."""

OTHER_FORMATS = ("gazebo", "transmission", "ros2_control", "sensor", "plugin")
"""Elements whose content is another format's, with links and joints of its own."""

OTHER_ROOTS = {
    "mujoco": "this is MJCF, which load, validate, ... take as the path of an .xml file; here a URDF is needed",
    "sdf": "this is SDF, which is not read: convert it to URDF",
}
"""What other formats begin with, and the way on."""

EXPANDED_FIRST = {
    "http://www.ros.org/wiki/xacro": "xacro, which must be expanded: name the file .xacro, or run xacro on it",
    "http://wiki.ros.org/xacro": "xacro, which must be expanded: name the file .xacro, or run xacro on it",
    "http://www.w3.org/2001/XInclude": "an XInclude, which must be expanded: put the included text in its place",
}
"""Namespaces whose elements stand for others."""

SIMILAR = 0.8
"""Ratio of `difflib` from which a word is taken for a misspelling."""


def check_words(root: Any, source: str) -> None:
    """Refuse what a parser would skip although it was meant to count.

    Raises:
        UrdfError: a word that is misspelt, out of place, in a namespace, or text where URDF has none; with its line.
    """
    if root.tag != "robot":
        fix = OTHER_ROOTS.get(root.tag, "is this a URDF?")
        raise UrdfError(
            f"the outermost element is <{_shown(root)}>, expected <robot>: {fix}",
            source=source,
            line=root.sourceline,
        )
    for element in root.iter("{*}*"):
        namespace, _, word = element.tag.rpartition("}")
        if namespace[1:] in EXPANDED_FIRST:
            raise _error(source, element, f"is {EXPANDED_FIRST[namespace[1:]]}")
        if word.lower() in ("link", "joint") and element.getparent() is not root and _is_body(element):
            raise _error(source, element, f"stands in <{_shown(element.getparent())}>: move it up into <robot>")
    _check(root, source)
    for body in (*root.findall("link"), *root.findall("joint")):
        _check(body, source)
        for part in body:
            if part.tag in CHILDREN["joint" if body.tag == "joint" else "link"] and part.tag in (
                *CHILDREN,
                *ATTRIBUTES,
            ):
                _check(part, source)
                for number in part:
                    _check(number, source)


def _is_body(element: Any) -> bool:
    """Whether this is a link or joint of the tree, and not a mention of one in another format."""
    parts = {child.tag.rpartition("}")[2] for child in element.iterchildren("{*}*")}
    tree = {"inertial", "visual", "collision"} if element.tag.lower().endswith("link") else {"parent", "child"}
    return bool(parts & tree) and not any(above.tag in OTHER_FORMATS for above in element.iterancestors())


def _check(element: Any, source: str) -> None:
    """The attributes, the children and the text of one element."""
    attributes, children = ATTRIBUTES.get(element.tag, ()), CHILDREN.get(element.tag, ())
    closed = element.tag in CLOSED
    for name in element.attrib:
        if name not in attributes and (fix := _meant(name, attributes, (), closed)):
            raise _error(source, element, f"has an attribute {shortened(name)}{fix}")
    for child in element.iterchildren("{*}*"):
        if child.tag not in children and (fix := _meant(child.tag, children, MISPLACED, closed)):
            raise _error(source, child, f"has no place in <{element.tag}>{fix}")
    for text in (element.text, *(child.tail for child in element)):
        if text and text.strip():
            raise _error(
                source, element, f"holds the text {shortened(text.strip())!r}: URDF keeps values in attributes"
            )


@lru_cache(maxsize=1000)
def _meant(tag: str, known: tuple[str, ...], misplaced: tuple[str, ...], closed: bool) -> str:
    """What is wrong with an unknown word; empty if it is an extension."""
    word = tag.rpartition("}")[2].lower().strip()
    if word in known and tag.startswith("{"):
        return ": write it without a namespace"
    close = get_close_matches(word[:40], known, n=1, cutoff=SIMILAR)
    if close:
        return f": did you mean {close[0]}?"
    if closed:
        return f": expected {', '.join(known) or 'none'}"
    return ": URDF does not look for it there" if word in misplaced else ""


def _error(source: str, element: Any, message: str) -> UrdfError:
    """At the element, and in the link or joint that holds it."""
    holder = next((above for above in element.iterancestors("link", "joint")), None)
    label = "" if holder is None else f'{holder.tag} "{holder.get("name")}"'
    return UrdfError(f"<{_shown(element)}> {message}", source=source, line=element.sourceline, element=label)


def _shown(element: Any) -> str:
    """The tag as the file writes it."""
    word = element.tag.rpartition("}")[2]
    return shortened(f"{element.prefix}:{word}" if element.prefix else word)
