"""A robot with a body more, or with fewer joints that move: the numbers (`urdf/altered.py` has the text)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.dynamics import body_of, locked_body
from rttrr_pin.core.inputs import check_quaternions, coordinates
from rttrr_pin.core.joint import Joint, JointEffects, Lock
from rttrr_pin.core.joints import FIXED
from rttrr_pin.core.model import UNIVERSE, Link, Model, unused
from rttrr_pin.core.scalars import EPS, FLOAT
from rttrr_pin.errors import InputError, ShapeError, UnknownNameError

QUATERNION = 8 * EPS
"""How far the squared length of a locked quaternion may be from 1: other programs read it as angles, of length 1."""


def with_body(model: Model, link: Link, parent: int) -> Model:
    """The robot with a link more, the last one, fixed to a link in the same place and axes.

    Args:
        model: the robot.
        link: mass, centre of mass and tensor, in the axes of the link that carries it.
        parent: the index of that link.
    """
    joint = Joint(f"{link.name}_joint", FIXED, parent)
    return replace(model, links=(*model.links, link), joints=(*model.joints, joint))


def with_locked(model: Model, q: Mapping[str, ArrayLike]) -> Model:
    """The robot with joints that stand still, those that follow them too; links, and their order, stay as they are.

    A fixed joint at R, p of the joint's motion at q, where it is at rest: what the recursion yields for
    q, v = 0, a = 0. Pinocchio's `buildReducedModel`, but that no link disappears in another. Where the joint of a
    floating base is locked, the base is fixed there.

    Args:
        model: the robot.
        q: by name of a moving joint, its coordinate [rad or m], or its coordinates.

    Raises:
        UnknownNameError: a name is of no joint that moves by itself.
        NumberError, ShapeError: as for coordinates; here there are no batches, and a quaternion that other programs
            read as angles must have the length 1 to rounding.
    """
    if not isinstance(q, Mapping):
        raise InputError(f"joints is a {type(q).__name__}: pass a dict from joint name to coordinate")
    for name in q:
        if name not in model.joint_names:
            raise UnknownNameError("moving joint", name, model.joint_names, _leader(model, name))
    chosen = [joint for joint in model.moving if joint.name in q]
    values = coordinates("q", q, chosen)
    if values.ndim != 1:
        raise ShapeError(
            f"the coordinates of locked joints have shape {values.shape}: pass one state, without batch axes",
            name="q",
            got=values.shape,
            wanted=f"({values.shape[-1]},)",
        )
    check_quaternions(values, chosen, QUATERNION)
    begins = accumulate((joint.nq for joint in chosen), initial=0)
    locks = {own.name: tuple(values[at : at + own.nq].tolist()) for at, own in zip(begins, chosen, strict=False)}

    def locked(joint: Joint) -> Joint:
        leader = joint if joint.mimic is None else model.joints[joint.mimic.joint]
        return _locked(Lock(joint, locks[leader.name])) if leader.name in locks else joint

    if not locks:
        return model
    floating = model.floating and model.joints[0].name not in locks
    root = model.root if floating == model.floating else Link(unused(UNIVERSE, model.link_names))
    return replace(model, root=root, joints=tuple(locked(joint) for joint in model.joints), floating=floating)


def _locked(lock: Lock) -> Joint:
    """The fixed joint, its placement in doubles."""
    joint = lock.joint
    body = locked_body(body_of(joint, Link(""), FLOAT), lock, FLOAT)
    R, p = body.R.array, np.array([*body.p], dtype=np.float64)
    return replace(joint, type=FIXED, R=R, p=p, mimic=None, effects=JointEffects(), lock=lock)


def _leader(model: Model, name: object) -> str:
    """The fix, where a joint that follows another is named."""
    for joint in model.joints:
        if joint.name == name and joint.mimic is not None:
            return f"{name!r} follows {model.joints[joint.mimic.joint].name!r}: lock that one"
    return ""
