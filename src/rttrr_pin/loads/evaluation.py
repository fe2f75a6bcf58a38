"""The loads of rows, by the compiled kernel, and how far errors of q, v and a move them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.conventions import Convention
from rttrr_pin.core.joint_wrenches import joint_wrenches
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.core.tangent import tangent
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.errors import NumberError
from rttrr_pin.loads.bearings import PARTS, Parts
from rttrr_pin.loads.parts import BAND
from rttrr_pin.loads.quantities import CROSSING, SAID
from rttrr_pin.robot import Robot
from rttrr_pin.trajectories import Block, Trajectory

Values = dict[str, Array]
"""By name of a quantity, (N, nv) or (N, links, 3)."""


class Evaluator:
    """Inverse dynamics of rows of a trajectory.

    Attributes:
        names: what it computes: tau, and what else was asked for.
    """

    def __init__(
        self,
        robot: Robot,
        names: Sequence[str],
        trajectory: Trajectory | None = None,
        convention: Convention | None = None,
    ) -> None:
        """What is to be computed.

        Args:
            robot: whose rows they are.
            names: of quantities, and of the parts of what bearings carry.
            trajectory: whose rows they are; None where no message names them.
            convention: of `SAID`.
        """
        self._model, self._convention, self._trajectory = robot.model, convention, trajectory
        self.names = tuple(dict.fromkeys(("tau", *names)))
        links = {*LINK_QUANTITIES} & {*self.names} | ({*CROSSING} if {*SAID, *PARTS} & {*self.names} else set())
        self._kernel: Kernel[Any] = robot.compile(("tau", *(name for name in LINK_QUANTITIES if name in links)))
        self._parts = Parts(robot.model) if {*PARTS} & {*self.names} else None

    def of(self, rows: Block) -> Values:
        """The quantities of rows, but for energy, which is no matter of one row.

        Raises:
            NumberError: a row has numbers that are not finite, or results that are too large; says which.
        """
        try:
            return self._at(rows.q, rows.v, rows.a, rows.payload)
        except NumberError as error:
            raise self._explained(error, rows) from error

    def half_widths(self, rows: Block) -> Values | None:
        """Half the width of the band of 95 percent of each quantity; None where all was measured.

        The error of (q, v, a) of each degree of freedom is L x with a normal vector x of three, independent of the
        others. To the first order what column k of L does is half the difference of the quantity at both ends of it:

            sigma^2 = sum over degrees of freedom and k of ((y(+L_k) - y(-L_k)) / 2)^2,   half width = 1.96 sigma
        """
        if rows.errors is None:
            return None
        total: Values | None = None
        directions = _tangent(self._model, rows.q)
        for j in range(self._model.nv):
            for k in range(3):
                column = rows.errors[:, j, :, k]
                if not column.any():
                    continue
                ahead, behind = (self._displaced(rows, directions[j], j, sign * column) for sign in (1.0, -1.0))
                total = _with_squares(total, ahead, behind)
        if total is None:
            return {name: np.zeros_like(x) for name, x in self.of(rows).items()}
        return {name: BAND * np.sqrt(x) for name, x in total.items()}

    def _displaced(self, rows: Block, direction: Direction, j: int, step: Array) -> Values:
        q = _moved(self._model, rows.q, direction, step[:, 0])
        v, a = rows.v.copy(order="K"), rows.a.copy(order="K")
        v[:, j] += step[:, 1]
        a[:, j] += step[:, 2]
        try:
            return self._at(q, v, a, rows.payload)
        except NumberError as error:
            raise self._explained(error, rows) from error

    def _at(self, q: Array, v: Array, a: Array, payload: tuple[Load, ...]) -> Values:
        values: Values = self._kernel(q, v, a, payload or None)
        if "power" in self.names:
            with np.errstate(over="ignore"):
                values["power"] = values["tau"] * v
        if self._convention is not None:
            said = joint_wrenches(self._convention, self._model, q, values["f"], values["n"])
            values |= {"force": said.force, "moment": said.moment}
        if self._parts is not None:
            values |= {name: x.T for name, x in self._parts(values["f"], values["n"]).items()}
        return {name: values[name] for name in self.names}

    def _explained(self, error: NumberError, rows: Block) -> NumberError:
        """The same error, with the row of the trajectory in place of the state of a block."""
        if not error.index:
            return error
        row = int(rows.rows[error.index[0]])
        where = "" if self._trajectory is None else f"{self._trajectory.name}, {self._trajectory.place} {row}: "
        message = str(error).replace(f" in state {error.index[0]}", "").replace(f"[{error.index[0]}, ", "[")
        return NumberError(f"{where}{message}", name=error.name, joint=error.joint, value=error.value)


def _with_squares(total: Values | None, ahead: Values, behind: Values) -> Values:
    with np.errstate(over="ignore", invalid="ignore"):
        squares = {name: ((ahead[name] - behind[name]) / 2) ** 2 for name in ahead}
        return squares if total is None else {name: total[name] + squares[name] for name in squares}


Direction = list[tuple[int, Any]]
"""Coordinates that move with a rate, and their derivatives by its integral, numbers or (N,)."""


def _tangent(model: Model, q: Array) -> list[Direction]:
    """How the coordinates move with each rate."""
    directions: list[Direction] = [[] for _ in range(model.nv)]
    for i, moved in enumerate(tangent(model.moving, columns(q), FLOAT)):
        for j, part in moved.parts.items():
            directions[j].append((i, part))
    return directions


def _moved(model: Model, q: Array, direction: Direction, step: Array) -> Array:
    """Coordinates a step along a rate; quaternions of length 1 again."""
    if not step.any():
        return q
    moved = q.copy(order="K")
    for i, part in direction:
        moved[:, i] += part * step
    for first in model.quaternions:
        own = moved[:, first : first + 4]
        own /= np.sqrt((own * own).sum(axis=1, keepdims=True))
    return moved
