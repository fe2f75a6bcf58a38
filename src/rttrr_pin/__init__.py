"""Validates rigid-body dynamics: a hand-written Newton-Euler recursion against Pinocchio, link by link.

>>> import rttrr_pin
>>> robot = rttrr_pin.load("rttrr")
>>> tau = robot.inverse_dynamics(q=[0, 0, 0, 0, 0], v=[0, 0, 0, 0, 0], a=[0, 0, 0, 0, 0]).tau
"""

from __future__ import annotations

from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.wrench import LinkWrenches, Wrench
from rttrr_pin.errors import RttrrError
from rttrr_pin.loading import load, load_all
from rttrr_pin.robot import Robot

__version__ = "0.1.0"

__all__ = ["JointEffects", "LinkWrenches", "Robot", "RttrrError", "Wrench", "__version__", "load", "load_all"]
