"""The interface of a joint type: the rest of the package asks the type, and never which type it is.

A joint type is one class in one file beside this one, and one line in `JOINT_TYPES`. `tests/core/test_joint_types.py`
checks every type against this interface.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from rttrr_pin.core.algebra import ZERO, Matrix, Scalar, SinCos, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dual import Dual
from rttrr_pin.core.inertia import SpatialInertia

Triple = tuple[float, float, float]

Limited = Literal["required", "optional", "none"]


@dataclass(frozen=True, slots=True)
class Body:
    """Link i and the joint that carries it; the numbers are scalars of one kind.

    Attributes:
        type: how the joint moves.
        axis: unit vector of the joint, in {i}.
        R: R_parent_i at coordinate zero.
        p: p_parent_i at coordinate zero, in the parent frame [m].
        M: mass [kg].
        r_C: from the origin of {i} to the centre of mass, in {i} [m]; equations (1), (2).
        I: inertia tensor about the centre of mass, in {i} [kg m^2]; equations (3)-(7).
        parameters: the numbers of the joint type itself (`JointType.parameters`), such as the pitch of a screw.
    """

    type: JointType
    axis: Vector
    R: Matrix
    p: Vector
    M: Scalar
    r_C: Vector
    I: Matrix
    parameters: tuple[Scalar, ...] = ()


@dataclass(frozen=True, slots=True)
class JointState:
    """Coordinates, rates and accelerations of one joint; a fixed one has none.

    Attributes:
        q: [rad, m]; of a floating joint x, y, z and a unit quaternion (x, y, z, w).
        v: rates; of a planar or floating joint the components, in {i}, of the twist against the parent.
        a: time derivatives of the components of v.
        signs_of: scalars with the signs of v, of a joint that follows another: multiplier times v may underflow; of
            any other joint v itself, and empty here.
    """

    q: Sequence[Scalar]
    v: Sequence[Scalar]
    a: Sequence[Scalar]
    signs_of: Sequence[Scalar] = ()


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Placement of {i} on its parent now, and the motion of the joint alone, in {i}.

    Attributes:
        R: R_parent_i.
        p: p_parent_i, in the parent frame [m].
        w: angular velocity of {i} against the parent [rad/s].
        w_dot: time derivative of the components of w [rad/s^2].
        v: velocity of the origin of {i} against the parent [m/s].
        v_dot: time derivative of the components of v [m/s^2].
    """

    R: Matrix
    p: Vector
    w: Vector = ZERO
    w_dot: Vector = ZERO
    v: Vector = ZERO
    v_dot: Vector = ZERO


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One coordinate or one rate of a joint.

    Attributes:
        unit: of the coordinate, or of what the rate is the rate of: an angle, a length, or neither.
        name: what it is called behind the joint's name; empty where the joint has just one.
    """

    unit: Literal["rad", "m", ""]
    name: str = ""


@dataclass(frozen=True)
class JointType(ABC):
    """How a joint moves; an instance is compared by class and parameters.

    Attributes:
        name: URDF's word for it.
        coordinates: the coordinates, in the order of q.
        rates: the rates, in the order of v, a and tau; `unit` is that of the rate's integral.
        quaternions: where among the coordinates each unit quaternion (x, y, z, w) begins.
        has_axis: whether it turns about or slides along a unit vector that the robot's file may choose.
        axis_direction: the only direction of its axis in {i}, for a type whose axis is not free.
        limits: whether the coordinate has a lower and an upper limit: `"required"` (0 where a file sets none, as URDF
            has it), `"optional"` or `"none"`.
    """

    name: ClassVar[str]
    coordinates: ClassVar[tuple[Coordinate, ...]]
    rates: ClassVar[tuple[Coordinate, ...]]
    quaternions: ClassVar[tuple[int, ...]] = ()
    has_axis: ClassVar[bool] = False
    axis_direction: ClassVar[Triple | None] = None
    limits: ClassVar[Limited] = "optional"

    @abstractmethod
    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """Placement and motion of {i} against the parent, from the coordinates, rates and accelerations."""

    @abstractmethod
    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """The components of f and n along the degrees of freedom, in the order of the rates.

        By virtual work: driving_force . v = f . v_i + n . w_i for the v_i, w_i of `motion` at any rates v.
        """

    def tangent(self, q: Sequence[Scalar], first: int, sincos: SinCos) -> list[Dual]:
        """The coordinates as they move with the rates, whose directions are numbered from `first`.

        Here the rates are the derivatives of the coordinates.
        """
        return [Dual(x, {first + k: 1.0}) for k, x in enumerate(q)]

    def gyroscopic(self, v: Sequence[Scalar], p: Sequence[Scalar]) -> Sequence[Scalar]:
        """Gyroscopic terms: the rates at which the momenta p of the rates v change because they turn with {i}.

        Zero where the rates are derivatives of the coordinates.
        """
        return [0] * self.nv

    def coordinates_at(self, displacement: Array) -> Array:
        """Coordinates, (N, nq), that a displacement from zero along each degree of freedom, (N, nv), leads to."""
        return displacement

    def origin_shift(self, axis: Vector, offset: Vector) -> Vector | None:
        """As much of an offset as the origin of {i} may move, its axes turned at will, while the joint stays the same.

        None where {i} must stay as it is, since rates or coordinates are components in it.
        """
        return None

    def regrouped(self, body: Body, first_moment: bool) -> tuple[Body, SpatialInertia] | None:
        """The link with less inertia, and the rest, which may as well belong to the link that carries the joint.

        No driving force changes by it: seen from the carrier, what moves stays as it is at any coordinate.

        Args:
            body: the link, in numbers with which `is_zero` and comparisons make sense.
            first_moment: whether the carrier can take a first moment.

        Returns:
            The link with what stays, and the inertia that may move, both in {i}; None where nothing may move.
        """
        return None

    @property
    def parameters(self) -> tuple[float, ...]:
        """Numbers of the type itself; `Body.parameters` holds them as scalars."""
        return ()

    @property
    def has_direction(self) -> bool:
        """Whether the <axis> of such a joint counts for something, and so its limits do."""
        return self.has_axis or self.axis_direction is not None

    @property
    def nq(self) -> int:
        """The number of coordinates."""
        return len(self.coordinates)

    @property
    def nv(self) -> int:
        """The number of rates."""
        return len(self.rates)

    @property
    def rotations(self) -> tuple[bool, ...]:
        """For each rate, whether it is of an angle, so that a moment drives it [N m]; else a force does [N]."""
        return tuple(rate.unit == "rad" for rate in self.rates)

    @property
    def rotates(self) -> bool:
        """Whether it has one coordinate, and that is an angle."""
        return self.nq == 1 and self.coordinates[0].unit == "rad"

    def __str__(self) -> str:
        return self.name
