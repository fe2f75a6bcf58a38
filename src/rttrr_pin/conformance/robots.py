"""The robots that levels are asked with: files in urdf/levels, no machines, each with what its level needs."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from rttrr_pin.core.joint import JointEffects
from rttrr_pin.errors import UnknownNameError
from rttrr_pin.loading import load
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.catalogue import bundled

ARMATURE = 0.25
"""Of the first joint of `effects`; each further one has as much more [kg m^2 or kg]."""


@cache
def level_robots() -> dict[str, Path]:
    """The files, by the robot's name; the bundled arm of the paper is one of them."""
    rttrr = bundled()["rttrr"]
    own = {path.stem: path for path in sorted((rttrr.parent / "levels").glob("*.urdf"))}
    return {"rttrr": rttrr, **own, "floating": own["tree"]}


@cache
def level_robot(name: str) -> Robot:
    """One of them, as its level asks for it.

    `floating` is `tree` on a floating base; of `effects`, damping and friction of the file and an armature take part.

    Raises:
        UnknownNameError: there is no such robot.
    """
    if name not in level_robots():
        raise UnknownNameError("robot of a level", name, level_robots())
    path = level_robots()[name]
    if name == "floating":
        return load(path, base="floating")
    if name != "effects":
        return load(path)
    robot = load(path, friction=True)
    own = {joint.name: joint.effects for joint in robot.model.moving}
    return robot.with_joint_effects(
        {
            joint: JointEffects(ARMATURE * k, effects.damping, effects.friction)
            for k, (joint, effects) in enumerate(own.items(), 1)
        }
    )
