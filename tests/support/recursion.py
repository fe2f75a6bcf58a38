"""The reference recursion on a batch, for tests that need its own bits, or too many robots to compile each."""

from __future__ import annotations

import math

import numpy as np

from rttrr_pin import Robot
from rttrr_pin.core.batch import RESULTS, empty_wrenches, fill
from rttrr_pin.core.dynamics import evaluate
from rttrr_pin.core.inputs import Coordinates, coordinates
from rttrr_pin.core.payload import Payloads, loads_of
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.core.wrench import LinkWrenches


def recursion(robot: Robot, q: Coordinates, v: Coordinates, a: Coordinates, payload: Payloads = None) -> LinkWrenches:
    """`Robot.inverse_dynamics` by the recursion and not by compiled code; a payload has no batch axes or one."""
    states = [coordinates(name, x, robot.model.moving) for name, x in (("q", q), ("v", v), ("a", a))]
    batch = np.broadcast_shapes(*(x.shape[:-1] for x in states))
    rows = math.prod(batch)
    arrays = [np.broadcast_to(x, (*batch, x.shape[-1])).reshape(rows, x.shape[-1]) for x in states]
    out = empty_wrenches(robot.model, rows)
    fill(out, slice(None), evaluate(robot.model, FLOAT, *arrays, loads_of(robot.model, payload)))
    parts = {key: getattr(out, key).reshape(*batch, *getattr(out, key).shape[1:]) for key in RESULTS}
    return LinkWrenches.of(parts, out.links, out.joints)
