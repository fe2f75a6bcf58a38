"""The words of URDF, and where they may stand: a word elsewhere, or misspelt, would be skipped without a sound.

Every parser of URDF skips what it does not know, so `<inertail>` makes a link without mass and `<limit uper="1">` a
limit of 0. Extensions are let through: elements in a link, a joint or the robot, attributes of <limit> and <dynamics>,
and whatever stands inside <gazebo>, <transmission>, ..., as long as they do not resemble a word of URDF. A word that
resembles one which is there as well is skipped by everybody, and no number depends on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from functools import lru_cache
from typing import Any, NamedTuple

from rttrr_pin.errors import UrdfError, shortened
from rttrr_pin.urdf.decimals import Number
from rttrr_pin.urdf.elements import Element, shown
from rttrr_pin.urdf.faults import Level, Log

CHILDREN = {
    "robot": ("link", "joint", "material", "transmission", "gazebo"),
    "link": ("inertial", "visual", "collision"),
    "joint": ("origin", "parent", "child", "axis", "calibration", "dynamics", "limit", "mimic", "safety_controller"),
    "inertial": ("origin", "mass", "inertia"),
}
"""The elements of each element that dynamics are read from."""

ATTRIBUTES = {
    "robot": ("name", "version"),
    "link": ("name",),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy", "quat_xyzw"),
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

LIMITS_1_2 = ("acceleration", "deceleration", "jerk")
"""Attributes of <limit> from version 1.2 on."""

TRANSPOSED = {"iyx": "ixy", "izx": "ixz", "izy": "iyz"}
"""Entries of a tensor below its diagonal, which no parser reads."""

NEEDED = {"inertial": ("mass", "inertia"), "origin": ("xyz", "rpy"), "axis": ("xyz",)}
"""What an unknown word may stand for where it resembles no other: no number depends on it where they are there."""

CLOSED = ("inertial", "origin", "mass", "inertia", "axis", "parent", "child")
"""Elements that take no extension: whatever else stands in them is meant to change these numbers."""

MISPLACED = ("link", "joint", "inertial", "mass", "inertia", "axis", "limit", "mimic", "parent", "child", "dynamics")
"""Words that may not stand where URDF does not look for them, in the elements of `CHILDREN`."""

OTHER_FORMATS = ("gazebo", "transmission", "ros2_control", "sensor", "plugin")
"""Elements whose content is another format's, with links and joints of its own."""

DRAWN = ("visual", "collision", "material", *OTHER_FORMATS)
"""Elements in which nothing is read that a number of the model depends on."""

UNREAD = (*DRAWN, *LIMITS_1_2, "calibration", "safety_controller")
"""Words of URDF that no number of the model depends on."""

MECHANICS = (
    "loop",
    "constraint",
    "bushing",
    "spring",
    "damper",
    "tendon",
    "cable",
    "muscle",
    "coupling",
    "rotor",
    "gear",
)
"""Parts of names of elements that stand for forces, inertias, or for loops closed."""

ENDS = ({"parent", "child"}, {"link1", "link2"})
"""What an element holds that joins two links."""

OTHER_ROOTS = {
    "mujoco": "this is MJCF, which load, validate, ... take as the path of an .xml file; here a URDF is needed",
    "sdf": "this is SDF, which is not read: convert it to URDF",
}
"""What other formats begin with, and the way on."""

XACRO = ("http://www.ros.org/wiki/xacro", "http://wiki.ros.org/xacro", "http://ros.org/wiki/xacro", "xacro")
"""Namespaces of xacro; the last is the prefix where it is not declared."""

DECLARATIONS = ("property", "arg", "macro")
"""Elements of xacro that say nothing unless they are called."""

XINCLUDE = "http://www.w3.org/2001/XInclude"

SIMILAR = 0.8
"""Ratio of `difflib` from which a word is taken for a misspelling."""

EXPAND = "must be expanded: name the file .xacro, or run xacro on it"
INCLUDE = "put the included text in its place"
"""What to do about elements that stand for others."""


