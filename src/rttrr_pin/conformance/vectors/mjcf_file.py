"""A robot as MJCF, MuJoCo's format, and the proof that it is the same robot as its URDF.

MuJoCo's `euler` with `eulerseq="XYZ"` (capitals: about fixed axes) is URDF's rpy, its `axis` is of any length as URDF's
is, and so nearly all numbers are those of the URDF, double by double. A full tensor in turned axes, which MJCF has no
words for, is written in link axes, each entry the double nearest to the true one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from flint import arb

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import CONTINUOUS, FIXED, FLOATING, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Model
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.exact.parameters import exact_parameters
from rttrr_pin.urdf.decimals import NumberList
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.inertial import NO_INERTIAL, Placement, UrdfInertial
from rttrr_pin.urdf.writer import written

TYPES = {REVOLUTE: "hinge", CONTINUOUS: "hinge", PRISMATIC: "slide"}
"""MuJoCo's words for the joints that it has in URDF's sense."""

EFFECTS = {"armature": "armature", "damping": "damping", "friction": "frictionloss"}
"""MuJoCo's words for what a joint itself takes."""

FULL = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Row and column of the entries of `fullinertia`."""

LEAST = 1e-15
"""Mass and moments of a moving body below which MuJoCo refuses it."""

BITS = 256
NEAREST = Fraction(1, 2**53)
"""Of a number, how far the double nearest to it is away at most."""


@dataclass(frozen=True, slots=True)
class Mjcf:
    """A robot as MJCF.

    Attributes:
        text: the file; empty where MuJoCo has no words for the robot.
        reason: why there is none; empty where there is one.
        proven: by what was compared, in what sense it is that of the URDF.
    """

    text: str = ""
    reason: str = ""
    proven: dict[str, str] = field(default_factory=dict)


def as_mjcf(model: Model) -> Mjcf:
    """The MJCF of a robot that was read from a URDF.

    Args:
        model: the robot; armature, damping and friction are those of its joints, gravity is its own.
    """
    document = model.document
    assert isinstance(document, UrdfDocument)
    for reason in _inexpressible(model):
        return Mjcf(reason=reason)
    text = _text(model, document, _true_tensors(model))
    if found := list(differences(text, model)):
        return Mjcf(reason=f"it could not be proven equal to the URDF: {'; '.join(found)}")
    return Mjcf(text, proven=_proven(model, document))


def _inexpressible(model: Model) -> Iterator[str]:
    """What of a robot MuJoCo has no words for, or refuses."""
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None:
            yield f"joint {joint.name} follows another, which is a soft constraint in MuJoCo"
        elif joint.type not in (*TYPES, FIXED) and not (model.floating and i == 0):
            yield f"joint {joint.name} is {joint.type}, which MuJoCo has no joint for below a body"
    for link in model.links:
        if link.name == "world":
            yield "a link is called world, as MuJoCo's own is"
    mass = [link.mass for link in model.links]  # with all that is fixed to it outwards
    for i in reversed(range(len(model.joints))):
        joint, link = model.joints[i], model.links[i]
        if joint.type == FIXED and joint.parent >= 0:
            mass[joint.parent] += mass[i]
        elif joint.type != FIXED and mass[i] < LEAST:
            yield f"link {link.name} moves and has no mass, which MuJoCo refuses"
        moments = np.linalg.eigvalsh(link.inertia)
        massless = not (link.mass or link.inertia.any())
        if not massless and (moments[0] < LEAST or moments[0] + moments[1] < moments[2]):
            yield f"link {link.name} has a tensor that no body has, which MuJoCo refuses"


def _true_tensors(model: Model) -> list[list[arb]]:
    """By link the entries of `fullinertia` in link axes, as intervals."""
    with precision(BITS):
        bodies = exact_parameters(model, "read").bodies(INTERVAL, lambda square: interval(square).rsqrt())
        rows: list[Any] = [[list(row) for row in body.I.rows] for body in bodies]
        return [[arb(own[i][k]) for i, k in FULL] for own in rows]


def _text(model: Model, document: UrdfDocument, tensors: list[list[arb]]) -> str:
    root = ET.Element("mujoco", model=model.name or "robot")
    words = {"angle": "radian", "eulerseq": "XYZ", "inertiafromgeom": "false", "balanceinertia": "false"}
    ET.SubElement(root, "compiler", words | {"fusestatic": "false"})
    ET.SubElement(root, "option", gravity=written(model.gravity))
    world = ET.SubElement(root, "worldbody")
    fixed_root = world if model.root.name == "world" or model.floating else _body(world, model.root.name, Placement())
    bodies: list[ET.Element] = []
    for joint, link, tensor in zip(model.joints, model.links, tensors, strict=True):
        own = document.joints.get(joint.name)  # the joint of a floating base is in no file
        parent = fixed_root if joint.parent < 0 else bodies[joint.parent]
        body = _body(parent, link.name, own.origin if own else Placement())
        inertial = document.links[link.name].inertial or NO_INERTIAL
        if link.mass or link.inertia.any():
            _inertial(body, inertial, tensor)
        if own is None:
            ET.SubElement(body, "freejoint", name=joint.name)
        elif joint.type != FIXED:
            effects = {word: written([value]) for word, value in _effects(joint).items() if value}
            words = {"type": TYPES[joint.type], "axis": written(own.axis.floats)}
            ET.SubElement(body, "joint", {"name": joint.name} | words | effects)
        bodies.append(body)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _effects(joint: Joint) -> dict[str, float]:
    return {word: float(getattr(joint.effects, key)) for key, word in EFFECTS.items()}


def _body(parent: ET.Element, name: str, origin: Placement) -> ET.Element:
    return ET.SubElement(parent, "body", {"name": name, "pos": written(origin.xyz.floats)} | _turn(origin))


def _turn(origin: Placement) -> dict[str, str]:
    """Of a body or a diagonal tensor; MuJoCo has the real part of a quaternion first."""
    if origin.quaternion is not None:
        x, y, z, w = origin.quaternion.floats
        return {"quat": written([w, x, y, z])}
    return {"euler": written(origin.rpy.floats)} if any(origin.rpy.floats) else {}


def _inertial(body: ET.Element, inertial: UrdfInertial, tensor: list[arb]) -> None:
    words = {"mass": written([float(inertial.mass)]), "pos": written(inertial.origin.xyz.floats)}
    entries = [inertial.tensor[at] for at in FULL]
    if not any(entries[3:]):
        words |= _turn(inertial.origin) | {"diaginertia": written(entries[:3])}
    elif _turn(inertial.origin):
        words["fullinertia"] = written(map(float, tensor))
    else:
        words["fullinertia"] = written(entries)
    ET.SubElement(body, "inertial", words)


# The proof: the text is read anew, and each of its numbers compared with the URDF's.


def differences(text: str, model: Model) -> Iterator[str]:
    """What of the text of an MJCF is not the robot; its doubles are rationals here, turned tensors intervals."""
    document, tensors, root = model.document, _true_tensors(model), ET.fromstring(text)
    assert isinstance(document, UrdfDocument)
    compiler = root.find("compiler")
    if compiler is None or compiler.get("angle") != "radian" or compiler.get("eulerseq") != "XYZ":
        yield "angles"
    if _numbers(root.find("option"), "gravity") != [Fraction(float(x)) for x in model.gravity]:
        yield "gravity"
    above = {child: parent for parent in root.iter() for child in parent}
    bodies = {body.get("name"): body for body in root.iter("body")}
    if bodies.keys() - {model.root.name} != set(model.link_names):
        yield "the names of the links"
        return
    if model.root.name in bodies and not model.floating and not _same_placement(bodies[model.root.name], Placement()):
        yield "the placement of the root"
    for joint, link, tensor in zip(model.joints, model.links, tensors, strict=True):
        body, own = bodies[link.name], document.joints.get(joint.name)
        parent = (model.root if joint.parent < 0 else model.links[joint.parent]).name
        if above[body] not in (bodies.get(parent), *([root.find("worldbody")] if joint.parent < 0 else [])):
            yield f"the parent of {link.name}"
        if not _same_placement(body, own.origin if own else Placement()):
            yield f"the placement of {link.name}"
        if not _same_inertial(body, document.links[link.name].inertial or NO_INERTIAL, tensor):
            yield f"mass, centre or tensor of {link.name}"
        if not _same_joint(body, joint, own.axis if own else None):
            yield f"the joint of {link.name}"


def _numbers(element: ET.Element | None, key: str, default: str = "") -> list[Fraction]:
    """The doubles that MuJoCo reads."""
    return [Fraction(float(word)) for word in (default if element is None else element.get(key, default)).split()]


def _of_file(numbers: NumberList) -> list[Fraction]:
    return [Fraction(x) for x in numbers.floats]


def _same_turn(element: ET.Element, origin: Placement) -> bool:
    if origin.quaternion is not None:
        x, y, z, w = _of_file(origin.quaternion)
        return _numbers(element, "quat") == [w, x, y, z]
    return "quat" not in element.attrib and _numbers(element, "euler", "0 0 0") == _of_file(origin.rpy)


def _same_placement(element: ET.Element, origin: Placement) -> bool:
    return _numbers(element, "pos", "0 0 0") == _of_file(origin.xyz) and _same_turn(element, origin)


def _same_inertial(body: ET.Element, inertial: UrdfInertial, tensor: list[arb]) -> bool:
    element = body.find("inertial")
    if element is None:
        return not (float(inertial.mass) or inertial.tensor.any())
    if _numbers(element, "mass") != [Fraction(float(inertial.mass))]:
        return False
    if _numbers(element, "pos") != _of_file(inertial.origin.xyz):
        return False
    entries = [Fraction(float(inertial.tensor[at])) for at in FULL]
    if "diaginertia" in element.attrib:
        return _same_turn(element, inertial.origin) and [*_numbers(element, "diaginertia"), 0, 0, 0] == entries
    full = _numbers(element, "fullinertia")
    if not _turn(inertial.origin):
        return full == entries
    with precision(BITS):
        pairs = zip(full, tensor, strict=True)
        return all(abs(interval(x) - true) <= interval(NEAREST) * abs(true) for x, true in pairs)


def _same_joint(body: ET.Element, joint: Joint, axis: NumberList | None) -> bool:
    own = [child for child in body if child.tag in ("joint", "freejoint")]
    if joint.type == FIXED:
        return not own
    if len(own) != 1 or own[0].get("name") != joint.name:
        return False
    if joint.type == FLOATING or axis is None:
        return own[0].tag == "freejoint"
    numbers = {word: _numbers(own[0], word, "0") for word in EFFECTS.values()}
    return (
        own[0].get("type") == TYPES[joint.type]
        and _numbers(own[0], "axis") == _of_file(axis)
        and numbers == {word: [Fraction(value)] for word, value in _effects(joint).items()}
    )


def _proven(model: Model, document: UrdfDocument) -> dict[str, str]:
    """In what sense each part of the robot is the same."""
    same = "the same doubles"
    turned = [
        name
        for name in model.link_names
        if (own := document.links[name].inertial) and _turn(own.origin) and _off_diagonal(own.tensor)
    ]
    in_link_axes = f"the same doubles, but those of {', '.join(turned)}, which are in link axes here: each entry is "
    tensors = in_link_axes + "the double nearest to the true one, at most 2^-53 of it away" if turned else same
    return {
        "tree, names, joint types": "the same",
        "placements (pos, euler)": same,
        "axes": same,
        "masses, centres of mass": same,
        "tensors": tensors,
        "armature, damping, friction": same,
        "gravity": same,
    }


def _off_diagonal(tensor: Array) -> bool:
    return bool((tensor - np.diag(np.diag(tensor))).any())
