"""<origin> and <inertial>: where a frame stands, and the mass and tensor in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TypeVar

import numpy as np

from rttrr_pin.core.arrays import Array, angles_of, rotation
from rttrr_pin.urdf.decimals import Number, NumberList

T = TypeVar("T")

ZEROS = NumberList("0 0 0")

ENTRIES = {f"i{'xyz'[i]}{'xyz'[j]}": (i, j) for i in range(3) for j in range(i, 3)}
"""Row and column of URDF's six entries of a tensor: ixx, ixy, ixz, iyy, iyz, izz."""


def symmetric(entries: Mapping[str, T]) -> tuple[tuple[T, T, T], ...]:
    """The 3x3 tensor of URDF's six entries."""
    xx, xy, xz, yy, yz, zz = (entries[name] for name in ENTRIES)
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def rows_of_quaternion(quaternion: Sequence[Fraction]) -> tuple[tuple[Fraction, ...], ...]:
    """The rotation matrix of a quaternion (x, y, z, w) of any length but 0: rational, so that nothing is rounded."""
    x, y, z, w = quaternion
    s = 2 / (x * x + y * y + z * z + w * w)
    return (
        (1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)),
        (s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)),
        (s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)),
    )


@dataclass(frozen=True, eq=False)
class Placement:
    """An <origin>, the identity where there is none.

    Attributes:
        xyz: the origin of the frame in the frame around it [m].
        rpy: its angles, see `rotation` [rad].
        quaternion: (x, y, z, w), of any length, in place of angles; None where there are angles.
    """

    xyz: NumberList = ZEROS
    rpy: NumberList = ZEROS
    quaternion: NumberList | None = None

    @cached_property
    def p(self) -> Array:
        """The origin, (3,) [m]."""
        return np.array(self.xyz.floats)

    @cached_property
    def R(self) -> Array:
        """Maps vectors of the frame to the frame around it, (3, 3)."""
        if self.quaternion is not None:
            return np.array(rows_of_quaternion([Fraction(x) for x in self.quaternion.floats]), dtype=np.float64)
        return rotation(self.rpy.floats) + 0.0  # -0.0, of -sin(0), becomes 0.0

    @property
    def angles(self) -> tuple[float, ...]:
        """Roll, pitch and yaw, also of a quaternion, then rounded [rad]."""
        return self.rpy.floats if self.quaternion is None else angles_of(self.R)

    @cached_property
    def rotated(self) -> bool:
        """Whether R is computed from angles or a quaternion, and is not the identity."""
        return not np.array_equal(self.R, np.eye(3))


@dataclass(frozen=True, eq=False)
class UrdfInertial:
    """An <inertial>.

    Attributes:
        origin: of the inertial frame in the link frame; `origin.p` is the centre of mass.
        mass: [kg].
        entries: the six entries of the tensor about the centre of mass, by name, in the inertial frame [kg m^2].
    """

    origin: Placement
    mass: Number
    entries: dict[str, Number]

    def tensor_of(self, value: Callable[[Number], T]) -> tuple[tuple[T, T, T], ...]:
        """The symmetric tensor in the inertial frame, each entry converted."""
        return symmetric({name: value(number) for name, number in self.entries.items()})

    @property
    def is_zero(self) -> bool:
        """Whether all six entries are zero."""
        return not any(number.exact for number in self.entries.values())

    @cached_property
    def tensor(self) -> Array:
        """The tensor in the axes of the inertial frame, (3, 3) [kg m^2], each entry the nearest double."""
        return np.array(self.tensor_of(float))

    @cached_property
    def inertia(self) -> Array:
        """The tensor in the axes of the link frame, (3, 3) [kg m^2]; not finite where turning it overflows."""
        if not self.origin.rotated:
            return self.tensor
        R = self.origin.R
        with np.errstate(over="ignore", invalid="ignore"):
            turned = R @ self.tensor @ R.T
            return np.asarray((turned + turned.T) / 2)


NO_INERTIAL = UrdfInertial(Placement(), Number("0"), dict.fromkeys(ENTRIES, Number("0")))
"""What a link without <inertial> has."""
