"""Bodies as consumers see them that merge fixed joints: mass and inertia of links with what is fixed to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.solids import rotation
from rttrr_pin.inspection.reading import Document


@dataclass(frozen=True, eq=False)
class Lump:
    """A link with all that is fixed to it.

    Attributes:
        members: the names of the links, the one that carries the others first.
        mass: [kg].
        first: mass times centre of mass, in the link frame, (3,) [kg m].
        inertia: about the centre of mass, in link axes, (3, 3) [kg m^2]; of a lump with one massive member these are
            that member's numbers, turned if its frame is.
    """

    members: tuple[str, ...]
    mass: float
    first: Array
    inertia: Array

    def __add__(self, other: Lump) -> Lump:
        """Both together, in the same frame."""
        members, mass = self.members + other.members, self.mass + other.mass
        inertia = self.inertia + other.inertia
        if self.mass and other.mass and mass:
            d = self.first / self.mass - other.first / other.mass
            inertia = inertia + self.mass * other.mass / mass * (d @ d * np.eye(3) - np.outer(d, d))
        return Lump(members, mass, self.first + other.first, inertia)

    def placed(self, R: Array, p: Array) -> Lump:
        """The same in the frame of a parent, where the link's frame has rotation R and origin p."""
        turned = self.inertia if np.array_equal(R, np.eye(3)) else R @ self.inertia @ R.T
        return Lump(self.members, self.mass, R @ self.first + self.mass * p, turned)


def lumps(document: Document, massive_only: bool = False, spare: str = "") -> dict[str, Lump]:
    """The lump of each link that is not itself fixed to another.

    Args:
        document: the file.
        massive_only: whether links whose mass is not above zero count for nothing.
        spare: a link to which nothing is merged.
    """
    found = {name: _own(document, name, massive_only) for name in document.links}
    for _, name in reversed(list(document.walk())):
        joint = document.carried_by.get(name)
        if joint is not None and not joint.moves and joint.parent != spare:
            found[joint.parent] += found.pop(name).placed(rotation(joint.rpy), np.array(joint.xyz))
    return found


def _own(document: Document, name: str, massive_only: bool) -> Lump:
    inertial = document.links[name].inertial
    if inertial is None or (massive_only and inertial.mass.exact <= 0):
        return Lump((name,), 0.0, np.zeros(3), np.zeros((3, 3)))
    mass = float(inertial.mass)
    return Lump((name,), mass, mass * np.array(inertial.com), inertial.inertia)
