"""Robots without shapes, and where the joints of the others are: cylinders from joint to joint, and joint axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.core.model import Model
from rttrr_pin.viewing.scene import Arrows, Placement

AXIS = 0.12
"""The length of a joint axis, of the size of the robot; half of it on either side."""


@dataclass(frozen=True, slots=True, eq=False)
class Skeleton:
    """Lines of a robot, in world axes.

    Attributes:
        bones: from the origin of each link's parent to its own; and from the origin of a link that carries no other to
            its centre of mass.
        axes: of the joints that turn or slide, about their origins.
    """

    bones: Arrows
    axes: Arrows


def skeleton(model: Model, where: Placement, reach: float) -> Skeleton:
    """The skeleton of a robot at a placement of its links."""
    parents = np.array([joint.parent for joint in model.joints], dtype=int)
    origins = np.vstack([where.p, np.zeros(3)])  # the last is the root's, whose index is -1
    floats = np.array([joint.parent < 0 and joint.nv == 6 for joint in model.joints], dtype=bool)
    begin = np.where(floats[:, None], where.p, origins[parents]) if len(parents) else np.zeros((0, 3))
    ends = [i for i in model.leaves() if np.any(model.links[i].com)]
    at = np.concatenate([begin, where.p[ends]])
    to = np.concatenate([where.p, where.com[ends]])
    turning = [i for i, joint in enumerate(model.joints) if joint.type.has_direction]
    directions: Array = np.array([model.joints[i].axis for i in turning]).reshape(-1, 3)
    axis = product(where.R[turning], directions) * (AXIS * reach)
    return Skeleton(Arrows(at, to - at), Arrows(where.p[turning] - axis / 2.0, axis))
