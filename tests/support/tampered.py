"""Models that differ in one number from the file that they were read from."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.model import Model


def with_link(model: Model, **changes: Any) -> Model:
    links = list(model.links)
    links[2] = replace(links[2], **changes)
    return replace(model, links=tuple(links))


def with_joint(model: Model, **changes: Any) -> Model:
    joints = list(model.joints)
    joints[2] = replace(joints[2], **changes)
    return replace(model, joints=tuple(joints))


TAMPERED: dict[str, tuple[Any, str]] = {
    "mass": (lambda m: with_link(m, mass=m.links[2].mass * (1 + 1e-12)), "link 'link_3' mass"),
    "com": (lambda m: with_link(m, com=m.links[2].com + [0, 1e-12, 0]), "link 'link_3' centre of mass"),
    "inertia": (lambda m: with_link(m, inertia=m.links[2].inertia * (1 + 1e-9)), "link 'link_3' inertia"),
    "placement": (lambda m: with_joint(m, p=m.joints[2].p + [0, 0, 1e-12]), "joint 'joint_3' placement p"),
    "turned": (lambda m: with_joint(m, R=np.diag([1.0, -1.0, -1.0])), "joint 'joint_3' placement R"),
    "axis": (lambda m: with_joint(m, axis=-m.joints[2].axis), "joint 'joint_3' axis"),
    "lower": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, lower=-9.0)), "joint 'joint_3' lower limit"),
    "upper": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, upper=9.0)), "joint 'joint_3' upper limit"),
    "velocity": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, velocity=9.0)), "joint 'joint_3' velocity"),
    "effort": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, effort=9.0)), "joint 'joint_3' effort"),
    "name": (lambda m: with_joint(m, name="joint_x"), "moving joints: joint_1"),
    "damping": (lambda m: with_joint(m, dynamics=JointEffects(damping=0.1)), "joint 'joint_3' damping"),
    "friction": (lambda m: with_joint(m, dynamics=JointEffects(friction=0.1)), "joint 'joint_3' friction"),
}
"""A change of link 3 or joint 3 of the bundled arm, and how the difference is reported."""
