"""One recursion, many arithmetics: what it takes to run the reference recursion on one kind of scalar.

An `Arithmetic` says how a number of the model, a column of a batch and a sine become scalars of its kind. `FLOAT` is
that of the reference recursion: Python floats for one state, NumPy arrays for a batch, the same operations in the same
order, hence the same bits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import Scalar, SinCos
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.newton_euler import Call, Keep

UNIT_ROUNDOFF = 2.0**-53
"""u: the relative error of one correctly rounded float64 operation; eps is 2 u."""

EPS = 2 * UNIT_ROUNDOFF
"""The distance from 1 to the next float64: the unit in which errors are reported."""

UNDERFLOW = 2.0**-970
"""Absolute, in any unit: more than the 2^-1075 that a product and its bound each lose where they fall below the normal
numbers of float64. So large that its products with numbers of a robot stay normal, since others are slow."""

SLACK = 1.0 + 1e-9
"""Covers the rounding of running error bounds themselves."""

SINE_ULPS = 4
"""Error of a sine or cosine, in ulps, as NumPy states it for its vectorised float64; compiled code keeps within one."""

ROTATION_ERROR = 8 * UNIT_ROUNDOFF
"""Absolute, of an entry of a rotation matrix computed from rpy: a sum of two products of sines and cosines."""

AXIS_ERROR = 4 * UNIT_ROUNDOFF
"""Relative, of a component of an axis that was divided by its length."""


NumberOf = Callable[[float, float], Scalar]


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """How to compute with one kind of scalar.

    Attributes:
        number: from a float of the model, and a bound on how far rounding took it from what the file says.
        column: from the values of one coordinate: a float (one state) or an array (a batch).
        sincos: sine and cosine of such a column.
        sign: -1, 0 or 1 by the sign of a scalar's value.
        keep: what stands for a finished w, w_dot, v_dot, F, N, f or n.
        call: takes a step of the recursion.
    """

    number: NumberOf
    column: Callable[[float | Array], Scalar]
    sincos: SinCos
    sign: Callable[[Any], Scalar]
    keep: Keep = lambda x: x
    call: Call = lambda step, *arguments: step(*arguments)


def _float_sincos(q: float | Array) -> tuple[float | Array, float | Array]:
    """NumPy's sine and cosine also for one float, since the bits must not depend on the batch."""
    if isinstance(q, float):
        return float(np.sin(q)), float(np.cos(q))
    return np.sin(q), np.cos(q)


def _float_sign(x: float | Array) -> float | Array:
    return float(np.sign(x)) if isinstance(x, float) else np.sign(x)


FLOAT = Arithmetic(
    number=lambda value, error: value, column=lambda values: values, sincos=_float_sincos, sign=_float_sign
)


def columns(x: Array) -> list[float | Array]:
    """The columns of (N, n); floats where there is one state."""
    if len(x) == 1:
        return [float(value) for value in x[0]]
    return [np.ascontiguousarray(column) for column in x.T]
