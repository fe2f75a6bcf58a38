"""The reference recursion on a batch, for tests that need its own bits, or too many robots to compile each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rttrr_pin import Robot
from rttrr_pin.core.batch import empty_wrenches, fill
from rttrr_pin.core.dynamics import evaluate
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.core.wrench import LinkWrenches


def recursion(robot: Robot, q: np.ndarray, v: np.ndarray, a: np.ndarray, loads: Sequence[Load] = ()) -> LinkWrenches:
    """All quantities at states q (N, nq), v, a (N, nv)."""
    out = empty_wrenches(robot.model, len(q))
    fill(out, slice(None), evaluate(robot.model, FLOAT, q, v, a, loads))
    return out
