"""What a robot is made of: links, joints, their tree, and where they come from."""

from __future__ import annotations

from rttrr_pin.model.joint import Drive, Joint, JointType, Limits, Mimic
from rttrr_pin.model.tree import STANDARD_GRAVITY, Link, Model
from rttrr_pin.model.wrench import QUANTITIES, LinkWrenches, Wrench

__all__ = [
    "QUANTITIES",
    "STANDARD_GRAVITY",
    "Drive",
    "Joint",
    "JointType",
    "Limits",
    "Link",
    "LinkWrenches",
    "Mimic",
    "Model",
    "Wrench",
]
