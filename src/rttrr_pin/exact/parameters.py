"""A robot's numbers as its file writes them, and what follows from them, in scalars that do not round.

A reader of a URDF rounds: sines of rpy, axes divided by their length, tensors turned into link axes, chains of mimics.
Here each word of the file is a rational, and these are computed from it in whatever scalars the caller has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from math import isqrt
from typing import Any, Literal

import numpy as np

from rttrr_pin.core.algebra import Matrix, Scalar, Vector
from rttrr_pin.core.joint import Joint, JointEffects, Mimic
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.rotations import SinCos, rotation
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.errors import InputError
from rttrr_pin.urdf.decimals import Number, NumberList
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint, UrdfLink, UrdfMimic

Triple = tuple[Fraction, Fraction, Fraction]
InverseRoot = Callable[[Fraction], Scalar]
Parameters = Literal["doubles", "read", "text"]

CLOSE = 1e-12
"""Of rotations and turned tensors, relative: two ways to compute one differ by a few eps, two files by more."""


@dataclass(frozen=True, slots=True)
class WrittenLink:
    """An <inertial>: mass [kg], com [m] and rpy [rad] of its <origin>, tensor in its own axes [kg m^2]."""

    mass: Fraction
    com: Triple
    rpy: Triple
    tensor: tuple[Triple, ...]


@dataclass(frozen=True, slots=True)
class WrittenJoint:
    """A <joint>: xyz [m] and rpy [rad] of its <origin>, its <axis> as it stands, and by name whom it follows."""

    xyz: Triple
    rpy: Triple
    axis: Triple
    follows: str
    multiplier: Fraction
    offset: Fraction
    damping: Fraction
    friction: Fraction


NOTHING: Triple = (Fraction(0), Fraction(0), Fraction(0))
AIR = WrittenLink(Fraction(0), NOTHING, NOTHING, (NOTHING, NOTHING, NOTHING))
WELD = WrittenJoint(NOTHING, NOTHING, NOTHING, "", Fraction(1), Fraction(0), Fraction(0), Fraction(0))
"""What a link without <inertial> has, and the joint of a floating base, which no file writes."""


@dataclass(frozen=True, slots=True, eq=False)
class ExactParameters:
    """A model and its numbers in rationals.

    Attributes:
        model: the robot; multipliers, offsets and drives of its joints are rationals.
        links: by index, as the file writes them.
        joints: by index.
    """

    model: Model
    links: tuple[WrittenLink, ...]
    joints: tuple[WrittenJoint, ...]

    def bodies(self, arithmetic: Arithmetic, inverse_root: InverseRoot) -> list[Body]:
        """The links and joints in scalars.

        Args:
            arithmetic: makes scalars of rationals, and their sines.
            inverse_root: 1 / sqrt(x) of a rational, for axes whose length is none.
        """
        parts = zip(self.model.joints, self.joints, self.links, strict=True)
        return [_body(*part, arithmetic, inverse_root) for part in parts]


@lru_cache(maxsize=16)
def exact_parameters(model: Model, parameters: Literal["read", "text"]) -> ExactParameters:
    """The numbers of the file that a model was read from.

    Args:
        model: the robot.
        parameters: `"text"`: the decimals of the file; `"read"`: the doubles nearest to them.

    Raises:
        InputError: the model was made from numbers, or altered since it was read.
    """
    document = model.document
    if not isinstance(document, UrdfDocument):
        raise InputError(
            f"robot {model.name!r} was made from numbers and has no file to take them from: pass parameters='doubles'"
        )
    value = _reader(parameters)
    own = {name: _joint(joint, value) for name, joint in document.joints.items()}
    masses = {name: _link(link, value) for name, link in document.links.items()}
    links = tuple(masses.get(link.name, AIR) for link in model.links)
    joints = tuple(own.get(joint.name, WELD) for joint in model.joints)
    for difference in _differences(model, links, joints):
        raise InputError(
            f"{difference} of robot {model.name!r} is not what its file says: the model was altered since it was "
            "read; pass parameters='doubles'"
        )
    exact = tuple(_exact(joint, as_written, own) for joint, as_written in zip(model.joints, joints, strict=True))
    return ExactParameters(replace(model, joints=exact), links, joints)


def _reader(numbers: str) -> Callable[[Number], Fraction]:
    """From a number of the file to a rational."""
    return (lambda number: Fraction(float(number))) if numbers == "read" else (lambda number: number.exact)


def _link(link: UrdfLink, value: Callable[[Number], Fraction]) -> WrittenLink:
    inertial = link.inertial
    if inertial is None:
        return AIR
    xyz, rpy = (_triple(words, value) for words in (inertial.origin.xyz, inertial.origin.rpy))
    return WrittenLink(value(inertial.mass), xyz, rpy, inertial.tensor_of(value))


def _joint(joint: UrdfJoint, value: Callable[[Number], Fraction]) -> WrittenJoint:
    mimic = UrdfMimic("", Number("1"), Number("0")) if joint.mimic is None else joint.mimic
    return WrittenJoint(
        _triple(joint.origin.xyz, value),
        _triple(joint.origin.rpy, value),
        _triple(joint.axis, value),
        mimic.joint,
        value(mimic.multiplier),
        value(mimic.offset),
        value(joint.damping),
        value(joint.friction),
    )


def _triple(words: NumberList, value: Callable[[Number], Fraction]) -> Triple:
    x, y, z = map(value, words.each)
    return x, y, z


def _exact(joint: Joint, as_written: WrittenJoint, own: dict[str, WrittenJoint]) -> Joint:
    """The joint with rationals for its multiplier and offset, through the whole chain, and for its drive."""
    mimic: Any = joint.mimic
    if mimic is not None:
        factor, shift, at = Fraction(1), Fraction(0), as_written
        while at.follows:
            shift += factor * at.offset
            factor *= at.multiplier
            at = own[at.follows]
        mimic = Mimic(mimic.joint, factor, shift)  # type: ignore[arg-type]
    effects = joint.effects  # a number that is not the file's was set since, and is meant as it is
    damping, friction = (
        of_file if float(of_file) == number else Fraction(number)
        for of_file, number in ((as_written.damping, effects.damping), (as_written.friction, effects.friction))
    )
    exact = JointEffects(Fraction(effects.armature), damping, friction)  # type: ignore[arg-type]
    return replace(joint, mimic=mimic, effects=exact)


def _differences(model: Model, links: Sequence[WrittenLink], joints: Sequence[WrittenJoint]) -> Iterator[str]:
    """What in the model is not the file's."""
    for link, body in zip(model.links, links, strict=True):
        tensor = np.array(body.tensor, dtype=np.float64)
        scale = CLOSE * float(np.abs(tensor).max())
        same = link.mass == float(body.mass) and link.com.tolist() == [float(x) for x in body.com]
        turned = abs(np.trace(tensor) - np.trace(link.inertia)) <= scale if link.rotated else True
        if not (same and turned and (link.rotated or np.array_equal(tensor, link.inertia))):
            yield f"link {link.name!r}"
    for joint, own in zip(model.joints, joints, strict=True):
        R = np.array([tuple(row) for row in _turn(own.rpy, float, _float_sincos).rows])
        axis = np.array(own.axis, dtype=np.float64)
        along = np.abs(np.cross(axis, joint.axis)).max() <= CLOSE * np.abs(axis).max() and axis @ joint.axis > 0.0
        if not (
            joint.p.tolist() == [float(x) for x in own.xyz]
            and np.allclose(R, joint.R, rtol=0.0, atol=CLOSE)
            and (not joint.type.has_axis or along)
        ):
            yield f"joint {joint.name!r}"


