"""Which inertial parameters motion can tell: a basis of the regressor's columns, and the map to it from all parameters.

A parameter does not enter tau alone where links cannot move alone: tau = Y pi = Y_b pi_b, where Y_b are columns of Y
that are linearly independent for all motions, and pi_b = B pi are sums of parameters.

Source: Gautier, Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", IEEE Transactions
on Robotics and Automation 6(3), 1990; by numbers, Gautier, "Numerical calculation of the base inertial parameters of
robots", Journal of Robotic Systems 8(4), 1991.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import not_negative, relative_tolerance
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inputs import finite, real
from rttrr_pin.core.joint import EFFECTS
from rttrr_pin.core.model import Model
from rttrr_pin.errors import NumberError, ShapeError

INERTIAL = ("m", "m c_x", "m c_y", "m c_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz")
"""The ten parameters of a link, the tensor about the origin of {i}, in the order of the regressor."""

KINDS = {"m": "mass"} | dict.fromkeys(INERTIAL[1:4], "first moment") | dict.fromkeys(INERTIAL[4:], "tensor")
"""Parameters whose columns can be compared: what of one rounds can be as large as another is. Those of a joint's
effects hardly round: each is a kind of its own."""


SHOWN, PART = 6, 0.1
"""Of parameters that belong together so many are named at most, each of this part of the largest at least."""

DOUBT = 100.0
"""A column is told whose distance is within this factor of the tolerance."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BaseParameters:
    """A basis of the parameters that motion can tell, made by `Robot.base_parameters`.

    Attributes:
        names: of all parameters, the columns of the regressor.
        independent: the columns that make the basis.
        map: B with pi_b = B pi, (rank, parameters); of the basis' own columns the identity, and zero for parameters
            that no motion tells.
        tolerance: a column depends on those before it if it is no farther from their span, relative to the largest
            column of its kind (masses, first moments, tensors; a joint's effect is compared with its own column).
        distances: that of each column, (parameters,).
    """

    names: tuple[str, ...]
    independent: tuple[int, ...]
    map: Array
    tolerance: float
    distances: Array

    def __repr__(self) -> str:
        return f"<BaseParameters: {self.rank} of {len(self.names)}>"

    @property
    def rank(self) -> int:
        """The number of base parameters."""
        return len(self.independent)

    @property
    def farthest_dependent(self) -> float:
        """The largest distance of a column that was found to depend on those before it."""
        return float(np.delete(self.distances, self.independent).max(initial=0.0))

    @property
    def nearest_independent(self) -> float:
        """The smallest of one that was not; the rank is certain where both are far apart."""
        return float(self.distances[list(self.independent)].min(initial=math.inf))

    @property
    def expressions(self) -> tuple[str, ...]:
        """Each base parameter as the sum of parameters that it is."""
        return tuple(self._expression(column, row) for column, row in zip(self.independent, self.map, strict=True))

    def of(self, parameters: ArrayLike) -> Array:
        """The base parameters, (rank,), of `Robot.inertial_parameters()`."""
        pi = finite("parameters", real("parameters", parameters))
        self._check("parameters", pi)
        return np.asarray(pi @ self.map.T)

    def regressor(self, Y: ArrayLike) -> Array:
        """The columns of `Robot.regressor` that base parameters multiply, (..., nv, rank)."""
        columns = finite("Y", real("Y", Y))
        self._check("Y", columns)
        return columns[..., list(self.independent)]

    def condition(self, Y: ArrayLike, scaled: bool = False) -> float:
        """How well a trajectory tells the base parameters: the condition number of its stacked regressor.

            cond(W) = sigma_max(W) / sigma_min(W),   W the rows of `regressor(Y)` of all states

        A relative error of tau is at most multiplied by it in pi_b. Infinite where a parameter does not show.

        Args:
            Y: `Robot.regressor(q, v, a)` along the trajectory, (..., nv, parameters).
            scaled: whether each column is divided by its norm, so that the units of parameters do not count.
        """
        if not self.rank:
            return 1.0
        W = self.regressor(Y).reshape(-1, self.rank)
        norms = np.linalg.norm(W, axis=0)
        if len(W) < self.rank or not norms.all():
            return math.inf
        sigma = np.linalg.svd(W / norms if scaled else W, compute_uv=False)
        return float(sigma[0] / sigma[-1]) if sigma[-1] > 0.0 else math.inf

    def advice(self, Y: ArrayLike, most: float = 1000.0) -> tuple[str, ...]:
        """Which base parameters a trajectory hardly tells, and what to do about each; empty where it tells all.

        Those that belong together are the large components of a singular vector of the stacked regressor, its columns
        divided by their norms (Belsley, Kuh and Welsch, "Regression diagnostics", 1980).

        Args:
            Y: `Robot.regressor(q, v, a)` along the trajectory, (..., nv, parameters).
            most: singular values of less than the largest divided by it are told.

        Raises:
            NumberError: `most` is no number from 1 on.
        """
        if not_negative("most", most) < 1.0:
            raise NumberError(f"most is {most}: expected a number from 1 on", name="most", value=most)
        W = self.regressor(Y).reshape(-1, self.rank)
        norms = np.linalg.norm(W, axis=0)
        shown, names = np.flatnonzero(norms), [self.names[k] for k in self.independent]
        advice = [
            f"{names[k]} does not show: {_remedy([names[k]])}, or leave it out" for k in np.flatnonzero(norms == 0)
        ]
        if len(W) < self.rank:
            return (*advice, f"{len(W)} equations for {self.rank} parameters: add states")
        _, sigma, directions = np.linalg.svd(W[:, shown] / norms[shown], full_matrices=False)
        for own, direction in zip(sigma[::-1], np.abs(directions[::-1]), strict=True):
            if own * most >= sigma[0]:
                break
            largest = [k for k in np.argsort(-direction)[:SHOWN] if direction[k] >= PART * direction.max()]
            together = [names[shown[k]] for k in largest]
            times = f"{sigma[0] / own:.2g} times" if own else "without limit"
            advice.append(
                f"{_listed(together)} are nearly dependent, and errors of tau multiplied {times} in what tells them "
                f"apart: {_remedy(together)}, or keep {together[0]} at a value that is known"
            )
        return tuple(advice)

    def summary(self) -> str:
        """The base parameters as text, one a line."""
        count = f"{self.rank} base parameters of {len(self.names)}"
        distances = f"dependent to {self.farthest_dependent:.2g}, independent from {self.nearest_independent:.2g}"
        first = f"{count}; columns {distances} (tolerance {self.tolerance:.2g})"
        return "\n".join([first, *self._doubts(), *self.expressions])

    def _doubts(self) -> list[str]:
        """The columns so near the tolerance that another one would decide otherwise."""
        near = (self.distances > self.tolerance / DOUBT) & (self.distances < self.tolerance * DOUBT)
        return [
            f"{self.names[k]} is {'nearly ' if k in self.independent else ''}dependent on those before it (to "
            f"{self.distances[k]:.2g}): nearly no motion tells it; pass a tolerance "
            f"{'above that to leave it out' if k in self.independent else 'below that to keep it'}"
            for k in np.flatnonzero(near).tolist()
        ]

    def to_dict(self) -> dict[str, Any]:
        """The same as lists, for JSON."""
        return {
            "schema": 1,
            "names": list(self.names),
            "independent": list(self.independent),
            "map": self.map.tolist(),
            "tolerance": self.tolerance,
            "farthest_dependent": self.farthest_dependent,
            "nearest_independent": self.nearest_independent if self.rank else None,
        }

    def _expression(self, own: int, row: Array) -> str:
        others = (k for k in np.flatnonzero(row) if k != own)
        terms = (f" {'-' if row[k] < 0.0 else '+'} {_factor(abs(row[k]))}{self.names[k]}" for k in others)
        return self.names[own] + "".join(terms)

    def _check(self, name: str, array: Array) -> None:
        if array.ndim == 0 or array.shape[-1] != len(self.names):
            raise ShapeError(
                f"{name} has shape {array.shape}, expected {len(self.names)} on its last axis, one for each parameter: "
                "pass joint_effects as it was passed to base_parameters",
                name=name,
                got=array.shape,
                wanted=f"(..., {len(self.names)})",
            )


