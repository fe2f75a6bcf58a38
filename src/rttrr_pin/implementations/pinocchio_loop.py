"""Pinocchio state by state: the wrenches that `rnea` leaves in its data.

| quantity | from |
|---|---|
| tau | the return value of `rnea` |
| f, n of a moving joint | `data.f` |
| F, N | `data.a_gf`, `data.v` and the inertia, taken to the centre of mass |
| f, n of a fixed joint | the F, N of all links that it holds, and the `data.f` of the moving joints on them |

For robots whose `WrenchModels` would take too much memory, and to show that these say the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.implementations.allowance import sum_inwards
from rttrr_pin.implementations.library import Motion
from rttrr_pin.implementations.pinocchio_links import PinLinks, carriers
from rttrr_pin.implementations.pinocchio_parallel import Wrenches


class StateByState:
    """Calls `rnea` on each state and keeps what it leaves in `data`, whose entries the next call overwrites."""

    def __init__(self, model: Model, pin_model: Any, links: PinLinks) -> None:
        self._pin_model, self._data, self._links = pin_model, pin_model.createData(), links
        self._carrier = carriers(model, links)
        self._hanging = [i for i, p in enumerate(self._carrier) if p >= 0 and not links.fixed[i]]

    def wrenches(self, motion: Motion, loads: Sequence[Load]) -> Wrenches:
        """As `WrenchModels.wrenches`; the payload enters through `fext`, what the surroundings exert on the robot."""
        model, data, rows = self._pin_model, self._data, len(motion.q)
        views = [x.vector for name in ("f", "v", "a_gf") for x in getattr(data, name)]
        placements = [data.liMi[int(self._links.joint[i])] for i in self._hanging]
        parts = [x for M in placements for x in (*M.rotation.T, M.translation)]  # rows of R^T, then p: views too
        kept, hanging = np.empty((rows, 18 * model.njoints)), np.empty((rows, 12 * len(placements)))
        tau = np.empty((rows, model.nv))
        external = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
        forces: dict[int, Array] = {}  # minus the sum of the loads, by joint
        for load in loads:
            link = self._links.at(load.link)
            joint = int(link.joint)
            forces[joint] = forces.get(joint, np.zeros((rows, 6))) - link.to_joint(load.f, load.n)
        targets = [(external[joint].vector, values) for joint, values in forces.items()]
        for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
            for target, values in targets:
                target[:] = values[k]
            tau[k] = pin.rnea(model, data, q, v, a, external)
            np.concatenate(views, out=kept[k])
            if parts:
                np.concatenate(parts, out=hanging[k])
        spatial = kept.reshape(rows, 3, model.njoints, 6)
        net = self._net(spatial)
        crossing = self._behind(spatial, hanging.reshape(rows, len(placements), 4, 3), net, loads)
        moving = ~self._links.fixed
        crossing[:, moving] = spatial[:, 0, self._links.joint[moving]]
        crossing, net = (np.moveaxis(x, 0, -1) for x in (crossing, net))
        return Wrenches(tau.T, crossing, *np.split(net, 2, axis=1))

    def _net(self, spatial: Array) -> Array:
        """F, N: mass times acceleration of the centre of mass, and Euler's equation about it; (N, links, 6)."""
        links = self._links
        v, w = np.split(spatial[:, 1, links.joint], 2, axis=-1)
        v_dot, w_dot = np.split(spatial[:, 2, links.joint], 2, axis=-1)
        c, R_T, I = links.p + product(links.R, links.com), np.swapaxes(links.R, -1, -2), links.inertia
        # a_gf is a spatial acceleration: w x v makes it that of the point at the origin.
        at_com = v_dot + np.cross(w, v) + np.cross(w_dot, c) + np.cross(w, np.cross(w, c))
        F = product(R_T, links.mass[:, None] * at_com)
        w, w_dot = product(R_T, w), product(R_T, w_dot)
        return np.concatenate([F, product(I, w_dot) + np.cross(w, product(I, w))], axis=-1)

    def _behind(self, spatial: Array, hanging: Array, net: Array, loads: Sequence[Load]) -> Array:
        """What crosses each fixed joint but the load at its own link; zero for joints that move; (N, links, 6).

        Pinocchio keeps no force across a fixed joint: it is what moves the links behind it and all that they carry.
        These forces go to the body's origin, and add up there.
        """
        fixed, own = self._links.fixed, self._links.at(self._links.fixed)
        behind = np.zeros(net.shape)
        F, N = np.split(net[:, fixed], 2, axis=-1)
        behind[:, fixed] = own.to_joint(F, N + np.cross(own.com, F))
        for k, i in enumerate(self._hanging):
            R, p = np.swapaxes(hanging[:, k, :3], -1, -2), hanging[:, k, 3]
            force, moment = np.split(spatial[:, 0, self._links.joint[i]], 2, axis=-1)
            f, n = product(R, force), product(R, moment)
            behind[:, self._carrier[i]] += np.concatenate([f, n + np.cross(p, f)], axis=1)
        inward = [p if own else -1 for p, own in zip(self._carrier, fixed, strict=True)]
        for load in loads:
            if (carrier := inward[load.link]) >= 0:
                behind[:, carrier] += self._links.at(load.link).to_joint(load.f, load.n)
        sum_inwards(inward, behind)
        return behind
