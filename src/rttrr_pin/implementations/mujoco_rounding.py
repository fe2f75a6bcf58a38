"""What MuJoCo's formulas round beyond ours.

MuJoCo computes in world axes, about one point C for the whole robot, its centre of mass. Against the recursion in link
frames three things round that do not occur there:

- Orientations are quaternions, multiplied up from the root. Each level turns by a rounded rotation, and the length is
  mended only where it is off by more than 1e-15, that is 4.5 eps, which counts twice in the matrix. So vectors that go
  from link to world and back, and every part that a link adds, are off by some eps for each level above it.
- Positions are world coordinates, added up from the root. A lever is the difference of two.
- Velocities, accelerations and momenta are spatial, about C: of a link at a distance rho they contain w rho, w_dot rho,
  m rho^2 w_dot, v x m v, which cancel in the moment about the link's own origin.

Sizes add up like the terms: outwards for velocities and accelerations, inwards for forces and moments. Levers count
with all the lengths that they were added up from, and each link's part counts once for each level, and `FIXED` times
more for what does not grow with the level.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.scalars import EPS
from rttrr_pin.implementations.allowance import add_inwards, levels, norm

OPERATIONS = 4
"""Roundings in eps on the way of each term over one level: a quaternion product, its matrix, a sum."""

FIXED = 2
"""Levels that stand for what does not grow: lengths mended only beyond 1e-15, inertias turned, the way back."""


def rounding(
    compiled: Any, qvel: Array, qacc: Array, xpos: Array, C: Array, loads: dict[int, Array]
) -> dict[str, Array]:
    """The size of terms that cancel, times eps and the operations they go through, by quantity: (N, bodies) each.

    Args:
        compiled: MuJoCo's model.
        qvel: rates in MuJoCo's convention, (N, nv).
        qacc: accelerations in MuJoCo's convention, (N, nv).
        xpos: origins of the bodies in the world, (N, bodies, 3) [m].
        C: the point that MuJoCo's spatial vectors are about, (N, 3) [m].
        loads: by body, the size of force and moment that act on it, (N, 2).
    """
    parents = [-1, *compiled.body_parentid[1:]]
    w, v, w_dot, v_dot, rho = _outwards(compiled, qvel, qacc, xpos, C)
    mass = np.abs(compiled.body_mass)
    arm = rho + np.linalg.norm(compiled.body_ipos, axis=1)
    tensor = np.linalg.norm(compiled.body_inertia, axis=1)
    turning = w_dot + w**2
    force = mass * (v_dot + w * v + arm * turning)
    own_moment = tensor * turning
    moment = own_moment + mass * (v**2 + arm * (v_dot + 2 * w * v) + arm**2 * turning)

    weight = OPERATIONS * EPS * (levels(parents) - 1 + FIXED)
    out = {"F": weight * force, "N": weight * own_moment}
    f, n = weight * force, weight * moment
    for body, sizes in loads.items():
        f[:, body] += weight[body] * sizes[:, 0]
        n[:, body] += weight[body] * (sizes[:, 1] + arm[:, body] * sizes[:, 0])
    add_inwards(parents, f, n, np.zeros_like(rho))  # all moments are about C
    return out | {"f": f, "n": n + rho * f}


def _outwards(compiled: Any, qvel: Array, qacc: Array, xpos: Array, C: Array) -> Array:
    """Sizes of what moves, terms added up in absolute value: w, v, w_dot, v_dot and rho, (5, N, bodies).

    v and v_dot are those of the body's velocity field at C, and rho is the length of the way from C over the world's
    origin to the body's frame.
    """
    sizes = np.zeros((5, len(qvel), compiled.nbody))
    w, v, w_dot, v_dot, rho = sizes
    v_dot[:, 0] = np.linalg.norm(compiled.opt.gravity)
    rho[:, 0] = norm(C)
    rates, accelerations = (_by_body(compiled, x) for x in (qvel, qacc))
    for body in range(1, compiled.nbody):
        p = compiled.body_parentid[body]
        (slid, turned), (slid_a, turned_a) = rates[body], accelerations[body]
        rho[:, body] = rho[:, p] + norm(xpos[:, body] - xpos[:, p])
        w[:, body] = w[:, p] + turned
        v[:, body] = v[:, p] + slid + rho[:, body] * turned
        w_dot[:, body] = w_dot[:, p] + turned_a + w[:, body] * turned
        own = slid + rho[:, body] * turned
        v_dot[:, body] = v_dot[:, p] + slid_a + rho[:, body] * turned_a + w[:, body] * own + v[:, body] * turned
    return sizes


def _by_body(compiled: Any, x: Array) -> list[tuple[Array, Array]]:
    """The norms of what slides and of what turns, for each body, (N,) each."""
    slides = compiled.jnt_type[compiled.dof_jntid] == mujoco.mjtJoint.mjJNT_SLIDE
    of_bodies = [compiled.dof_bodyid == body for body in range(compiled.nbody)]
    return [(norm(x[:, of_body & slides]), norm(x[:, of_body & ~slides])) for of_body in of_bodies]
