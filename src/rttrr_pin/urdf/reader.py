"""The strict URDF reader: what it hands on is what the file says, or an error with the line.

yourdfpy turns the XML into objects. Before that, every number that dynamics depend on is held against a grammar, since
parsers guess: `mass value="1,5"` becomes 0 in Pinocchio, a missing `izz` becomes 1 in yourdfpy.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint, JointEffects, Limits, Mimic
from rttrr_pin.core.joints import JOINT_TYPES, JointType
from rttrr_pin.core.model import Link, Model
from rttrr_pin.errors import InputError, UrdfError, shortened
from rttrr_pin.urdf.checks import check_document
from rttrr_pin.urdf.document import parse_xml
from rttrr_pin.urdf.sources import AnySource, Source, find

LOOKS = ("visual", "collision", "material", "calibration", "safety_controller")
"""Elements that yourdfpy parses and dynamics do not need."""


def read_urdf(source: AnySource) -> Model:
    """Read a robot.

    Args:
        source: a name, a path, a text, ...: see `sources.py`.

    Returns:
        The model, links and joints depth first, branches in alphabetical order of their joints (Pinocchio's order).

    Raises:
        UnknownNameError: there is no such robot or file.
        InputError: the source is of another type, or an extra is missing.
        UrdfError: the file is no URDF, is damaged, or says something that has no dynamics.
    """
    found = find(source)
    document = parse_xml(found)
    check_document(document, found.name)
    import yourdfpy

    _drop_looks(document)
    robot = yourdfpy.URDF(
        robot=yourdfpy.URDF._parse_robot(xml_element=document),  # the parser alone: no scene, no meshes
        build_scene_graph=False,
        load_meshes=False,
    ).robot
    return _model(robot, found, document)


def _drop_looks(document: Any) -> None:
    """Take out what does not enter dynamics: the rules have not looked at it, and yourdfpy would stumble over it."""
    for element in list(document.iter(*LOOKS)):
        element.getparent().remove(element)


@contextmanager
def _at(source: Source, document: Any, tag: str, name: str) -> Iterator[None]:
    """Where a link or joint is, for numbers so large that computing with them overflows."""
    try:
        yield
    except InputError as error:
        line = next(element.sourceline for element in document.iterfind(tag) if element.get("name") == name)
        message = f"its numbers are too large or too small to compute with ({error}): check their exponents"
        raise UrdfError(message, source=source.name, line=line, element=f'{tag} "{shortened(name)}"') from error


def _model(robot: Any, source: Source, document: Any) -> Model:
    """The tree in Pinocchio's order: depth first, joints alphabetically at each branch."""
    children: dict[str, list[Any]] = {}
    for joint in robot.joints:
        children.setdefault(joint.parent, []).append(joint)
    links = {link.name: link for link in robot.links}
    carried = {joint.child for joint in robot.joints}
    root = next(name for name in links if name not in carried)

    ordered: list[tuple[int, Any]] = []
    waiting = [(-1, joint) for joint in _last_first(children.get(root, []))]
    while waiting:
        parent, joint = waiting.pop()
        waiting += [(len(ordered), child) for child in _last_first(children.get(joint.child, []))]
        ordered.append((parent, joint))
    index = {joint.name: i for i, (_, joint) in enumerate(ordered)}
    bodies, joints = {}, []
    for name, link in links.items():
        with _at(source, document, "link", name):
            bodies[name] = _link(link)
    for parent, joint in ordered:
        with _at(source, document, "joint", joint.name):
            joints.append(_joint(joint, parent, _mimic(joint, ordered, index)))
    return Model(
        name=robot.name,
        root=bodies[root],
        links=tuple(bodies[joint.child] for _, joint in ordered),
        joints=tuple(joints),
        urdf=source.text.decode("utf-8-sig"),
    )


def _mimic(joint: Any, ordered: Sequence[tuple[int, Any]], index: dict[str, int]) -> Mimic | None:
    """Whom a joint follows in the end: chains of mimics are multiplied out."""
    if joint.mimic is None or JOINT_TYPES[joint.type].nv == 0:
        return None
    factor, shift, links = Fraction(1), Fraction(0), 0  # exact, so that a chain is rounded once
    while joint.mimic is not None:
        own = joint.mimic
        shift += factor * Fraction(0 if own.offset is None else float(own.offset))
        factor *= Fraction(1 if own.multiplier is None else float(own.multiplier))
        links += 1
        joint = ordered[index[own.joint]][1]
    try:
        multiplier, offset = float(factor), float(shift)
    except OverflowError:
        raise InputError("a chain of mimics has a multiplier or an offset that float64 cannot hold") from None
    return Mimic(index[joint.name], multiplier, offset, rounded=links > 1)


def _last_first(joints: Sequence[Any]) -> list[Any]:
    return sorted(joints, key=lambda joint: joint.name, reverse=True)


def _link(link: Any) -> Link:
    """A link; its tensor turned into the axes of the link frame."""
    inertial = link.inertial
    if inertial is None:
        return Link(link.name)
    R, com = _placement(inertial.origin)
    rotated = not np.array_equal(R, np.eye(3))
    inertia = inertial.inertia
    if rotated:
        with np.errstate(over="ignore", invalid="ignore"):  # Link refuses what is not finite
            inertia = R @ inertia @ R.T
            inertia = (inertia + inertia.T) / 2
    return Link(link.name, float(inertial.mass), com, inertia, rotated)


def _joint(joint: Any, parent: int, mimic: Mimic | None) -> Joint:
    """A joint on the link of index `parent`."""
    R, p = _placement(joint.origin)
    kind = JOINT_TYPES[joint.type]
    axis = np.asarray(joint.axis, dtype=float)
    if kind.has_axis or kind.axis_direction:
        axis = np.ldexp(axis, -np.frexp(np.abs(axis).max())[1])  # exact, and the squares can no more overflow
        axis = axis / np.linalg.norm(axis)
    return Joint(
        name=joint.name,
        type=kind,
        parent=parent,
        R=R,
        p=p,
        axis=axis,
        limits=_limits(joint.limit, kind),
        rotated=not np.array_equal(R, np.eye(3)),
        mimic=mimic,
        dynamics=_joint_effects(joint.dynamics),
        effects=_joint_effects(joint.dynamics),
    )


def _joint_effects(dynamics: Any) -> JointEffects:
    """Damping and friction of the file; URDF has no word for armature."""
    if dynamics is None:
        return JointEffects()
    return JointEffects(damping=float(dynamics.damping or 0.0), friction=float(dynamics.friction or 0.0))


def _placement(origin: Array | None) -> tuple[Array, Array]:
    """Rotation and translation of an <origin>, the identity where there is none."""
    if origin is None:
        return np.eye(3), np.zeros(3)
    return origin[:3, :3] + 0.0, origin[:3, 3]


def _limits(limit: Any, kind: JointType) -> Limits:
    """The limits that the file sets; an angle or length without one has the limit 0, a continuous joint's none."""
    if limit is None:
        return Limits()
    set_ = {key: getattr(limit, key) for key in ("lower", "upper", "velocity", "effort")}
    if kind.limits == "required":
        set_ |= {key: 0.0 for key in ("lower", "upper") if set_[key] is None}  # the format's own default
    if kind.limits == "none":
        set_["lower"] = set_["upper"] = None
    return Limits(**{key: float(value) for key, value in set_.items() if value is not None})
