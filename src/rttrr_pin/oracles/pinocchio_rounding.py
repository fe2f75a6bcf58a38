"""What Pinocchio's formulas round beyond ours.

A difference between two correct programs must be held against the rounding of both. Ours is bounded operation by
operation; of Pinocchio's we know the formulas: spatial accelerations and momenta about the joint's origin O. They
contain terms that ours never forms, and that cancel in the result:

- w x v_O in `a_gf`, which adds up outwards;
- v_O x m v_O and m |c|^2 (|w_dot| + |w|^2) in the moment about O, and c x the force, which add up inwards.

What is left of them is their rounding: their size times eps, times the few operations that each goes through.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.oracles.pinocchio_model import PinLink

Array = NDArray[np.float64]

EPS = float(np.finfo(float).eps)

OPERATIONS = 8
"""Roundings on the way of each term: a vector product, a sum, a change of frame."""


def rounding(pin_model: Any, links: Sequence[PinLink], spatial: Array, reach: Array) -> dict[str, Array]:
    """The size of terms that cancel, times `OPERATIONS` eps, by quantity: (N, links) each.

    Args:
        pin_model: Pinocchio's model.
        links: the links as Pinocchio has them.
        spatial: data.f, data.v, data.a_gf of each joint, linear before angular, (N, 3, njoints, 6).
        reach: at most how far a joint's origin is from that of the joint further in, (N, njoints) [m].
    """
    v, w = (np.linalg.norm(x, axis=-1) for x in np.split(spatial[:, 1], 2, axis=-1))
    w_dot = np.linalg.norm(spatial[:, 2, :, 3:], axis=-1)
    parents = [int(parent) for parent in pin_model.parents]
    acceleration = w * v
    for joint in range(1, len(parents)):
        acceleration[:, joint] += acceleration[:, parents[joint]]

    mass = np.array([inertia.mass for inertia in pin_model.inertias])
    c = np.array([np.linalg.norm(inertia.lever) for inertia in pin_model.inertias])
    force = mass * acceleration
    moment = mass * (v**2 + c * acceleration + c**2 * (w_dot + w**2))
    for joint in reversed(range(1, len(parents))):
        force[:, parents[joint]] += force[:, joint]
        moment[:, parents[joint]] += moment[:, joint] + reach[:, joint] * force[:, joint]

    at = [link.joint for link in links]
    arm = np.array([np.linalg.norm(link.p) for link in links])
    own_mass = np.array([link.mass for link in links])
    out = {
        "F": own_mass * acceleration[:, at],
        "N": np.zeros((len(v), len(links))),
        "f": force[:, at],
        "n": moment[:, at] + arm * force[:, at],
    }
    return {key: OPERATIONS * EPS * size for key, size in out.items()}
