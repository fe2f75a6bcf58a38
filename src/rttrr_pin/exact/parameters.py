"""The exact parameters of a robot: the numbers of its file, and what follows from them, in scalars that do not round.

The doubles of a model are rounded: sines of rpy, axes divided by their length, tensors in link axes, chains of mimics.
Here each number of the file is a rational, and these are computed from it in any scalars.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from math import isqrt
from typing import Any, Literal

import numpy as np

from rttrr_pin.core.algebra import Matrix, Scalar, Vector, rotation
from rttrr_pin.core.dynamics import locked_body
from rttrr_pin.core.joint import Joint, JointEffects, Mimic
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.errors import InputError
from rttrr_pin.urdf.decimals import Number, NumberList
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint
from rttrr_pin.urdf.inertial import NO_INERTIAL, ZEROS, Placement, UrdfInertial, rows_of_quaternion
from rttrr_pin.urdf.reader import model_of

InverseRoot = Callable[[Fraction], Scalar]
Parameters = Literal["doubles", "read", "text"]

ZERO = Number("0")
BASE_JOINT = UrdfJoint("", 0, "floating", "", "", Placement(), ZEROS, None, None, ZERO, ZERO)
"""The joint of a floating base, which no file has."""

Exact = Callable[[Number], Fraction]
"""From a number of the file to a rational."""

READ: dict[str, Exact] = {"read": lambda number: Fraction(float(number)), "text": lambda number: number.exact}


@dataclass(frozen=True, slots=True, eq=False)
class ExactParameters:
    """A model and its parameters as rationals.

    Attributes:
        model: the robot; mimics, armatures, damping and friction of its joints are rationals.
        inertials: of the links, as the file has them.
        joints: that carry the links, as the file has them.
        exact: from a number of the file to a rational.
    """

    model: Model
    inertials: tuple[UrdfInertial, ...]
    joints: tuple[UrdfJoint, ...]
    exact: Exact

    def bodies(self, arithmetic: Arithmetic, inverse_root: InverseRoot) -> list[Body]:
        """The links and joints in scalars; `inverse_root` is 1 / sqrt(x), for axes whose length is irrational."""

        def number(x: Fraction) -> Scalar:
            return arithmetic.number(x, 0.0)  # type: ignore[arg-type]

        def vector(numbers: NumberList) -> Vector:
            return Vector(*(number(self.exact(x)) for x in numbers.each))

        def R(origin: Placement) -> Matrix:
            """URDF's R = R_z(yaw) R_y(pitch) R_x(roll), or that of the quaternion."""
            if origin.quaternion is not None:
                rows = rows_of_quaternion([self.exact(x) for x in origin.quaternion.each])
                row_x, row_y, row_z = (Vector(*map(number, row)) for row in rows)
                return Matrix((row_x, row_y, row_z))
            turns = zip(np.eye(3, dtype=int).tolist(), vector(origin.rpy), strict=True)
            x, y, z = (rotation(Vector(*axis), angle, arithmetic.sincos) for axis, angle in turns)
            return z @ (y @ x)

        bodies = []
        for joint, own, inertial in zip(self.model.joints, self.joints, self.inertials, strict=True):
            a, b, c = (Vector(*map(number, row)) for row in inertial.tensor_of(self.exact))
            I = Matrix((a, b, c))
            if inertial.origin.quaternion or any(self.exact(angle) for angle in inertial.origin.rpy.each):
                turn = R(inertial.origin)
                I = turn @ I @ turn.T
            moving = _as_it_moves(joint)
            body = Body(
                type=moving.type,
                axis=_axis(moving, [self.exact(x) for x in own.axis.each], number, inverse_root),
                R=R(own.origin),
                p=vector(own.origin.xyz),
                M=number(self.exact(inertial.mass)),
                r_C=vector(inertial.origin.xyz),
                I=I,
                parameters=tuple(number(Fraction(x)) for x in moving.type.parameters),
            )
            bodies.append(body if joint.lock is None else locked_body(body, joint.lock, arithmetic))
        return bodies


