"""A number of the robot with a bound on its error: how far rounding took it from the number that is meant."""

from __future__ import annotations

import math
import sys
from hashlib import blake2b
from itertools import count

from rttrr_pin.core.scalars import UNDERFLOW, UNIT_ROUNDOFF

Origin = tuple[bytes, bool]
"""Which true number is meant, up to its sign, and whether it is the opposite."""

_fresh = count()


class ConstantWithError(float):
    """A float whose true value is known to lie within `error` of it; sums and products carry the bound along.

    It is a float everywhere else: what is traced on such numbers is traced as on floats. With |x - x_true| <= e_x and
    |y - y_true| <= e_y, fl(x + y) is off by at most e_x + e_y and its own rounding, fl(x y) by at most
    |x| e_y + |y| e_x + e_x e_y and its own, fl(x / y) by at most (e_x + |x / y| e_y) / (|y| - e_y) and its own.
    Rounding is counted only where there is some.

    Two numbers with the same value and the same bound need not be the same number: cos a and sin b may round alike, and
    their difference is not 0. So each has an origin, new where a number is made, and computed for sums and products
    from those of the operands: equal origins mean equal true values.

    Attributes:
        error: the bound.
        origin: which true number it is; of no meaning where the error is 0.
    """

    __slots__ = ("error", "origin")
    error: float
    origin: Origin

    def __new__(cls, value: float, error: float = 0.0, origin: Origin | None = None) -> ConstantWithError:
        """The float, with its bound; a number of its own unless an origin is given."""
        number = super().__new__(cls, value)
        number.error = error
        number.origin = origin or (b"number %d" % next(_fresh), False)
        return number

    def __add__(self, other: object) -> ConstantWithError:
        if not isinstance(other, int | float):
            return NotImplemented
        if exactly(other, 0.0) or exactly(self, 0.0):
            return self if exactly(other, 0.0) else _known(other)
        (one, opposite), (another, turned) = _origin(self), _origin(other)
        if one == another and opposite != turned:
            return ConstantWithError(0.0)
        x, y = float(self), float(other)
        total = x + y
        part = total - x
        rounding = abs((x - (total - part)) + (y - part))  # exactly (Knuth)
        terms = sorted([(one, opposite), (another, turned)])
        negative = terms[0][1]  # x - y and y - x are opposites
        origin = _combined("+", *((name, sign != negative) for name, sign in terms)), negative
        return ConstantWithError(total, self.error + error_of(other) + rounding, origin)

    __radd__ = __add__

    def __neg__(self) -> ConstantWithError:
        return ConstantWithError(-float(self), self.error, (self.origin[0], not self.origin[1]))

    def __abs__(self) -> ConstantWithError:
        return -self if self < 0.0 else self

    def __sub__(self, other: object) -> ConstantWithError:
        if not isinstance(other, int | float):
            return NotImplemented
        return self + (-other)

    def __rsub__(self, other: object) -> ConstantWithError:
        if not isinstance(other, int | float):
            return NotImplemented
        return (-self) + other

    def __mul__(self, other: object) -> ConstantWithError:
        if not isinstance(other, int | float):
            return NotImplemented
        for factor, number in ((self, other), (other, self)):
            if exactly(factor, 0.0):
                return ConstantWithError(0.0)
            if exactly(abs(factor), 1.0):
                return _known(number if factor > 0.0 else -number)
        x, y, error = float(self), float(other), error_of(other)
        product = x * y
        rounding = _rounding(product, is_power_of_two(x) or is_power_of_two(y)) if x and y else 0.0
        (one, opposite), (another, turned) = sorted([_origin(self), _origin(other)])
        origin = _combined("*", (one, False), (another, False)), opposite != turned
        return ConstantWithError(product, abs(x) * error + abs(y) * self.error + self.error * error + rounding, origin)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> ConstantWithError:
        if not isinstance(other, int | float):
            return NotImplemented
        x, y, error = float(self), float(other), error_of(other)
        quotient = x / y
        rounding = _rounding(quotient, is_power_of_two(y)) if x else 0.0
        least = abs(y) - error  # of what is divided by
        inherited = (self.error + abs(quotient) * error) / least if least > 0.0 else math.inf
        (one, opposite), (another, turned) = _origin(self), _origin(other)
        origin = _combined("/", (one, False), (another, False)), opposite != turned
        return ConstantWithError(quotient, inherited + rounding, origin)

    def __rtruediv__(self, other: object) -> ConstantWithError:
        if not isinstance(other, int | float):
            return NotImplemented
        return ConstantWithError(other) / self

    def function(self, name: str, value: float, error: float) -> ConstantWithError:
        """What a function of this number is, within an error: equal arguments have equal values."""
        return ConstantWithError(value, error, (_combined(name, _origin(self)), False))


def error_of(x: float) -> float:
    """The bound of a number; 0 for any plain one."""
    return x.error if isinstance(x, ConstantWithError) else 0.0


def origin_of(x: float) -> Origin | None:
    """Which number it is, where its value does not say."""
    return x.origin if isinstance(x, ConstantWithError) and x.error else None


def exactly(x: float, value: float) -> bool:
    """Whether a number is that value, without error."""
    return x == value and not error_of(x)  # also of a fraction that rounds to it


def is_power_of_two(x: float) -> bool:
    """Whether it is 1, 2, 4, 1/2, ... or minus one of them."""
    return math.frexp(abs(x))[0] == 0.5


def _rounding(result: float, scaled: bool) -> float:
    """Of a product or quotient of numbers that are not 0; one by a power of two is rounded only where it underflows."""
    if abs(result) < sys.float_info.min:
        return UNDERFLOW
    return 0.0 if scaled else UNIT_ROUNDOFF * abs(result)


def _known(x: float) -> ConstantWithError:
    return x if isinstance(x, ConstantWithError) else ConstantWithError(x)


def _origin(x: float) -> Origin:
    """Which number it is; exact ones are told apart by their values."""
    return origin_of(x) or (abs(float(x)).hex().encode(), x < 0.0)


def _combined(operation: str, *operands: Origin) -> bytes:
    """The name of a result, of a fixed length: two that differ have the same one with a chance of 2^-128."""
    text = b" ".join(b"-" * sign + name for name, sign in operands)
    return blake2b(operation.encode() + b" " + text, digest_size=16).hexdigest().encode()
