"""Where Pinocchio has the links of a file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array, norm, product
from rttrr_pin.core.model import Model


class PinLinks(NamedTuple):
    """The links of the file, where Pinocchio has them: on a joint, at a placement; (links, ...) each.

    Attributes:
        fixed: whether a fixed joint carries it, so that Pinocchio merged it into the body of `joint`.
        joint: Pinocchio's joint that moves it; 0 is the universe.
        R: maps vectors of the link frame to the joint frame.
        p: from the joint frame's origin to the link's, in the joint frame [m].
        mass: [kg].
        com: in the link frame [m].
        inertia: about the centre of mass, in link axes [kg m^2].
    """

    fixed: NDArray[np.bool_]
    joint: NDArray[np.int64]
    R: Array
    p: Array
    mass: Array
    com: Array
    inertia: Array

    def at(self, which: int | NDArray[np.bool_]) -> PinLinks:
        """One of them, or some."""
        return PinLinks._make(x[which] for x in self)

    @property
    def arm(self) -> Array:
        """The distances of their origins from the joints' [m]."""
        return norm(self.p)

    @property
    def stretch(self) -> Array:
        """How far the R are from rotations, |R^T R - 1|: they were multiplied up from matrices that are rounded."""
        stretch: Array = np.linalg.norm(np.swapaxes(self.R, -1, -2) @ self.R - np.eye(3), axis=(-2, -1))
        return stretch

    @property
    def massive(self) -> NDArray[np.bool_]:
        """Which have any inertia."""
        massive: NDArray[np.bool_] = (self.mass != 0.0) | self.inertia.any(axis=(-2, -1))
        return massive

    def to_joint(self, f: Array, n: Array) -> Array:
        """Forces and moments at the links' origins, (N, ..., 3) each, at the joints': (N, ..., 6)."""
        f, n = product(self.R, f), product(self.R, n)
        return np.concatenate([f, n + np.cross(self.p, f)], axis=-1)

    def from_joint(self, link: int, force: Array) -> Array:
        """A spatial force at the joint's origin, (6, N), at the link's."""
        R, (x, y, z), (f_x, f_y, f_z), n = self.R[link], self.p[link], force[:3], force[3:]
        about_link = n[0] - (y * f_z - z * f_y), n[1] - (z * f_x - x * f_z), n[2] - (x * f_y - y * f_x)
        parts = ((R[0, k] * u[0] + R[1, k] * u[1] + R[2, k] * u[2] for k in range(3)) for u in (force, about_link))
        return np.stack([x for part in parts for x in part])


def carriers(model: Model, links: PinLinks) -> list[int]:
    """The fixed link that carries each link; -1 where a joint that moves does, or the base."""
    parents = (joint.parent for joint in model.joints)
    return [p if p >= 0 and links.fixed[p] else -1 for p in parents]


def acting(model: Model, links: PinLinks, loaded: Iterable[int] = ()) -> list[bool]:
    """Of each link, whether it moves, or anything with mass or a payload is on it or further out."""
    acts: list[bool] = (~links.fixed | links.massive).tolist()
    for link in loaded:
        acts[link] = True
    for i, joint in reversed(list(enumerate(model.joints))):
        if joint.parent >= 0:
            acts[joint.parent] = acts[joint.parent] or acts[i]
    return acts
