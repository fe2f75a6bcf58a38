"""The reference recursion on a batch, for tests that need its own bits, or too many robots to compile each."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rttrr_pin import Robot
from rttrr_pin.core.batch import split_columns
from rttrr_pin.core.dynamics import evaluate
from rttrr_pin.core.inputs import Coordinates, coordinates
from rttrr_pin.core.payload import Payloads, loads_of
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.core.wrench import RESULTS, LinkWrenches


def recursion(robot: Robot, q: Coordinates, v: Coordinates, a: Coordinates, payload: Payloads = None) -> LinkWrenches:
    """`Robot.inverse_dynamics` by the recursion and not by compiled code; a payload has no batch axes or one."""
    states = [coordinates(name, x, robot.model.moving) for name, x in (("q", q), ("v", v), ("a", a))]
    batch = np.broadcast_shapes(*(x.shape[:-1] for x in states))
    rows = math.prod(batch)
    arrays = [np.broadcast_to(x, (*batch, x.shape[-1])).reshape(rows, x.shape[-1]) for x in states]
    scalars: list[Any] = evaluate(robot.model, FLOAT, *arrays, loads_of(robot.model, payload)).scalars(RESULTS)
    numbers = np.empty((rows, len(scalars)))
    for column, scalar in enumerate(scalars):
        numbers[:, column] = scalar
    parts = {key: x.reshape(*batch, *x.shape[1:]) for key, x in split_columns(robot.model, numbers, RESULTS).items()}
    return LinkWrenches.of(parts, robot.link_names, robot.model.v_names)