def check_words(root: Any, log: Log) -> None:
    """Log what a parser would skip although it was meant to count.

    Raises:
        UrdfError: the outermost element is no <robot>.
    """
    _strip_namespace(root, log)
    if root.tag != "robot":
        fix = OTHER_ROOTS.get(root.tag, "is this a URDF?")
        raise UrdfError(
            f"the outermost element is <{shown(root)}>, expected <robot>: {fix}",
            source=log.source,
            line=root.sourceline,
        )
    for element, inside in _outside_macros(root):
        _check_place(element, inside, log)
    _check(root, log)
    for body in (*root.findall("link"), *root.findall("joint")):
        _check(body, log)
        for part in body:
            if part.tag in CHILDREN[body.tag] and (part.tag in CHILDREN or part.tag in ATTRIBUTES):
                _check(part, log)
                for number in part:
                    _check(number, log)


def not_modelled(root: Any, log: Log) -> None:
    """Log the extensions that stand for mechanics: loops, springs, what else joins two links."""
    for parent in (root, *root.findall("link"), *root.findall("joint")):
        for child in parent.iterchildren("{*}*"):
            word = _split(child)[1].lower()
            if child.tag in CHILDREN[parent.tag] or word in DRAWN:
                continue
            holds = {_split(part)[1].lower() for part in child}
            joins = parent is root and any(ends <= holds for ends in ENDS) and word not in ("link", "joint")
            if joins or any(part in word for part in MECHANICS):
                _element(log, child).note(
                    "not-modelled", f"<{shown(child)}> is not modelled: what it stands for takes no part in any result"
                )


def _check_place(element: Any, inside: str, log: Log) -> None:
    """An element that stands for others, or a link or joint that stands in another element than the robot."""
    space, word = _split(element)
    above = element.getparent()
    if space in XACRO:
        _check_xacro(element, bool(inside) or word in DECLARATIONS, log)
    elif inside in OTHER_FORMATS:
        return
    elif space == XINCLUDE:
        _skipped(log, element, f"is an XInclude, which must be expanded: {INCLUDE}", "xacro")
    elif word.lower() in ("link", "joint") and above.getparent() is not None and _is_body(element):
        _skipped(log, element, f"stands in <{shown(above)}>: move it up into <robot>")


def _strip_namespace(root: Any, log: Log) -> None:
    """Take elements out of a default namespace, which parsers of URDF do not know."""
    stripped = None
    for element in root.iter("{*}*"):
        space, _, word = element.tag.rpartition("}")
        if space and element.prefix is None:
            element.tag = word
            stripped = stripped or (element, space[1:])
    if stripped:
        element, space = stripped
        _element(log, element).note(
            "namespace", f'<{shown(element)}> stands in the namespace {shortened(space)!r}: remove xmlns="..."'
        )


def _outside_macros(element: Any, inside: str = "") -> Iterator[tuple[Any, str]]:
    """The elements in one, but for those in macros, and in which drawing or other format each stands, if in any."""
    for child in element.iterchildren("{*}*"):
        yield child, inside
        space, word = _split(child)
        if not (space in XACRO and word in DECLARATIONS):
            yield from _outside_macros(child, inside or (word if word in DRAWN else ""))


def _check_xacro(element: Any, harmless: bool, log: Log) -> None:
    """A declaration that nobody uses changes nothing; a call stands for elements that are not there."""
    if harmless:
        _element(log, element).note("xacro", f"<{shown(element)}> is left over from xacro, and nothing depends on it")
    else:
        _skipped(log, element, f"is xacro, which {EXPAND}", "xacro")


def _split(element: Any) -> tuple[str, str]:
    """Namespace, or undeclared prefix, and word of a tag."""
    space, _, word = element.tag.rpartition("}")
    prefix, _, rest = word.rpartition(":")
    return space[1:] or prefix, rest


def _is_body(element: Any) -> bool:
    """Whether this is a link or joint of the tree, and not a mention of one in another format."""
    parts = {_split(child)[1] for child in element.iterchildren("{*}*")}
    tree = {"inertial", "visual", "collision"} if element.tag.lower().endswith("link") else {"parent", "child"}
    return bool(parts & tree)


