"""The reference recursion in any number of digits, by mpmath."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

from rttrr_pin.core.dynamics import evaluate
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import Arithmetic


def mp_arithmetic() -> Arithmetic:
    number = lambda value, error: mpmath.mpf(value)
    return Arithmetic(number, mpmath.mpf, sincos=lambda q: (mpmath.sin(q), mpmath.cos(q)), sign=mpmath.sign)


def exact_dynamics(
    model: Model, q: np.ndarray, v: np.ndarray, a: np.ndarray, loads: list[Load]
) -> dict[str, np.ndarray]:
    """The five quantities of one state in 60 digits."""
    result = evaluate(model, mp_arithmetic(), q, v, a, loads)
    out = {
        key: np.array([list(vector) for vector in getattr(result, key)], dtype=object) for key in ("F", "N", "f", "n")
    }
    return out | {"tau": np.array(result.tau, dtype=object)}


def mp_rotation(rpy: list[str]) -> Any:
    """R = Rz(yaw) Ry(pitch) Rx(roll) of decimal angles, in the working precision of mpmath."""
    (r, p, y) = (mpmath.mpf(float(word)) for word in rpy)
    x = mpmath.matrix([[1, 0, 0], [0, mpmath.cos(r), -mpmath.sin(r)], [0, mpmath.sin(r), mpmath.cos(r)]])
    yy = mpmath.matrix([[mpmath.cos(p), 0, mpmath.sin(p)], [0, 1, 0], [-mpmath.sin(p), 0, mpmath.cos(p)]])
    z = mpmath.matrix([[mpmath.cos(y), -mpmath.sin(y), 0], [mpmath.sin(y), mpmath.cos(y), 0], [0, 0, 1]])
    return z * yy * x
