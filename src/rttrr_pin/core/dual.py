"""The dual scalar: a value with its exact derivatives along any number of directions.

    (x, x') + (y, y') = (x + y, x' + y'),   (x, x') (y, y') = (x y, x' y + x y')

Over scalars of any kind: over floats and arrays it gives numbers, over tracer nodes the program of the derivative.
Only directions along which a scalar moves are stored, so that a quantity of one link costs nothing for the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rttrr_pin.core.algebra import Scalar


@dataclass(slots=True, eq=False)  # never changed; not frozen, which doubles what making one takes
class Dual:
    """A value, and its derivative by each direction that it depends on.

    Attributes:
        value: a scalar of any kind.
        parts: derivative by direction; 0 along all others.
    """

    value: Scalar
    parts: Mapping[int, Scalar]

    __array_ufunc__ = None  # an array on the left leaves the operation to this class

    def __add__(self, other: Scalar) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value + other, self.parts)
        parts = dict(self.parts)
        for k, part in other.parts.items():
            parts[k] = parts[k] + part if k in parts else part
        return Dual(self.value + other.value, parts)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, {k: -part for k, part in self.parts.items()})

    def __sub__(self, other: Scalar) -> Dual:
        return self.__add__(-other)

    def __rsub__(self, other: Scalar) -> Dual:
        return (-self).__add__(other)

    def __mul__(self, other: Scalar) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value * other, {k: part * other for k, part in self.parts.items()})
        parts = {k: part * other.value for k, part in self.parts.items()}
        for k, part in other.parts.items():
            term = self.value * part
            parts[k] = parts[k] + term if k in parts else term
        return Dual(self.value * other.value, parts)

    __rmul__ = __mul__


def value_of(x: Scalar) -> Scalar:
    """The value of a dual; any other scalar is its own."""
    return x.value if isinstance(x, Dual) else x


def part_of(x: Scalar, direction: int) -> Scalar:
    """The derivative along a direction."""
    return x.parts.get(direction, 0.0) if isinstance(x, Dual) else 0.0
