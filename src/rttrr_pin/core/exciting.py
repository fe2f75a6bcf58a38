"""Motion that shows what a regressor can tell: random states, all of whose terms are of about one size."""

from __future__ import annotations

import math

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model

GRAVITY = 10.0
"""Of this size are the accelerations that are drawn, also where there is no field [m/s^2]."""

Y_OVER = 3
"""Rows for each column: random states tell the rank of a robot with probability 1, and well if there are some more."""


def random_motion(model: Model, columns: int) -> tuple[Array, Array, Array]:
    """q, v, a, (N, nq) and (N, nv), of so many states that a regressor of so many columns shows its rank.

    With L the mean distance between joints and g that of gravity, lengths are drawn up to L, rates up to sqrt(g / L) of
    angles and sqrt(g L) of lengths, so that all terms of tau are of about one size in a robot of any size.
    """
    rng = np.random.default_rng(0)
    states = Y_OVER * columns // max(model.nv, 1) + 1
    turns, L = np.array(model.rotations, dtype=bool), _length(model)
    unit = np.where(turns, 1.0, L)
    largest = (unit * np.where(turns, math.pi, 1.0), unit * math.sqrt(GRAVITY / L), unit * (GRAVITY / L))
    q, v, a = (rng.uniform(-1.0, 1.0, (states, model.nv)) * size for size in largest)
    return model.coordinates_at(q), v, a


def as_forces(model: Model, Y: Array) -> Array:
    """Rows of a regressor in one unit: those of moments divided by a length, so that they compare with forces."""
    return Y / np.where(np.array(model.rotations, dtype=bool), _length(model), 1.0)[:, None]


def _length(model: Model) -> float:
    """The mean distance between joints that are apart [m]."""
    lengths = [length for joint in model.joints if (length := float(np.linalg.norm(joint.p)))]
    return sum(lengths) / len(lengths) if lengths else 1.0
