"""Where links are in a batch, for hypotheses on frames and points."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import bodies, joint_states
from rttrr_pin.core.energy import LinkState, moving_links
from rttrr_pin.core.joints.base import JointMotion
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.implementations.protocol import Batch


@lru_cache(maxsize=4)  # all hypotheses about a batch look at the same frames
def on_parents(model: Model, batch: Batch) -> tuple[Array, Array]:
    """R_parent_i (N, links, 3, 3) and p_parent_i (N, links, 3) of each link on its parent."""
    states = joint_states(model, FLOAT, *(columns(x) for x in (batch.q, batch.v, batch.a)))
    links = zip(bodies(model, FLOAT), states, strict=True)
    return _arrays([body.type.motion(body, state, FLOAT.sincos) for body, state in links], len(batch))


@lru_cache(maxsize=4)
def in_base(model: Model, batch: Batch) -> tuple[Array, Array]:
    """R_0_i (N, links, 3, 3) and p_0_i (N, links, 3) of each link in the base frame."""
    q, v = columns(batch.q), columns(batch.v)
    return _arrays(moving_links(model, bodies(model, FLOAT), q, v, FLOAT), len(batch))


def _arrays(frames: Sequence[JointMotion | LinkState], states: int) -> tuple[Array, Array]:
    """R and p of frames as arrays."""
    rows = np.empty((states, len(frames), 4, 3))
    for i, frame in enumerate(frames):
        for k, vector in enumerate((*frame.R.rows, frame.p)):
            components: list[Any] = [*vector]
            for j, x in enumerate(components):
                rows[:, i, k, j] = x
    return rows[:, :, :3], rows[:, :, 3]


def turned(R: Array, vectors: Array) -> Array:
    """R times each vector, (..., 3, 3) and (..., 3)."""
    return np.asarray((R @ vectors[..., None])[..., 0])


def turned_back(R: Array, vectors: Array) -> Array:
    """R^T times each vector."""
    return turned(np.swapaxes(R, -1, -2), vectors)
