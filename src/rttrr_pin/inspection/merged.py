"""Links merged over fixed joints, as parsers see them that have no fixed joints."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.inertial import NO_INERTIAL


@dataclass(frozen=True, eq=False)
class MergedLink:
    """A link with all that is fixed to it.

    Attributes:
        members: the names of the links, the one that carries the others first.
        mass: [kg].
        moment: the first moment, mass times centre of mass, in the link frame, (3,) [kg m].
        inertia: about the centre of mass, in link axes, (3, 3) [kg m^2]; where only one member has mass these are that
            member's numbers, turned if its frame is: `SpatialInertia`, about the origin, would round them.
    """

    members: tuple[str, ...]
    mass: float
    moment: Array
    inertia: Array

    def __add__(self, other: MergedLink) -> MergedLink:
        """Both together, in the same frame."""
        members, mass = self.members + other.members, self.mass + other.mass
        inertia = self.inertia + other.inertia
        if self.mass and other.mass and mass:
            d = self.moment / self.mass - other.moment / other.mass
            inertia = inertia + self.mass * other.mass / mass * point_tensor(Vector.of(d)).array
        return MergedLink(members, mass, self.moment + other.moment, inertia)

    def moved(self, R: Array, p: Array) -> MergedLink:
        """The same in the frame of a parent, where the link's frame has rotation R and origin p."""
        turned = self.inertia if np.array_equal(R, np.eye(3)) else R @ self.inertia @ R.T
        return MergedLink(self.members, self.mass, R @ self.moment + self.mass * p, turned)


@lru_cache(maxsize=8)
def merged_links(document: UrdfDocument, massive_only: bool = False, spare: str = "") -> dict[str, MergedLink]:
    """Bodies as parsers see them that merge fixed joints: by name, each link that is not itself fixed to another.

    Args:
        document: the file.
        massive_only: whether links whose mass is not above zero count for nothing.
        spare: a link to which nothing is merged.
    """
    merged = {}
    for name, link in document.links.items():
        inertial = link.inertial or NO_INERTIAL
        if massive_only and inertial.mass.exact <= 0:
            inertial = NO_INERTIAL
        mass = float(inertial.mass)
        merged[name] = MergedLink((name,), mass, mass * inertial.origin.p, inertial.inertia)
    for _, name in reversed(list(document.walk())):
        joint = document.carried_by.get(name)
        if joint is not None and not joint.moves and joint.parent != spare:
            merged[joint.parent] += merged.pop(name).moved(joint.origin.R, joint.origin.p)
    return merged


def anchored(document: UrdfDocument) -> tuple[str, ...]:
    """The root and what is fixed to it."""
    return merged_links(document)[document.root].members
