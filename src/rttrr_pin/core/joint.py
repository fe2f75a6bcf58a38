"""Joints as data: how they move, what limits them, whom they follow, and what they add to their driving force."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from numbers import Real

import numpy as np

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.arrays import Array, Rebuilt
from rttrr_pin.core.inputs import real
from rttrr_pin.core.joints.base import JointType
from rttrr_pin.errors import InputError, shortened


@dataclass(frozen=True, slots=True)
class Limits:
    """What a joint may do; infinite where the file sets no limit.

    Attributes:
        lower: smallest coordinate [rad or m].
        upper: largest coordinate [rad or m].
        velocity: largest rate [rad/s or m/s].
        effort: largest torque or force [N m or N].
    """

    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    effort: float = math.inf


@dataclass(frozen=True, slots=True)
class Mimic:
    """The coordinate of a joint that follows another: multiplier times that joint's, plus offset.

    Attributes:
        joint: index of the joint it follows, which follows none itself.
        multiplier: ratio of the rates.
        offset: [rad or m].
        rounded: whether both are the rounded result of a chain of mimics, and no longer the file's numbers.
    """

    joint: int
    multiplier: float = 1.0
    offset: float = 0.0
    rounded: bool = False


@dataclass(frozen=True, slots=True)
class JointEffects:
    """What a joint itself adds to its driving force; the bearing does not see it.

        tau_joint = armature a + damping v + friction sign(v)

    Attributes:
        armature: reflected inertia of rotor and gears, rotor inertia times gear ratio squared [kg m^2 or kg].
        damping: viscous friction [N m s/rad or N s/m].
        friction: Coulomb friction, none at rest [N m or N].
    """

    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


EFFECTS = tuple(own.name for own in fields(JointEffects))
"""The names of its parameters."""


@dataclass(frozen=True, slots=True, eq=False)
class Lock:
    """What a joint is that stands still because it is locked.

    Attributes:
        joint: the joint as it moves.
        q: the coordinates at which it stands; of a joint that follows another, that one's.
    """

    joint: Joint
    q: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Joint(Rebuilt):
    """A joint, and where it sits on the link that carries it.

    Attributes:
        name: its name in the file.
        type: how it moves.
        parent: index of the parent link in `Model.links`; -1 where the parent is the root link.
        R: R_parent_i at coordinate zero: maps vectors of the joint frame to the parent link frame, (3, 3).
        p: p_parent_i at coordinate zero: from the parent link's origin to the joint's, in the parent frame, (3,) [m].
        axis: the unit vector that the joint turns about or slides along, in {i}, (3,).
        limits: what it may do.
        rotated: whether `R` was computed from a non-zero rpy (else it is exactly the identity).
        mimic: the joint that it follows, if any.
        dynamics: damping and friction as the file gives them, whether they take part or not.
        effects: what the joint itself adds to its driving force.
        lock: of a fixed joint that is one because it is locked (`core/altered.py`): what it is else. `R` and `p` are
            then rounded results, and whoever must know how far takes them from the lock (`body_of`).
    """

    name: str
    type: JointType
    parent: int = -1
    R: Array = field(default_factory=lambda: np.eye(3))
    p: Array = field(default_factory=lambda: np.zeros(3))
    axis: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    limits: Limits = Limits()
    rotated: bool = False
    mimic: Mimic | None = None
    dynamics: JointEffects = JointEffects()
    effects: JointEffects = JointEffects()
    lock: Lock | None = None

    def __post_init__(self) -> None:
        named("joint", self.name)
        whole_number(f"parent of joint {self.name!r}", self.parent, -1, LAST_LINK)
        of_joint = f"of joint {self.name!r}"
        check_numbers(f"limits {of_joint}", self.limits, Limits)
        check_numbers(f"dynamics {of_joint}", self.dynamics, JointEffects)
        check_numbers(f"effects {of_joint}", self.effects, JointEffects)
        if self.mimic is not None:
            check_numbers(f"mimic {of_joint}", self.mimic, Mimic)
        if not isinstance(self.type, JointType):
            raise InputError(
                f"type of joint {self.name!r} is {self.type!r}: pass one of rttrr_pin.core.joints, such as REVOLUTE"
            )
        for name, shape in (("R", (3, 3)), ("p", (3,)), ("axis", (3,))):
            object.__setattr__(self, name, frozen(getattr(self, name), shape, f"{name} of joint {self.name!r}"))
        if self.type.has_axis and abs(np.linalg.norm(self.axis) - 1.0) > 1e-9:
            raise InputError(
                f"axis of joint {self.name!r} is {self.axis.tolist()}, of length {np.linalg.norm(self.axis):.6g}; "
                "expected a unit vector: divide it by its length"
            )
        direction = self.type.axis_direction
        if direction is not None and tuple(self.axis) != direction:
            raise InputError(
                f"axis of {self.type} joint {self.name!r} is {self.axis.tolist()}, "
                f"expected {[int(x) for x in direction]}: turn the joint by R"
            )
        if not (np.abs(self.R @ self.R.T - np.eye(3)) <= 1e-9).all() or np.linalg.det(self.R) < 0.0:
            raise InputError(f"R of joint {self.name!r} is {self.R.tolist()}: expected a rotation")

    @property
    def nq(self) -> int:
        """The number of its coordinates, its own or those it takes from the joint it follows."""
        return self.type.nq

    @property
    def nv(self) -> int:
        """The number of its rates."""
        return self.type.nv

    @property
    def independent(self) -> bool:
        """Whether it moves, and follows no other joint."""
        return self.nv > 0 and self.mimic is None

    def q_labels(self) -> list[str]:
        """Names of its coordinates: its own name, with the slot behind where there are several."""
        return [f"{self.name}.{own.name}" if own.name else self.name for own in self.type.coordinates]

    def v_labels(self) -> list[str]:
        """Names of its rates."""
        return [f"{self.name}.{own.name}" if own.name else self.name for own in self.type.rates]


LAST_LINK = 10**6
"""More links than a robot has."""


def named(kind: str, name: object) -> None:
    """Links and joints have names that are text.

    Raises:
        InputError: it is of another type.
    """
    if not isinstance(name, str):
        raise InputError(f"the name of a {kind} is {name!r}: pass text")


def check_numbers(label: str, own: object, kind: type[Limits | JointEffects | Mimic]) -> None:
    """Data of a joint holds numbers, floats or fractions, and only its limits may be infinite.

    Raises:
        InputError: it holds something else, or is of another type.
    """
    if not isinstance(own, kind):
        raise InputError(f"{label} is a {type(own).__name__}: pass {kind.__name__}(...)")
    for part in fields(own):
        value = getattr(own, part.name)
        try:
            x = float(value) if isinstance(value, Real) else math.nan
        except OverflowError:
            x = math.nan
        if math.isnan(x) or (math.isinf(x) and kind is not Limits):
            raise InputError(f"{part.name} in {label} is {shortened(repr(value))}: expected a number")


def frozen(values: Array, shape: tuple[int, ...], name: str) -> Array:
    """A read-only float64 copy of the wanted shape."""
    array = np.array(real(name, values))
    if array.shape != shape or not np.isfinite(array).all():
        raise InputError(f"{name} is {np.asarray(values).tolist()}: expected {shape} finite numbers")
    array += 0.0  # -0.0, a by-product of some rotations, becomes 0.0
    array.setflags(write=False)
    return array
