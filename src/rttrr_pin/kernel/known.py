"""A number of the robot with a bound on its error: how far rounding took it from the number that is meant."""

from __future__ import annotations

import math

from rttrr_pin.arithmetic import UNIT_ROUNDOFF


class Known(float):
    """A float whose true value is known to lie within `error` of it; sums and products carry the bound along.

    It is a float everywhere else: what is traced on such numbers is traced as on floats. With |x - x_true| <= e_x and
    |y - y_true| <= e_y, fl(x + y) is off by at most e_x + e_y and its own rounding, fl(x y) by at most
    |x| e_y + |y| e_x + e_x e_y and its own, fl(x / y) by at most (e_x + |x / y| e_y) / (|y| - e_y) and its own.
    Rounding is counted only where there is some.

    Attributes:
        error: the bound.
    """

    __slots__ = ("error",)
    error: float

    def __new__(cls, value: float, error: float = 0.0) -> Known:
        """The float, with its bound."""
        number = super().__new__(cls, value)
        number.error = error
        return number

    def __add__(self, other: object) -> Known:
        if not isinstance(other, int | float):
            return NotImplemented
        x, y = float(self), float(other)
        total = x + y
        part = total - x
        rounding = abs((x - (total - part)) + (y - part))  # exactly (Knuth)
        return Known(total, self.error + error_of(other) + rounding)

    __radd__ = __add__

    def __neg__(self) -> Known:
        return Known(-float(self), self.error)

    def __abs__(self) -> Known:
        return Known(abs(float(self)), self.error)

    def __sub__(self, other: object) -> Known:
        if not isinstance(other, int | float):
            return NotImplemented
        return self + (-other)

    def __rsub__(self, other: object) -> Known:
        if not isinstance(other, int | float):
            return NotImplemented
        return (-self) + other

    def __mul__(self, other: object) -> Known:
        if not isinstance(other, int | float):
            return NotImplemented
        x, y, error = float(self), float(other), error_of(other)
        product = x * y
        rounding = 0.0 if _exact(x) or _exact(y) else UNIT_ROUNDOFF * abs(product)
        return Known(product, abs(x) * error + abs(y) * self.error + self.error * error + rounding)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Known:
        if not isinstance(other, int | float):
            return NotImplemented
        x, y, error = float(self), float(other), error_of(other)
        quotient = x / y
        rounding = 0.0 if is_power_of_two(y) else UNIT_ROUNDOFF * abs(quotient)
        least = abs(y) - error  # of what is divided by
        inherited = (self.error + abs(quotient) * error) / least if least > 0.0 else math.inf
        return Known(quotient, inherited + rounding)

    def __rtruediv__(self, other: object) -> Known:
        if not isinstance(other, int | float):
            return NotImplemented
        return Known(other) / self


def error_of(x: float) -> float:
    """The bound of a number; 0 for any plain one."""
    return x.error if isinstance(x, Known) else 0.0


def exactly(x: float, value: float) -> bool:
    """Whether a number is that value, without error."""
    return x == value and not error_of(x)  # also of a fraction that rounds to it


def is_power_of_two(x: float) -> bool:
    """Whether it is 1, 2, 4, 1/2, ... or minus one of them."""
    return math.frexp(abs(x))[0] == 0.5


def _exact(x: float) -> bool:
    """Whether a product with it needs no rounding."""
    return x == 0.0 or is_power_of_two(x)
