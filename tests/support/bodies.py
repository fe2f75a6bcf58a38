"""Random links and joints as data, for robots that no URDF can write."""

from __future__ import annotations

import numpy as np

from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import JointType
from rttrr_pin.core.model import Link


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return R * np.sign(np.linalg.det(R))


def random_link(rng: np.random.Generator, name: str, mass: float | None = None) -> Link:
    """A link of four point masses, scaled to a mass of any sign; without one, of a possible body."""
    masses, points = rng.uniform(0.2, 2.0, 4), rng.uniform(-0.3, 0.3, (4, 3))
    scale = 1.0 if mass is None else mass / masses.sum()
    com = masses @ points / masses.sum()
    tensor = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, points - com, strict=True))
    return Link(name, float(scale * masses.sum()), com, scale * tensor)


def random_joint(rng: np.random.Generator, name: str, joint_type: JointType, parent: int) -> Joint:
    """A joint at a random placement, about a random axis where its type has one."""
    axis = rng.normal(size=3)
    axis = np.array(joint_type.axis_direction) if joint_type.axis_direction else axis / np.linalg.norm(axis)
    return Joint(name, joint_type, parent, random_rotation(rng), rng.uniform(-0.5, 0.5, 3), axis, rotated=True)
