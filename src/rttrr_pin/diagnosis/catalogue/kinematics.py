"""Where links are in a batch, for hypotheses on frames and points."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from rttrr_pin.core import placements
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.implementations.protocol import Batch


@lru_cache(maxsize=4)  # all hypotheses about a batch look at the same frames
def on_parents(model: Model, batch: Batch) -> tuple[Array, Array]:
    """R_parent_i (N, links, 3, 3) and p_parent_i (N, links, 3) of each link on its parent."""
    return placements.on_parents(model, batch.q)


@lru_cache(maxsize=4)
def in_base(model: Model, batch: Batch) -> tuple[Array, Array]:
    """R_0_i (N, links, 3, 3) and p_0_i (N, links, 3) of each link in the base frame."""
    return placements.in_base(model, batch.q)


def turned(R: Array, vectors: Array) -> Array:
    """R times each vector, (..., 3, 3) and (..., 3)."""
    return np.asarray((R @ vectors[..., None])[..., 0])


def turned_back(R: Array, vectors: Array) -> Array:
    """R^T times each vector."""
    return turned(np.swapaxes(R, -1, -2), vectors)
