"""Where everything of a state is, in world axes: frames, centres of mass, arrows of forces and moments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.placements import in_base
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.viewing.states import State

FORCES, MOMENTS = ("F", "f"), ("N", "n")

PAYLOAD = ("payload f", "payload n")
"""What the robot exerts on its surroundings."""


@dataclass(frozen=True, slots=True, eq=False)
class Arrows:
    """Vectors at points.

    Attributes:
        at: where each begins, (N, 3) [m].
        vector: (N, 3) [N or N m].
    """

    at: Array
    vector: Array

    @property
    def size(self) -> Array:
        """The length of each, (N,)."""
        return np.asarray(np.linalg.norm(self.vector, axis=-1))


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """Where the links are, in world axes: those of the root, at its origin.

    Attributes:
        R: R_0_i, (links, 3, 3).
        p: p_0_i, (links, 3) [m].
        com: centres of mass, (links, 3) [m].
    """

    R: Array
    p: Array
    com: Array


def placement(model: Model, q: Array) -> Placement:
    """Where the links are at coordinates (nq,), by the forward kinematics of the recursion."""
    R, p = (x[0] for x in in_base(model, q[None]))
    own = np.array([link.com for link in model.links]).reshape(-1, 3)
    return Placement(R, p, p + product(R, own))


def arrows(where: Placement, values: Mapping[str, Array], loads: Sequence[Load] = ()) -> dict[str, Arrows]:
    """F and N at the centres of mass, f and n at the joints, payloads at their links, in world axes.

    A quantity that is not given, or not finite somewhere, has no arrows there.
    """
    out = {}
    for key in LINK_QUANTITIES:
        if key in values:
            vector = product(where.R, values[key])
            vector = np.where(np.isfinite(vector).all(axis=-1, keepdims=True), vector, 0.0)
            out[key] = Arrows(where.com if key in ("F", "N") else where.p, vector)
    for key, part in zip(PAYLOAD, ("f", "n"), strict=True):
        at = where.p[[load.link for load in loads]].reshape(-1, 3)
        own = [getattr(load, part) for load in loads]
        vectors = [x if load.in_base else where.R[load.link] @ x for x, load in zip(own, loads, strict=True)]
        out[key] = Arrows(at, np.array(vectors).reshape(-1, 3))
    return out


def arrows_of(model: Model, state: State, values: Mapping[str, Array]) -> dict[str, Arrows]:
    """The arrows of a state with its numbers."""
    return arrows(placement(model, state.q), values, state.loads)


def reach(model: Model, where: Placement) -> float:
    """The size of a robot [m]: the longest edge of the box around origins and centres of mass; 1 where it has none."""
    points = np.concatenate([np.zeros((1, 3)), where.p, where.com])
    points = points[np.abs(points).max(axis=1) < 1e6]
    size = float((points.max(axis=0) - points.min(axis=0)).max())
    return size if size > 1e-6 else 1.0
