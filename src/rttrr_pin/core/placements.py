"""Where links are in a batch, for all that is said in other frames than their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import bodies, joint_states
from rttrr_pin.core.energy import LinkState, moving_links
from rttrr_pin.core.joints.base import JointMotion
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT, columns


def in_base(model: Model, q: Array) -> tuple[Array, Array]:
    """R_0_i (N, links, 3, 3) and p_0_i (N, links, 3) of each link in the base frame, for q (N, nq)."""
    return _arrays(moving_links(model, bodies(model, FLOAT), columns(q), _still(model, q), FLOAT), len(q))


def on_parents(model: Model, q: Array) -> tuple[Array, Array]:
    """R_parent_i (N, links, 3, 3) and p_parent_i (N, links, 3) of each link on its parent, for q (N, nq)."""
    still = _still(model, q)
    states = joint_states(model, FLOAT, columns(q), still, still)
    links = zip(bodies(model, FLOAT), states, strict=True)
    return _arrays([body.type.motion(body, state, FLOAT.sincos) for body, state in links], len(q))


def _still(model: Model, q: Array) -> list[float | Array]:
    """Rates of zero."""
    return columns(np.zeros((len(q), model.nv)))


def _arrays(frames: Sequence[JointMotion | LinkState], states: int) -> tuple[Array, Array]:
    """R and p of frames as arrays."""
    rows = np.empty((states, len(frames), 4, 3))
    for i, frame in enumerate(frames):
        for k, vector in enumerate((*frame.R.rows, frame.p)):
            components: list[Any] = [*vector]
            for j, x in enumerate(components):
                rows[:, i, k, j] = x
    return rows[:, :, :3], rows[:, :, 3]
