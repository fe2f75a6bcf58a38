"""The scalar (value, error bound): a bound on the rounding error of each result, state by state.

On this scalar the reference recursion computes the same values by the same operations as on floats, and beside each a
running error bound (Wilkinson; Higham, "Accuracy and Stability of Numerical Algorithms", section 3.3). With
|x - x_true| <= b_x, |y - y_true| <= b_y and u the unit roundoff:

    z = fl(x + y):  |z - z_true| <= b_x + b_y + u |z|
    z = fl(x y):    |z - z_true| <= |x| b_y + |y| b_x + b_x b_y + u |z| + underflow

The bounds are float64 too. Their own rounding is covered by one factor at the end (`SLACK`): every bound is a sum of
products of non-negative numbers, so it has a relative error of at most its depth times u, below 1e-11 for any robot
that fits in memory. What a product or its bound lose where they underflow is covered by `UNDERFLOW`; sums lose nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import split_columns
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, payloads_of
from rttrr_pin.core.scalars import FLOAT, SINE_ULPS, SLACK, UNDERFLOW, UNIT_ROUNDOFF, Arithmetic, columns
from rttrr_pin.core.wrench import RESULTS, LinkWrenches

Real: TypeAlias = Any  # float | Array: what NumPy's stubs cannot combine without casts

PLAIN = (int, float)


@dataclass(slots=True, eq=False)  # never changed; not frozen, which doubles what making one takes
class Bounded:
    """A computed value and a bound on its distance from the true one.

    Plain numbers beside it are small integers (0, 1, -1, 2) and powers of two, which are exact, also among themselves.
    Any other operand takes the operation over, as dual numbers do.

    Attributes:
        value: as floating-point arithmetic gives it.
        bound: at least |value - true value|.
    """

    value: Real
    bound: Real

    def __add__(self, other: Any) -> Bounded:
        if isinstance(other, Bounded):
            value = self.value + other.value
            return Bounded(value, self.bound + other.bound + UNIT_ROUNDOFF * abs(value))
        if not isinstance(other, PLAIN):
            return NotImplemented
        if other == 0:
            return self
        value = self.value + other
        return Bounded(value, self.bound + UNIT_ROUNDOFF * abs(value))

    __radd__ = __add__

    def __neg__(self) -> Bounded:
        return Bounded(-self.value, self.bound)

    def __sub__(self, other: Any) -> Bounded:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Bounded:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Bounded | int:
        if isinstance(other, Bounded):
            x, y, b_x, b_y = self.value, other.value, self.bound, other.bound
            value = x * y
            # |x| b_y + |y| b_x + b_x b_y, the error from those of the factors; most factors are exact.
            if isinstance(b_y, float) and b_y == 0.0:
                inherited = b_x * abs(y)
            elif isinstance(b_x, float) and b_x == 0.0:
                inherited = b_y * abs(x)
            else:
                inherited = abs(x) * b_y + (abs(y) + b_y) * b_x
            return Bounded(value, inherited + (UNIT_ROUNDOFF * abs(value) + UNDERFLOW))
        if not isinstance(other, PLAIN):
            return NotImplemented
        if other == 0:
            return 0
        if other in (1, -1):
            return self if other == 1 else -self
        value = self.value * other
        return Bounded(value, self.bound * abs(other) + (UNIT_ROUNDOFF * abs(value) + UNDERFLOW))

    __rmul__ = __mul__


def _number(value: float, error: float) -> Scalar:
    """A number of the model; an exact 0, 1 or -1 stays a plain integer, so that products with it are exact."""
    if error == 0.0 and value in (0.0, 1.0, -1.0):
        return int(value)
    return Bounded(value, error)


def _sincos(q: Bounded | int) -> tuple[Bounded, Bounded]:
    """Sine and cosine have slopes of at most one, so the bound of q carries over; q of a joint at rest may be plain."""
    if not isinstance(q, Bounded):
        q = Bounded(float(q), 0.0)
    of_value: tuple[Real, Real] = FLOAT.sincos(q.value)
    s, c = of_value
    ulps = 2 * SINE_ULPS * UNIT_ROUNDOFF
    return Bounded(s, q.bound + ulps * abs(s)), Bounded(c, q.bound + ulps * abs(c))


def _sign(x: Bounded | int) -> Bounded | int:
    """The sign of a rate, which is an exact double or the plain 0."""
    return Bounded(FLOAT.sign(x.value), 0.0) if isinstance(x, Bounded) else x


BOUNDED = Arithmetic(
    number=_number,
    column=lambda values: Bounded(values, 0.0),
    sincos=_sincos,
    sign=_sign,
)


def coordinate_scalars(model: Model, q: Array) -> list[Bounded]:
    """Coordinates as scalars: exact doubles, except for quaternions, which doubles do not hold at unit length.

    The quaternion s = (x, y, z, w) stands for s / |s|. Each component differs relatively by at most
    | |s| - 1 | <= | |s|^2 - 1 |, whose square is computed here within 4 u.

    Args:
        model: the robot.
        q: coordinates, (N, nq) [rad or m].
    """
    scalars = [Bounded(column, 0.0) for column in columns(q)]
    for at in model.quaternions:
        quaternion = scalars[at : at + 4]
        defect = abs(sum(c.value * c.value for c in quaternion) - 1.0) + 8 * UNIT_ROUNDOFF
        scalars[at : at + 4] = [Bounded(c.value, abs(c.value) * defect) for c in quaternion]
    return scalars


def bounded_dynamics(
    model: Model, q: Array, v: Array, a: Array, loads: Sequence[Load] = ()
) -> tuple[LinkWrenches, LinkWrenches]:
    """Inverse dynamics of a batch, and a bound on the rounding error of each number.

    Args:
        model: the robot.
        q: coordinates, (N, nq) [rad or m]; the doubles are exact, quaternions stand for those of unit length.
        v: rates, (N, nv).
        a: accelerations, (N, nv).
        loads: payloads.

    Returns:
        The values, the same bits as the readable recursion gives, and the bounds, in arrays of the same shapes:
        the true value lies within bound of value.
    """
    rows = len(q)
    v_, a_ = ([Bounded(column, 0.0) for column in columns(x)] for x in (v, a))
    result = dynamics(model, BOUNDED, coordinate_scalars(model, q), v_, a_, payloads_of(loads, BOUNDED))
    parts = (split_columns(model, x, RESULTS) for x in values_and_bounds(result.scalars(RESULTS), rows))
    values, bounds = (LinkWrenches.of(x, model.link_names, model.v_names) for x in parts)
    return values, bounds


def values_and_bounds(scalars: Sequence[Any], rows: int) -> tuple[Array, Array]:
    """Values and bounds of scalars, (N, scalars) each."""
    values, bounds = np.empty((rows, len(scalars))), np.zeros((rows, len(scalars)))
    for column, scalar in enumerate(scalars):
        if isinstance(scalar, Bounded):
            values[:, column] = scalar.value
            bounds[:, column] = scalar.bound * SLACK
        else:
            values[:, column] = scalar
    return values, bounds
