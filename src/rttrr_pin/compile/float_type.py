"""The floating-point types that a program can compute in, and what rounding in them can do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rttrr_pin.core import scalars
from rttrr_pin.core.inputs import UNIT_QUATERNION
from rttrr_pin.errors import InputError


@dataclass(frozen=True, slots=True)
class FloatType:
    """A type of numbers.

    Attributes:
        name: NumPy's.
        c_name: that in C, and in LLVM's assembly.
        bits: of a number.
        unit_roundoff: u, the relative error of one correctly rounded operation.
        underflow: absolute, in any unit: more than a product and its bound each lose where they fall below the normal
            numbers, and so large that its products with numbers of a robot stay normal, since others are slow.
        sine_ulps: the error of a sine or cosine by any emitter, in units in the last place.
        unit_quaternion: how far the squared length of a quaternion may be from 1.
    """

    name: str
    c_name: str
    bits: int
    unit_roundoff: float
    underflow: float
    sine_ulps: int
    unit_quaternion: float

    @property
    def size(self) -> int:
        """Bytes of a number."""
        return self.bits // 8

    def rounded(self, x: float) -> float:
        """The nearest number of this type; infinite where that is too large for it."""
        with np.errstate(over="ignore"):
            return float(np.dtype(self.name).type(x))

    def rounded_up(self, x: float) -> float:
        """The least number of this type that is not below x."""
        nearest = self.rounded(x)
        return nearest if nearest >= x else float(np.nextafter(np.dtype(self.name).type(nearest), math.inf))

    def slack(self, depth: int) -> float:
        """What a running error bound is multiplied with to cover the rounding of the bound itself.

        Args:
            depth: operations of the program from an input to a result, at most.
        """
        # Of the second order in u a bound counts twice what there is, so that its own errors count in first order only:
        # they are those of the longest way, with at most 8 roundings at each operation and at the end. Their product
        # (1 - u)^(8 (depth + 1)) is at least 1 - 8 (depth + 1) u, and 1 / (1 - x) <= 1 + 2 x up to x = 1/2, which takes
        # half a million operations in float32. `SLACK` covers as many in float64.
        return scalars.SLACK if self.bits == 64 else 1.0 + 16 * (depth + 1) * self.unit_roundoff


FLOAT64 = FloatType(
    "float64", "double", 64, scalars.UNIT_ROUNDOFF, scalars.UNDERFLOW, scalars.SINE_ULPS, UNIT_QUATERNION
)

FLOAT32 = FloatType("float32", "float", 32, 2.0**-24, 2.0**-110, 2, 2e-6)
"""Products lose 2^-150. NumPy states 1.5 units for its vectorised sine and cosine, the C library less than 1, and
compiled code keeps within one (`benchmarks/sincos_accuracy.py`). Quaternions of float32 are normalised to 5e-7."""

FLOAT_TYPES = {own.name: own for own in (FLOAT64, FLOAT32)}


def float_type(dtype: Any) -> FloatType:
    """The type that a user names: "float32", np.float32, np.dtype("f4"), ...

    Raises:
        InputError: it is another one.
    """
    try:
        own = np.dtype(dtype)
    except TypeError:
        own = None
    if own is None or dtype is None or not own.isnative or own.name not in FLOAT_TYPES:
        raise InputError(f"dtype is {dtype!r}: pass 'float64' or 'float32'")
    return FLOAT_TYPES[own.name]
