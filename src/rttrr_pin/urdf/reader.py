"""The model that a document describes: what it holds is what the file says, or an error with the line."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction

import numpy as np

from rttrr_pin.core.joint import Joint, JointEffects, Limits, Mimic
from rttrr_pin.core.joints import JOINT_TYPES, JointType
from rttrr_pin.core.model import Link, Model, Note
from rttrr_pin.errors import InputError, UrdfError, shortened
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint, UrdfLink
from rttrr_pin.urdf.inertial import NO_INERTIAL
from rttrr_pin.urdf.parser import read_document
from rttrr_pin.urdf.sources import AS_IT_STANDS, AnySource, Reading, find

SMALLEST, LARGEST = sys.float_info.min, sys.float_info.max
"""Between them a product, rounded once, is right to half an eps; below, digits are lost, or all of it."""


def read_urdf(source: AnySource, reading: Reading = AS_IT_STANDS) -> Model:
    """Read a robot.

    Args:
        source: a name, a path, a text, ...: see `sources.py`.
        reading: what the user allows.

    Returns:
        The model, links and joints in Pinocchio's order (see `UrdfDocument.walk`), or in an object's own.

    Raises:
        UnknownNameError, InputError, UrdfError: as in `read_document`; UrdfError also where numbers overflow.
    """
    file = find(source, reading)
    document = read_document(file, reading)
    model = model_of(document)
    if file.model is not None:
        model = _completed(model, file.model)
    assumed = (Note(fault.sentence, left_out=True) for fault in document.remarks)
    return replace(model, notes=(*file.notes, *assumed))


def _completed(read: Model, own: Model) -> Model:
    """A model that was read from the text of an object, in the object's order, with what the text could not say."""
    links, joints = {link.name: link for link in read.links}, {joint.name: joint for joint in read.joints}
    completed = []
    for joint in own.joints:
        other = joints[joint.name]
        mimic = joint.mimic and other.mimic and replace(other.mimic, joint=joint.mimic.joint)
        completed.append(replace(other, parent=joint.parent, mimic=mimic, limits=joint.limits, effects=joint.effects))
    ordered = tuple(links[link.name] for link in own.links)
    return replace(read, links=ordered, joints=tuple(completed), gravity=own.gravity)


def model_of(document: UrdfDocument) -> Model:
    """The tree with its numbers as doubles: tensors in link axes, unit axes, chains of mimics multiplied out.

    Raises:
        UrdfError: numbers are so large or small that one of these overflows; with the line.
    """
    order = [document.carried_by[name] for _, name in document.walk() if name != document.root]
    index = {joint.name: i for i, joint in enumerate(order)}
    of_link = {joint.child: i for i, joint in enumerate(order)}
    links, joints = {}, []
    for name, link in document.links.items():
        with _located(document, "link", link):
            inertial = link.inertial or NO_INERTIAL
            origin = inertial.origin
            links[name] = Link(name, float(inertial.mass), origin.p, inertial.inertia, origin.rotated)
    for joint in order:
        with _located(document, "joint", joint):
            joints.append(_joint(joint, of_link.get(joint.parent, -1), _mimic(joint, document, index)))
    return Model(
        name=document.name,
        root=links[document.root],
        links=tuple(links[joint.child] for joint in order),
        joints=tuple(joints),
        document=document,
    )


@contextmanager
def _located(document: UrdfDocument, tag: str, element: UrdfLink | UrdfJoint) -> Iterator[None]:
    """Names the link or joint whose numbers are so large that computing with them overflows."""
    try:
        yield
    except InputError as error:
        message = f"its numbers are too large or too small to compute with ({error}): check their exponents"
        label = f'{tag} "{shortened(element.name)}"'
        raise UrdfError(message, source=document.source, line=element.line, element=label) from error


def _mimic(joint: UrdfJoint, document: UrdfDocument, index: dict[str, int]) -> Mimic | None:
    """Whom a joint follows in the end: chains of mimics are multiplied out."""
    leader, multiplier, offset, mimics = document.followed(joint, lambda number: Fraction(float(number)))
    if not mimics:
        return None
    numbers = multiplier, offset
    if mimics > 1 and not all(x == 0 or SMALLEST <= abs(x) <= LARGEST for x in numbers):
        raise InputError("a chain of mimics has a multiplier or an offset that float64 does not hold to its precision")
    return Mimic(index[leader.name], float(multiplier), float(offset), rounded=mimics > 1)


def _joint(joint: UrdfJoint, parent: int, mimic: Mimic | None) -> Joint:
    """A joint on the link of index `parent`."""
    joint_type = JOINT_TYPES[joint.type]
    axis = np.array(joint.axis.floats)
    if joint_type.has_direction:
        axis = np.ldexp(axis, -np.frexp(np.abs(axis).max())[1])  # exact, and the squares can no more overflow
        axis = axis / np.linalg.norm(axis)
    effects = JointEffects(damping=float(joint.damping), friction=float(joint.friction))  # URDF has no armature
    return Joint(
        name=joint.name,
        type=joint_type,
        parent=parent,
        R=joint.origin.R,
        p=joint.origin.p,
        axis=axis,
        limits=_limits(joint, joint_type),
        rotated=joint.origin.rotated,
        mimic=mimic,
        dynamics=effects,
        effects=effects,
    )


def _limits(joint: UrdfJoint, joint_type: JointType) -> Limits:
    """The limits that the file sets; an angle or length without one has the limit 0, a continuous joint's none."""
    limits = dict(joint.limits)
    if joint.limit is not None and joint_type.limits == "required":
        limits = {"lower": 0.0, "upper": 0.0} | limits  # the format's own default
    if joint_type.limits == "none":
        limits = {key: limit for key, limit in limits.items() if key not in ("lower", "upper")}
    return Limits(**limits)