@lru_cache(maxsize=16)
def exact_parameters(model: Model, parameters: Literal["read", "text"]) -> ExactParameters:
    """The parameters in the file that a model was read from: its decimals, or the doubles nearest to them.

    Raises:
        InputError: the model was made from numbers, or altered since it was read.
    """
    document = model.document
    if not isinstance(document, UrdfDocument):
        raise InputError(
            f"robot {model.name!r} was made from numbers and has no file to take them from: pass parameters='doubles'"
        )
    if document.made_from and parameters == "text":
        raise InputError(
            f"robot {model.name!r} was loaded from an object, which has doubles and no decimals: pass parameters='read'"
        )
    read = model_of(document)
    if any(joint.name not in document.joints for joint in model.joints):  # of the base, locked or not
        read = read.with_floating_base()
    for difference in _differences(model, read):
        raise InputError(
            f"{difference} of robot {model.name!r} is not what its file says: the model was altered since it was "
            "read; pass parameters='doubles'"
        )
    exact = READ[parameters]
    own = tuple(document.joints.get(joint.name, BASE_JOINT) for joint in model.joints)
    inertials = tuple(document.links[link.name].inertial or NO_INERTIAL for link in model.links)
    joints = tuple(_joint(joint, document, exact) for joint in model.joints)
    return ExactParameters(replace(model, joints=joints), inertials, own, exact)


def _joint(joint: Joint, document: UrdfDocument, exact: Exact) -> Joint:
    """The joint with rationals for multiplier and offset, through the whole chain of mimics, and for its effects."""
    own = document.joints.get(joint.name, BASE_JOINT)
    mimic: Any = joint.mimic
    if mimic is not None:
        _, multiplier, offset, _ = document.followed(own, exact)
        mimic = Mimic(mimic.joint, multiplier, offset)  # type: ignore[arg-type]

    def number(of_file: Number, set_since: float) -> Any:
        """That of the file, unless it was set since."""
        return exact(of_file) if float(of_file) == set_since else Fraction(set_since)

    effects, armature = joint.effects, Fraction(joint.effects.armature)
    damping, friction = number(own.damping, effects.damping), number(own.friction, effects.friction)
    lock = joint.lock and replace(joint.lock, joint=_joint(joint.lock.joint, document, exact))
    effects = JointEffects(armature, damping, friction)  # type: ignore[arg-type]
    return replace(joint, mimic=mimic, effects=effects, lock=lock)


def _differences(model: Model, read: Model) -> Iterator[str]:
    """The links and joints of a model that are not those of its file."""
    links, joints = {x.name: x for x in read.links}, {x.name: x for x in read.joints}
    for link in model.links:
        if not _same(link, links.get(link.name), "mass", "com", "inertia"):
            yield f"link {link.name!r}"
    for joint in model.joints:
        own, other = _as_it_moves(joint), joints.get(joint.name)
        if not _same(own, other, "p", "R", "axis") or _followed(model, own) != _followed(read, other):
            yield f"joint {joint.name!r}"


def _as_it_moves(joint: Joint) -> Joint:
    """The joint of the file, also where it is locked."""
    return joint if joint.lock is None else joint.lock.joint


def _followed(model: Model, joint: Joint | None) -> tuple[str, float, float] | None:
    """The joint that a joint follows by its name, as links can stand in another order than the file's; and how."""
    if joint is None or joint.mimic is None:
        return None
    return model.joints[joint.mimic.joint].name, joint.mimic.multiplier, joint.mimic.offset


def _same(own: object, read: object, *names: str) -> bool:
    return read is not None and all(np.array_equal(getattr(own, name), getattr(read, name)) for name in names)


def _axis(
    joint: Joint, axis: list[Fraction], number: Callable[[Fraction], Scalar], inverse_root: InverseRoot
) -> Vector:
    """The axis divided by its length; rational where its length is."""
    if not joint.type.has_axis:
        return Vector(*(number(Fraction(x)) for x in joint.type.axis_direction or (0, 0, 0)))
    square = sum((x * x for x in axis), Fraction(0))
    length = Fraction(isqrt(square.numerator), isqrt(square.denominator))
    if length * length == square:
        return Vector(*(number(x / length) for x in axis))
    x, y, z = map(number, axis)
    return Vector(x, y, z) * inverse_root(square)
