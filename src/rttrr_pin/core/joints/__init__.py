"""Joint types: one file for each, and one line here."""

from __future__ import annotations

from rttrr_pin.core.joints.base import JointType
from rttrr_pin.core.joints.fixed import Fixed
from rttrr_pin.core.joints.floating import Floating
from rttrr_pin.core.joints.planar import Planar
from rttrr_pin.core.joints.prismatic import Prismatic
from rttrr_pin.core.joints.revolute import Continuous, Revolute

__all__ = ["CONTINUOUS", "FIXED", "FLOATING", "JOINT_TYPES", "PLANAR", "PRISMATIC", "REVOLUTE", "JointType"]

REVOLUTE = Revolute()
CONTINUOUS = Continuous()
PRISMATIC = Prismatic()
PLANAR = Planar()
FLOATING = Floating()
FIXED = Fixed()

JOINT_TYPES: dict[str, JointType] = {
    joint_type.name: joint_type for joint_type in (REVOLUTE, CONTINUOUS, PRISMATIC, PLANAR, FLOATING, FIXED)
}
"""The joint types of URDF, by its words."""