def parameter_names(model: Model, joint_effects: bool) -> tuple[str, ...]:
    """The columns of the regressor: of each link, then, where they are asked for, of each joint that moves."""
    joints = [joint.name for joint in model.joints if joint.nv and joint_effects]
    links = (f"{parameter} of {link}" for link in model.link_names for parameter in INERTIAL)
    return (*links, *(f"{effect} of {joint}" for joint in joints for effect in EFFECTS))


def base_parameters(names: Sequence[str], Y: Array, tolerance: float) -> BaseParameters:
    """The basis, by orthogonalising column after column (QR without pivoting).

    So what a joint keeps to itself is added to the parameters of the links further in, as Gautier and Khalil do.

    Args:
        names: of the columns.
        Y: the regressor at random states, (N, nv, columns), its rows in one unit.
        tolerance: see `BaseParameters`.
    """
    tolerance = relative_tolerance(tolerance)
    W = Y.reshape(math.prod(Y.shape[:-1]), len(names))
    norms = np.linalg.norm(W, axis=0)
    scale = _of_kind(names, norms)
    Q, kept = np.zeros_like(W), list[int]()
    distances = np.zeros(len(names))
    for k, column in enumerate(W.T):
        basis = Q[:, : len(kept)]
        rest = column - basis @ (basis.T @ column)
        rest -= basis @ (basis.T @ rest)  # once is not enough where little is left (Giraud, Langou, Rozloznik)
        distances[k] = np.linalg.norm(rest) / scale[k]
        if distances[k] > tolerance:
            Q[:, len(kept)] = rest / np.linalg.norm(rest)
            kept.append(k)
    projected = Q[:, : len(kept)].T @ W
    B = np.linalg.solve(projected[:, kept], projected)
    B[np.abs(B) * norms[kept, None] <= tolerance * scale] = 0.0
    B[:, kept] = np.eye(len(kept))
    return BaseParameters(
        names=tuple(names),
        independent=tuple(kept),
        map=np.asarray(B, dtype=np.float64),
        tolerance=tolerance,
        distances=distances,
    )


