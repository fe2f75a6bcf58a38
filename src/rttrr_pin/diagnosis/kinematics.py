"""Where links are in a batch, for hypotheses on frames and points."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import bodies, joint_states
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.implementations.protocol import Batch


@lru_cache(maxsize=4)  # all hypotheses about a batch look at the same frames
def on_parents(model: Model, batch: Batch) -> tuple[Array, Array]:
    """R_parent_i (N, links, 3, 3) and p_parent_i (N, links, 3) of each link on its parent."""
    states = joint_states(model, FLOAT, *(columns(x) for x in (batch.q, batch.v, batch.a)))
    R, p = np.empty((len(batch), len(model.links), 3, 3)), np.empty((len(batch), len(model.links), 3))
    for i, (body, state) in enumerate(zip(bodies(model, FLOAT), states, strict=True)):
        motion = body.type.motion(body, state, FLOAT.sincos)
        entries: list[Any] = [x for row in motion.R.rows for x in row]
        components: list[Any] = [*motion.p]
        for k, x in enumerate(entries):
            R[:, i, k // 3, k % 3] = x
        for k, x in enumerate(components):
            p[:, i, k] = x
    return R, p


@lru_cache(maxsize=4)
def in_base(model: Model, batch: Batch) -> tuple[Array, Array]:
    """R_0_i (N, links, 3, 3) and p_0_i (N, links, 3) of each link in the base frame."""
    R, p = (x.copy() for x in on_parents(model, batch))
    for i, joint in enumerate(model.joints):
        if joint.parent >= 0:
            p[:, i] = p[:, joint.parent] + turned(R[:, joint.parent], p[:, i])
            R[:, i] = R[:, joint.parent] @ R[:, i]
    return R, p


def turned(R: Array, vectors: Array) -> Array:
    """R times each vector, (..., 3, 3) and (..., 3)."""
    return np.asarray((R @ vectors[..., None])[..., 0])


def turned_back(R: Array, vectors: Array) -> Array:
    """R^T times each vector."""
    return turned(np.swapaxes(R, -1, -2), vectors)
