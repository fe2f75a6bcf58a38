"""Robots that several test modules share."""

from __future__ import annotations

from rttrr_pin import JointEffects, Robot

BUNDLED = ("rttrr", "trr", "trtr", "trtrr", "trttr")
BASES = ("fixed", "floating")


def driven(robot: Robot) -> Robot:
    """Armature, damping and friction in every joint that moves, followers too."""
    moving = [joint.name for joint in robot.model.joints if joint.nv]
    return robot.with_joint_effects({name: JointEffects(0.25 + i, 0.5, 0.75) for i, name in enumerate(moving)})