def _of_kind(names: Sequence[str], norms: Array) -> Array:
    """For each column the norm of the largest of its kind; 1 where all are zero."""
    parameters = [name.partition(" of ")[0] for name in names]
    kinds = [KINDS.get(parameter, name) for name, parameter in zip(names, parameters, strict=True)]
    largest: dict[str, float] = {}
    for kind, norm in zip(kinds, norms.tolist(), strict=True):
        largest[kind] = max(norm, largest.get(kind, 0.0))
    return np.array([largest[kind] or 1.0 for kind in kinds])


def _remedy(names: Sequence[str]) -> str:
    """What motion would tell parameters."""
    places: dict[str, list[str]] = {"links": [], "joints": []}
    for name in names:
        parameter, _, place = name.partition(" of ")
        of = places["joints" if parameter in EFFECTS else "links"]
        if place not in of:
            of.append(place)
    moved = [f"turn {_listed(places['links'])} more, also faster and about other axes"] if places["links"] else []
    moved += [f"let {_listed(places['joints'])} run at more rates and accelerations"] if places["joints"] else []
    return " and ".join(moved)


def _listed(names: Sequence[str]) -> str:
    """Names as a sentence has them."""
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def _factor(x: float) -> str:
    text = f"{x:.6g}"
    return "" if text == "1" else f"{text} "