def _float_sincos(x: float) -> tuple[float, float]:
    return float(np.sin(x)), float(np.cos(x))


def _turn(rpy: Triple, number: Callable[[Any], Scalar], sincos: SinCos) -> Matrix:
    """URDF's R = R_z(yaw) R_y(pitch) R_x(roll)."""
    roll, pitch, yaw = (number(angle) for angle in rpy)
    x, y, z = Vector(1, 0, 0), Vector(0, 1, 0), Vector(0, 0, 1)
    about_y_x = rotation(y, pitch, sincos) @ rotation(x, roll, sincos)
    return rotation(z, yaw, sincos) @ about_y_x


def _body(
    joint: Joint, own: WrittenJoint, link: WrittenLink, arithmetic: Arithmetic, inverse_root: InverseRoot
) -> Body:
    """One link with its joint."""

    def number(x: Fraction) -> Scalar:
        return arithmetic.number(x, 0.0)  # type: ignore[arg-type]

    a, b, c = (Vector(*map(number, row)) for row in link.tensor)
    I = Matrix((a, b, c))
    if any(link.rpy):
        R = _turn(link.rpy, number, arithmetic.sincos)
        I = R @ I @ R.T
    return Body(
        type=joint.type,
        axis=_axis(joint, own, number, inverse_root),
        R=_turn(own.rpy, number, arithmetic.sincos),
        p=Vector(*map(number, own.xyz)),
        M=number(link.mass),
        r_C=Vector(*map(number, link.com)),
        I=I,
        parameters=tuple(number(Fraction(x)) for x in joint.type.parameters),
    )


def _axis(joint: Joint, own: WrittenJoint, number: Callable[[Fraction], Scalar], inverse_root: InverseRoot) -> Vector:
    """The axis divided by its length; a rational where the length is one."""
    if not joint.type.has_axis:
        return Vector(*(number(Fraction(x)) for x in joint.type.axis_direction or (0, 0, 0)))
    square = sum((x * x for x in own.axis), Fraction(0))
    length = Fraction(isqrt(square.numerator), isqrt(square.denominator))
    if length * length == square:
        return Vector(*(number(x / length) for x in own.axis))
    x, y, z = map(number, own.axis)
    return Vector(x, y, z) * inverse_root(square)
