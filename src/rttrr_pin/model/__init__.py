"""What a robot is made of: links, joints, their tree, and where they come from."""

from __future__ import annotations

from rttrr_pin.model.tree import STANDARD_GRAVITY, Joint, JointType, Limits, Link, Model
from rttrr_pin.model.wrench import QUANTITIES, LinkWrenches, Wrench

__all__ = ["QUANTITIES", "STANDARD_GRAVITY", "Joint", "JointType", "Limits", "Link", "LinkWrenches", "Model", "Wrench"]
