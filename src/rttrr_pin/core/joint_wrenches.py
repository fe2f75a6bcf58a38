"""Wrenches of joints as another program says them."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.core.conventions import Convention
from rttrr_pin.core.model import Model
from rttrr_pin.core.placements import in_base
from rttrr_pin.errors import UnknownNameError

LEAST_MASS = 1e-15
"""Of a tree that MuJoCo gives a centre of mass [kg]; one with less has it where its first body has its own."""


@dataclass(frozen=True, slots=True, eq=False)
class JointWrenches:
    """What a program calls the wrenches of the joints, made by `LinkWrenches.in_convention`.

    Attributes:
        convention: axes, point, sign and order, in words.
        force: (..., links, 3) [N].
        moment: (..., links, 3) [N m].
        links: the names along the links axis; each wrench crosses the joint that carries the link.
    """

    convention: Convention
    force: Array
    moment: Array
    links: tuple[str, ...]

    @property
    def vector(self) -> Array:
        """The six numbers of each joint in the order of the program, (..., links, 6) [N, N m]."""
        parts = (self.force, self.moment) if self.convention.first == "force" else (self.moment, self.force)
        return np.concatenate(parts, axis=-1)

    def at(self, link: str) -> Array:
        """The six numbers of the joint that carries a link, (..., 6).

        Raises:
            UnknownNameError: no link is called so.
        """
        if not isinstance(link, str) or link not in self.links:
            raise UnknownNameError("link", link, self.links)
        return self.vector[..., self.links.index(link), :]

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        words = {key: getattr(self.convention, key) for key in ("name", "axes", "point", "acts_on", "first")}
        return {"schema": 1, "convention": words, "links": self.links, "wrenches": self.vector.tolist()}


def joint_wrenches(row: Convention, model: Model, q: Array, f: Array, n: Array) -> JointWrenches:
    """The wrenches f, n of {i}, (..., links, 3), as a program says them; q is (..., nq), with the same leading axes."""
    batch = f.shape[:-2]
    R, r = _frames(row, model, q.reshape(prod(batch), model.nq))
    R, r = R.reshape(*batch, *R.shape[1:]), r.reshape(*batch, *r.shape[1:])
    return JointWrenches(row, *row.of_link(f, n, R, r), model.link_names)


def _frames(row: Convention, model: Model, q: Array) -> tuple[Array, Array]:
    """R and r of `Convention.of_link` for each link, (N, links, 3, 3) and (N, links, 3)."""
    none = np.zeros((len(q), len(model.links), 3))
    own = np.broadcast_to(np.eye(3), (*none.shape, 3))
    if (row.axes, row.point) == ("link", "origin"):
        return own, none
    R, p = in_base(model, q)
    points = {"origin": p, "com": p + product(R, _coms(model)), "tree": tree_centres(model, R, p)}
    r = points[row.point] - p
    return (R, r) if row.axes == "base" else (own, product(np.swapaxes(R, -1, -2), r))


def tree_centres(model: Model, R: Array, p: Array) -> Array:
    """For each link the centre of mass of its tree of bodies, in base axes, (N, links, 3) [m].

    A tree is what hangs on one body of the world. MuJoCo merges the fixed links of a file into what carries them, so
    there it is a link that moves against the base, with all behind it; what is fixed to the base is merged into the
    world, and of no such tree. In the robot of an `MjModel` that is done: a tree is whatever hangs on one link at the
    base.

    Args:
        model: the robot.
        R: R_0_i, (N, links, 3, 3).
        p: p_0_i, (N, links, 3).
    """
    merged = getattr(model.document, "made_from", "") != "mujoco.MjModel"
    mass = np.array([link.mass for link in model.links])
    at = p + product(R, _coms(model))
    first = np.array([_first(model, i, merged) for i in range(len(model.links))], dtype=int)
    centres = at[:, first]
    for root in set(first.tolist()):
        members = np.array([root in model.path(k) for k in range(len(model.links))])
        if (total := mass[members].sum()) >= LEAST_MASS:
            centre = (mass[members, None] * at[:, members]).sum(axis=1) / total
            centres[:, first == root] = centre[:, None]
    return centres


def _first(model: Model, i: int, merged: bool) -> int:
    """The link that the tree of link i hangs on the world by."""
    path = list(model.path(i))
    moving = [k for k in path if model.joints[k].nv]
    return moving[-1] if merged and moving else path[-1]


def _coms(model: Model) -> Array:
    """The centre of mass of each link in its own frame, (links, 3) [m]."""
    return np.array([link.com for link in model.links]).reshape(-1, 3)
