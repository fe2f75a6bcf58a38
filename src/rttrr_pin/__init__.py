"""Validates rigid-body dynamics: a hand-written Newton-Euler recursion against Pinocchio, link by link.

>>> import rttrr_pin
>>> robot = rttrr_pin.load("rttrr")
>>> tau = robot.inverse_dynamics(q=[0, 0, 0, 0, 0], v=[0, 0, 0, 0, 0], a=[0, 0, 0, 0, 0]).tau
"""

from __future__ import annotations

from rttrr_pin.errors import RttrrError
from rttrr_pin.model import LinkWrenches, Wrench
from rttrr_pin.robot import Robot, load

__version__ = "0.1.0"

__all__ = ["LinkWrenches", "Robot", "RttrrError", "Wrench", "__version__", "load"]
