"""Where the links of a robot are, and how a picture looks at them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints.base import JointType
from rttrr_pin.core.model import Model
from rttrr_pin.core.placements import in_base

AZIMUTHS = tuple(quarter + off for quarter in (0, 90, 180, 270) for off in (45, 30, 60))
"""From where a robot may be looked at [deg]; the first of the best is taken."""

USUAL = 45
"""Degrees, of an isometric view; others are taken where they show clearly more."""

ELEVATION = np.radians(24.0)

MORE = 1.15
"""How much more another view shows before it is taken instead of the usual one."""


@dataclass(frozen=True, slots=True)
class Bone:
    """A link, where it is.

    Attributes:
        name: of the link.
        parent: index of the link that carries it; -1 for the root.
        kind: how it moves on it: `turn`, `slide`, `free` or `rigid`.
        R: R_0_i, (3, 3).
        p: p_0_i, (3,) [m].
        axis: of its joint, in base axes, (3,).
        com: centre of mass in the base frame, (3,) [m]; None without mass.
    """

    name: str
    parent: int
    kind: str
    R: Array
    p: Array
    axis: Array
    com: Array | None


def skeleton(model: Model, q: Array) -> tuple[Bone, ...]:
    """The root and all links of a robot at a state, q (nq,); a bone's parent is one before it."""
    R, p = in_base(model, np.asarray(q, dtype=np.float64)[None, :])
    root = Bone(model.root.name, -1, "root", np.eye(3), np.zeros(3), np.zeros(3), None)
    links = zip(model.links, model.joints, R[0], p[0], strict=True)
    return (
        root,
        *(
            Bone(
                link.name,
                joint.parent + 1,
                kind_of(joint),
                R_,
                p_,
                R_ @ joint.axis,
                p_ + R_ @ link.com if link.mass else None,
            )
            for link, joint, R_, p_ in links
        ),
    )


def kind_of(joint: Joint) -> str:
    """What a joint looks like."""
    return kind_of_type(joint.type)


def kind_of_type(kind: JointType) -> str:
    """The same of its type."""
    rotations = kind.rotations
    if not rotations:
        return "rigid"
    return "free" if len(rotations) > 1 else "turn" if rotations[0] else "slide"


def size_of(bones: Sequence[Bone]) -> float:
    """The longest side of the box around all origins [m]; around the centres of mass where all are at one place."""
    points = np.array([bone.p for bone in bones])
    size = float(np.ptp(points, axis=0).max())
    if size > 0.0:
        return size
    arms = [2.0 * float(np.linalg.norm(bone.com - bone.p)) for bone in bones if bone.com is not None]
    return max((arm for arm in arms if 0.0 < arm < np.inf), default=1.0)


@dataclass(frozen=True, slots=True)
class Camera:
    """A view from far away: across and up are unit vectors of the paper, in base axes."""

    across: Array
    up: Array

    @classmethod
    def at(cls, azimuth: float) -> Camera:
        """From an azimuth [rad] around z, from above."""
        c, s = np.cos(azimuth), np.sin(azimuth)
        across = np.array([-s, c, 0.0])
        up = np.array([-c * np.sin(ELEVATION), -s * np.sin(ELEVATION), np.cos(ELEVATION)])
        return cls(across, up)

    def __call__(self, points: Array) -> Array:
        """Points (..., 3) on the paper, (..., 2), y upwards [m]."""
        return np.stack([points @ self.across, points @ self.up], axis=-1)


def camera(bones: Sequence[Bone]) -> Camera:
    """The view that shows most of the bones' lengths; the usual isometric one unless another shows clearly more."""
    points = np.array([bone.p for bone in bones])
    tails = points[[max(bone.parent, 0) for bone in bones]]

    def seen(azimuth: int) -> float:
        view = Camera.at(float(np.radians(azimuth)))
        return float(np.linalg.norm(view(points) - view(tails), axis=1).sum())

    best = max(AZIMUTHS, key=seen)
    return Camera.at(float(np.radians(best if seen(best) > MORE * seen(USUAL) else USUAL)))
