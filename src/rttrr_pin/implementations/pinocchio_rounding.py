"""What rounds in Pinocchio's formulas, and does not occur in the recursion's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.scalars import EPS
from rttrr_pin.implementations.allowance import add_inwards
from rttrr_pin.implementations.library import Scales, norms
from rttrr_pin.implementations.pinocchio_links import PinLinks

OPERATIONS = 4
"""Roundings on the way of each term over one joint: a vector product, a sum, a change of frame."""


def rounding(
    pin_model: Any, links: PinLinks, apart: Mapping[int, Scales], spatial: Array, reach: Array
) -> dict[str, Array]:
    """What rounds in Pinocchio's formulas and not in the recursion's: sizes times `OPERATIONS` eps, (N, links) each.

    - Spatial accelerations and momenta about the joint's origin O contain terms that cancel in the result: w x v_O in
      `a_gf`, v_O x m v_O and m |c|^2 (|w_dot| + |w|^2) in the moment.
    - Rotations about an axis that is not x, y or z itself, -z for one, come from 1 - cos q, so that even what lies
      along the axis is rounded when it is carried over the joint. The recursion carries it over exactly, and its bound
      knows.
    - Inertias of links fixed together were merged when the model was built, and are `apart` from the file's.

    Sizes add up like the terms: outwards for velocities and accelerations, inwards for forces and moments. `reach` is
    at most how far a joint's origin is from that of the joint further in, (N, njoints) [m].
    """
    v, w = (norm(x) for x in np.split(spatial[:, 1], 2, axis=-1))
    v_dot, w_dot = (norm(x) for x in np.split(spatial[:, 2], 2, axis=-1))
    parents = [int(parent) for parent in pin_model.parents]
    turning = w_dot + w**2
    acceleration = v_dot + w * v
    for joint in range(1, len(parents)):
        turning[:, joint] += turning[:, parents[joint]]
        acceleration[:, joint] += acceleration[:, parents[joint]] + reach[:, joint] * turning[:, parents[joint]]

    inertias = pin_model.inertias
    mass = norms(inertia.mass for inertia in inertias)  # a size, also where a file has it negative
    c, tensor = norms(inertia.lever for inertia in inertias), norms(inertia.inertia for inertia in inertias)
    off_mass, off_c, off_tensor = np.zeros((3, len(inertias)))  # in the unit of all these sizes
    for joint, errors in apart.items():
        off_mass[joint], off_c[joint], off_tensor[joint] = (error / (OPERATIONS * EPS) for error in errors)
    mass, tensor = mass + off_mass, tensor + off_tensor
    force = mass * (acceleration + (c + off_c) * turning)
    moment = mass * (v**2 + (c + off_c) * acceleration + c * (c + 2 * off_c) * turning) + tensor * turning
    add_inwards([-1, *parents[1:]], force, moment, reach)

    at, arm = links.joint, links.arm
    out = {
        "F": np.abs(links.mass) * (acceleration[:, at] + (arm + norm(links.com)) * turning[:, at]),
        "N": norms(links.inertia) * turning[:, at],
        "f": force[:, at],
        "n": moment[:, at] + arm * force[:, at],
    }
    return {key: OPERATIONS * EPS * size for key, size in out.items()}
