"""Robots and states as Pinocchio has them, written out apart from the implementation that tests compare with."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from rttrr_pin import Robot
from rttrr_pin.core.joints import CONTINUOUS, PLANAR


def pin_model(robot: Robot) -> Any:
    root = (pin.JointModelFreeFlyer(),) if robot.model.floating else ()
    return pin.buildModelFromXML(robot.model.urdf, *root)


def pin_q(robot: Robot, q: np.ndarray) -> np.ndarray:
    """One state in Pinocchio's coordinates."""
    out: list[float] = []
    at = 0
    for joint in robot.model.moving:
        own = q[at : at + joint.nq].tolist()
        at += joint.nq
        out += [*own[:-1], np.cos(own[-1]), np.sin(own[-1])] if joint.type in (CONTINUOUS, PLANAR) else own
    return np.array(out)