def _check(element: Any, log: Log) -> None:
    """The attributes, the children and the text of one element."""
    attributes, children = ATTRIBUTES.get(element.tag, ()), CHILDREN.get(element.tag, ())
    attributes += LIMITS_1_2 if element.tag == "limit" else ()
    closed = element.tag in CLOSED
    unused = element.tag == "axis" and element.getparent().get("type") in ("fixed", "floating")
    for name in element.attrib:
        if name in attributes:
            continue
        if name in TRANSPOSED and element.tag == "inertia":
            _check_transposed(element, name, log)
        elif meant := _meant(name, attributes, (), closed):
            there = unused or _is_there(element, meant.word)
            _skipped(log, element, f"has an attribute {shortened(name)}{meant.fix}", "word", there)
    for child in element.iterchildren("{*}*"):
        if child.tag in children or _split(child)[0] in XACRO:
            continue
        if meant := _meant(child.tag, children, MISPLACED, closed):
            there = _counts_elsewhere(element, child, meant.word)
            _skipped(log, child, f"has no place in <{element.tag}>{meant.fix}", "word", there)
    for text in (element.text, *(child.tail for child in element)):
        if text and text.strip():
            message = f"holds the text {shortened(text.strip())!r}: URDF keeps values in attributes"
            valued = element.tag in ATTRIBUTES and element.tag not in CHILDREN and not element.attrib
            _skipped(log, element, message, "text", not valued)


def _check_transposed(element: Any, name: str, log: Log) -> None:
    """An entry below the diagonal: it is the one above, or one of the two is wrong."""
    own, other = element.get(name), element.get(TRANSPOSED[name])
    try:
        equal = other is not None and Number(own).exact == Number(other).exact
    except ArithmeticError:
        equal = own == other
    message = f"has {name}, which URDF does not: {TRANSPOSED[name]} stands for both"
    if not equal:
        message += f", and {shortened(own)} is not {'there' if other is None else shortened(other)}"
    _skipped(log, element, message, "products", equal)


class _Meant(NamedTuple):
    """The known word that an unknown one resembles, empty where it resembles none; and the fix."""

    word: str
    fix: str


@lru_cache(maxsize=1000)
def _meant(tag: str, known: tuple[str, ...], misplaced: tuple[str, ...], closed: bool) -> _Meant | None:
    """What is wrong with an unknown word; None if it is an extension."""
    word = tag.rpartition("}")[2].rpartition(":")[2].lower().strip()
    if word in known and word != tag.lower().strip():
        return _Meant(word, ": write it without a namespace")
    close = get_close_matches(word[:40], known, n=1, cutoff=SIMILAR)
    if close:
        return _Meant(close[0], f": did you mean {close[0]}?")
    if closed:
        return _Meant("", f": expected {', '.join(known) or 'none'}")
    return _Meant("", ": URDF does not look for it there") if word in misplaced else None


def _is_there(element: Any, word: str) -> bool:
    """Whether what an unknown word may stand for is there, or is read by nobody."""
    present = {*element.attrib, *(child.tag for child in element)}
    wanted = (word,) if word else NEEDED.get(element.tag, ("",))
    return word in UNREAD or all(other in present for other in wanted)


def _counts_elsewhere(element: Any, child: Any, word: str) -> bool:
    """Whether what stands in a wrong place, or is misspelt, stands in its own place too.

    There may be several links and joints: another one says nothing. Inertia in the robot belongs to no link.
    """
    if element.tag == "robot":
        return bool(child.tag == "inertial") or word in UNREAD
    elsewhere = element.find(f"inertial/{child.tag}") if child.tag in MISPLACED else None
    return elsewhere is not None or _is_there(element, word)


def _skipped(log: Log, element: Any, message: str, kind: str = "word", harmless: bool = False) -> None:
    """Log what parsers skip; `harmless` where no number depends on it."""
    level, assumed = (Level.NOTE, "") if harmless else (Level.ASSUMPTION, "it is skipped, as parsers do")
    _element(log, element).fault(kind, level, f"<{shown(element)}> {message}", assumed)


def _element(log: Log, element: Any) -> Element:
    """The element in the link or joint that holds it, or that it is."""
    above = (element, *element.iterancestors("link", "joint"))
    holder = next((each for each in above if each.tag in ("link", "joint")), None)
    return Element(element, log) if holder is None else Element(element, log, holder.tag, holder.get("name", ""))
