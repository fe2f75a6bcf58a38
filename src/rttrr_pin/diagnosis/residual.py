"""The residual of a log, and all that is linear in it: what joints take, what links weigh, gravity, factors of tau."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.log import Log
from rttrr_pin.diagnosis.variant import run
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.robot import Robot

PER_LINK = 10

OF_JOINT = ("armature", "viscous", "coulomb", "offset", "factor")
"""Columns of each degree of freedom, behind those of the links: a, v, sign(v), 1, tau of the model."""

ROWS = 1500
"""Means of consecutive rows that are fitted, at most: more only take time."""

AT_ONCE = 2000
"""Rows whose regressor is held at a time."""

NONE = 1e-6
"""Of the root mean square of tau: what a log without noise is taken to have, since its numbers have digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """What was measured less what the model says, and the columns that may explain it.

    Attributes:
        model: the robot.
        whole: at each row of the log, (N, nv) [N m or N].
        means: of consecutive rows, (M, nv).
        columns: of the same means, (M, nv, columns).
        weights: one over the standard deviation of a mean, (nv,).
        noise: standard deviation of a row, by noise of tau and errors of v and a, (nv,); NaN where it is not known.
        size: root mean square of tau, (nv,).
        within: variance of rows about the mean that they are in, (nv,).
    """

    model: Model
    whole: Array
    means: Array
    columns: Array
    weights: Array
    noise: Array
    size: Array
    within: Array

    @property
    def names(self) -> tuple[str, ...]:
        """The columns: `link 3 4` for the fifth parameter of the fourth link, `viscous 2`, `gravity 1`."""
        of_links = (f"link {i} {k}" for i in range(len(self.model.links)) for k in range(PER_LINK))
        of_joints = (f"{name} {j}" for name in OF_JOINT for j in range(self.model.nv))
        return (*of_links, *of_joints, *(f"gravity {k}" for k in range(3)))


def residuals_of(robot: Robot, log: Log) -> Residuals:
    """What a log has that the model has not.

    Rows are averaged, some at a time, over less than what splines can tell apart.
    """
    model, batch = robot.model, log.batch
    predicted = run(model, batch)["tau"]
    size = np.sqrt((log.tau**2).mean(axis=0))
    error = _of_differentiation(model, log, predicted)
    noise = np.sqrt(np.maximum(log.noise, NONE * size) ** 2 + error**2)
    count = _rows_of_a_mean(log)
    parts = [slice(a, a + count) for own in log.segments for a in range(own.start, own.stop - count + 1, count)]
    residual = log.tau - predicted
    means = np.stack([residual[own].mean(axis=0) for own in parts])
    within = np.mean([residual[own].var(axis=0) for own in parts], axis=0)
    columns = _columns(robot, batch, predicted, parts)
    of_mean = np.sqrt(np.maximum(log.noise, NONE * size) ** 2 / count + error**2)
    known = np.isfinite(of_mean)
    of_mean = np.where(known, of_mean, np.maximum(residual.std(axis=0), NONE * size))
    return Residuals(model, residual, means, columns, 1.0 / np.where(of_mean > 0, of_mean, 1.0), noise, size, within)


def _of_differentiation(model: Model, log: Log, predicted: Array) -> Array:
    """What errors of v and a do to tau, (nv,)."""
    if log.others is None:
        return np.zeros(model.nv)
    again = run(model, Batch(model, *log.others))["tau"]
    # Both have noise of their own, that of the first and that of both in the second: their difference is one of them.
    return np.asarray(np.sqrt(((again - predicted) ** 2).mean(axis=0)))


def _rows_of_a_mean(log: Log) -> int:
    """So many that there are not more means than can be told apart."""
    shortest = min(own.stop - own.start for own in log.segments)
    step = float(np.median(np.diff(log.time)))
    count = max(1, math.ceil(len(log) / ROWS), math.floor(log.bandwidth / 4 / step))
    return int(min(count, max(1, shortest // 4)))


def contribution(robot: Robot, log: Log, x: Array) -> Array:
    """What columns times these numbers make of tau at each row, (N, nv)."""
    batch, made = log.batch, []
    predicted = run(robot.model, batch)["tau"]
    fields = _fields(robot.model, batch)
    for first in range(0, len(log), AT_ONCE):
        made.append(_whole(robot, batch, predicted, fields, np.arange(first, min(first + AT_ONCE, len(log)))) @ x)
    return np.concatenate(made)


def _columns(robot: Robot, batch: Batch, predicted: Array, parts: Sequence[slice]) -> Array:
    """Means of all columns."""
    means, fields = [], _fields(robot.model, batch)
    count = parts[0].stop - parts[0].start
    together = max(1, AT_ONCE // count)
    for first in range(0, len(parts), together):
        own = parts[first : first + together]
        rows = np.concatenate([np.arange(part.start, part.stop) for part in own])
        whole = _whole(robot, batch, predicted, fields, rows)
        means.append(whole.reshape(len(own), count, *whole.shape[1:]).mean(axis=1))
    return np.concatenate(means)


def _whole(robot: Robot, batch: Batch, predicted: Array, fields: Array, rows: NDArray[np.int64]) -> Array:
    """All columns at some rows, (rows, nv, columns)."""
    q, v, a = batch.q[rows], batch.v[rows], batch.a[rows]
    of_joints = [a, v, np.sign(v), np.ones_like(v), predicted[rows]]
    diagonal = [x[:, :, None] * np.eye(robot.model.nv) for x in of_joints]
    return np.concatenate([robot.regressor(q, v, a), *diagonal, fields[rows]], axis=-1)


def _fields(model: Model, batch: Batch) -> Array:
    """What a unit of gravity along each axis takes, (N, nv, 3)."""
    still = Batch(model, batch.q, np.zeros_like(batch.v), np.zeros_like(batch.a))
    bare = model.without_joint_effects()
    return np.stack([run(bare.with_gravity(own), still)["tau"] for own in np.eye(3)], axis=-1)
