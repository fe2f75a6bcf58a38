"""Time of a trajectory: its unit, its usual step, and the gaps in it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError

UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

WORDS = {"s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}

NEXT_UNIT = {"s": 0.5, "ms": 500.0, "us": 1e5}
"""Distance of rows from which the unit is not this one: a robot that is sampled twice a second tells nothing."""

FASTEST = 30.0
"""Rate [rad/s or m/s] that no joint has for which the file sets no limit."""

BEYOND = 3.0
"""Times its limit a joint is not as fast."""

GAP = 5.0
"""Times the usual distance of two rows: farther apart they are not of one motion."""


FAR = 1_000_000
"""Times beyond it count from the first row: since 1970 a microsecond is lost else."""


def origin_of(first: float) -> int:
    """Where time begins: 0, unless the first time is so large that digits would be lost."""
    return int(first) if FAR <= abs(first) < math.inf else 0


def counted_from(origin: int) -> str:
    """A note of where time begins; empty where that is 0."""
    return f"time counts from {origin}" if origin else ""


def time_of(column: NDArray[Any], origin: int) -> Array:
    """A column of numbers as float64, from an origin; integers keep their digits."""
    if column.dtype.kind in "iu" and origin:
        column = column - column.dtype.type(origin)
    elif origin:
        column = column.astype(np.float64) - origin
    return np.asarray(column, np.float64)


def unit_of(t: Array, values: Mapping[str, Array], model: Model) -> tuple[str, str]:
    """The unit of time, and a note where it is not seconds.

    It is that in which q changes as v says; without v, in which rows are as far apart as they can be.
    """
    if len(t) < 2:
        return "s", ""
    step = float(np.median(np.diff(t)))
    unit = next((own for own, limit in NEXT_UNIT.items() if step < limit), "ns")
    if "q" in values and model.nq == model.nv:
        moved = np.abs(np.diff(values["q"], axis=0))
        rate = np.abs(values["v"][1:] * np.diff(t)[:, None]).sum() if "v" in values else 0.0
        if moved.sum() and rate:
            unit = min(UNITS, key=lambda own: abs(np.log(rate * UNITS[own] / moved.sum())))
        elif unit != "s" and (moved / np.diff(t)[:, None] / UNITS[unit] > _fastest(model)).any():
            unit = "s"  # points of a path, seconds apart: in a smaller unit no joint could follow
    note = f"time is taken as {WORDS[unit]}, since rows are {step:.6g} apart" if unit != "s" else ""
    return unit, note


def _fastest(model: Model) -> Array:
    """Rates that no joint has, (nv,)."""
    limits = [joint.limits.velocity for joint in model.moving for _ in range(joint.nv)]
    return np.array([BEYOND * own if 0.0 < own < np.inf else FASTEST for own in limits])


def known_unit(unit: str | None) -> float | None:
    """The unit that a caller names, in seconds.

    Raises:
        InputError: it is none.
    """
    if unit is None:
        return None
    if not isinstance(unit, str) or unit not in UNITS:
        raise InputError(f"time_unit is {unit!r}: expected {', '.join(map(repr, UNITS))}", {"time_unit": "--time-unit"})
    return UNITS[unit]
