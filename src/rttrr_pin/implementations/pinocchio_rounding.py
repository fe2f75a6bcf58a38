"""What rounds in Pinocchio's formulas, and does not occur in the recursion's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import EPS
from rttrr_pin.implementations.allowance import add_inwards
from rttrr_pin.implementations.library import Scales, norms
from rttrr_pin.implementations.pinocchio_links import PinLinks

OPERATIONS = 4
"""Roundings on the way of each term over one joint: a vector product, a sum, a change of frame."""


class LoadSizes(NamedTuple):
    """How large a payload is, and where it comes from.

    Attributes:
        link: index of the link.
        f, n: force [N] and moment about the link's origin [N m], (N,) each.
        turned: over how many oblique joints it was turned from base axes into the link's.
    """

    link: int
    f: Array
    n: Array
    turned: int


def oblique(pin_model: Any) -> list[bool]:
    """Whether a joint turns about an axis that is none of x, y, z: -z is one."""
    kinds = [joint.shortname() for joint in pin_model.joints]
    return ["Revolute" in kind and "Unaligned" in kind for kind in kinds]


def turns(pin_model: Any) -> list[int]:
    """How many oblique joints there are from each one inward, itself included."""
    counts: list[int] = []
    for own, parent in zip(oblique(pin_model), pin_model.parents, strict=True):
        counts.append(own + (counts[parent] if counts else 0))
    return counts


def load_sizes(pin_model: Any, links: PinLinks, loads: Sequence[Load], rows: int) -> list[LoadSizes]:
    """The sizes of payloads in so many states; one in base axes was turned over each joint that moves its link."""
    counts, sizes = turns(pin_model), []
    for load in loads:
        f, n = (np.broadcast_to(norm(np.atleast_2d(x)), rows) for x in (load.f, load.n))
        sizes.append(LoadSizes(load.link, f, n, counts[links.joint[load.link]] if load.in_base else 0))
    return sizes


def carrying(links: PinLinks, force: Array, moment: Array, loads: Sequence[LoadSizes]) -> dict[str, Array]:
    """What rounds of f and n across fixed joints on the way to the body's origin and back, (N, links) each.

    In axes that are not quite orthogonal, a vector does not come back as it was: as far as they are apart here, and
    what our own product rounds. `force` and `moment` are the sizes of what crosses each fixed joint, (N, links).
    """
    way = OPERATIONS * EPS
    there_and_back = 2 * way + (links.stretch + way)
    out = {"f": there_and_back * force, "n": there_and_back * (moment + links.arm * force)}
    for load in loads:
        if links.fixed[load.link]:
            for key, size in (("f", load.f), ("n", load.n)):
                out[key][:, load.link] += way * load.turned * size
    return out


def rounding(
    pin_model: Any,
    links: PinLinks,
    apart: Mapping[int, Scales],
    spatial: Array,
    reach: Array,
    loads: Sequence[LoadSizes],
) -> dict[str, Array]:
    """What rounds in Pinocchio's formulas and not in the recursion's: sizes times `OPERATIONS` eps, (N, links) each.

    - Spatial accelerations and momenta about the joint's origin O contain terms that cancel in the result: w x v_O in
      `a_gf`, v_O x m v_O and m |c|^2 (|w_dot| + |w|^2) in the moment.
    - Rotations about an axis that is not x, y or z itself, -z for one, come from 1 - cos q, so that even what lies
      along the axis is rounded when it is carried over the joint, and over each further one once more. The recursion
      carries it over exactly, and its bound knows.
    - Inertias of links fixed together were merged when the model was built, and are `apart` from the file's. Payloads
      go to the body's origin, in the joint's axes, where they may cancel.

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
    again_force, again_moment = np.zeros((2, *force.shape))  # sizes of what rounds more than once
    for load in loads:
        joint, load_moment = int(links.joint[load.link]), load.n + links.arm[load.link] * load.f
        force[:, joint] += load.f
        moment[:, joint] += load_moment
        again_force[:, joint] += load.turned * load.f
        again_moment[:, joint] += load.turned * load_moment
    inward = [-1, *parents[1:]]
    add_inwards(inward, force, moment, reach)
    for joint, is_oblique in enumerate(oblique(pin_model)):
        if is_oblique:
            again_force[:, parents[joint]] += force[:, joint]
            again_moment[:, parents[joint]] += moment[:, joint] + reach[:, joint] * force[:, joint]
    add_inwards(inward, again_force, again_moment, reach)
    force, moment = force + again_force, moment + again_moment

    at, arm = links.joint, links.arm
    out = {
        "F": np.abs(links.mass) * (acceleration[:, at] + (arm + norm(links.com)) * turning[:, at]),
        "N": norms(links.inertia) * turning[:, at],
        "f": force[:, at],
        "n": moment[:, at] + arm * force[:, at],
    }
    return {key: OPERATIONS * EPS * size for key, size in out.items()}
