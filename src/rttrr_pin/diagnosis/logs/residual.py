"""The residual of a log, and all that is linear in it: what joints take, what links weigh, gravity, factors of tau."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.engine.evidence import rms
from rttrr_pin.diagnosis.logs.log import Log
from rttrr_pin.diagnosis.logs.selection import DEPENDENT
from rttrr_pin.diagnosis.variants.variant import run
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.robot import Robot

PER_LINK = 10

OF_JOINT = ("armature", "viscous", "coulomb", "offset", "factor")
"""Columns of each degree of freedom, behind those of the links: a, v, sign(v), 1, tau of the model."""

ROWS = 1500
"""Means of consecutive rows that are fitted, at most: more only take time."""

AT_ONCE = 2000
"""Rows whose regressor is held at a time."""

STILL = 1e-3
"""Of coordinates [rad or m]: what friction at rest lets a joint move, about, at most."""

NONE = 1e-6
"""Of the root mean square of tau: what a log without noise is taken to have, since its numbers have digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """What was measured less what the model says, and the columns that may explain it.

    Attributes:
        robot: as it is modelled.
        log: as it was read.
        predicted: tau of the model at each row of the log, (N, nv) [N m or N].
        means: of consecutive rows of the residual, (M, nv).
        columns: of the same means, (M, nv, columns).
        weights: one over the standard deviation of a mean, (nv,).
        noise: standard deviation of a row, by noise of tau and errors of v and a, (nv,); where that is not known, by
            what all columns together leave.
        known: whether it is, at all joints.
    """

    robot: Robot
    log: Log
    predicted: Array
    means: Array
    columns: Array
    weights: Array
    noise: Array
    known: bool

    @property
    def model(self) -> Model:
        """Of the robot."""
        return self.robot.model

    @property
    def whole(self) -> Array:
        """The residual at each row of the log, (N, nv) [N m or N]."""
        return self.log.tau - self.predicted

    @property
    def still(self) -> list[bool]:
        """Of each degree of freedom, whether it hardly moves, so that nothing tells friction at rest from an offset."""
        begins = accumulate((joint.nq for joint in self.model.moving), initial=0)
        moved = np.ptp(self.log.batch.q, axis=0)
        joints = zip(begins, self.model.moving, strict=False)
        return [bool((moved[at : at + joint.nq] < STILL).all()) for at, joint in joints for _ in range(joint.nv)]

    @property
    def size(self) -> Array:
        """Root mean square of tau, (nv,)."""
        return rms(self.log.tau)

    def made_of(self, x: Array) -> Array:
        """What columns times these numbers make of tau at each row of the log, (N, nv)."""
        rows = (np.arange(part.start, part.stop) for part in blocks(len(self.log), AT_ONCE))
        return np.concatenate([_columns(self.robot, self.log.batch, self.predicted, own) @ x for own in rows])

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
    error, least = _of_differentiation(model, log, predicted), NONE * rms(log.tau)
    of_tau = np.maximum(log.noise, least)
    count = _rows_of_a_mean(log)
    parts = [slice(a, a + count) for own in log.segments for a in range(own.start, own.stop - count + 1, count)]
    residual = log.tau - predicted
    means = np.stack([residual[own].mean(axis=0) for own in parts])
    columns = _means(robot, batch, predicted, parts)
    known = np.isfinite(of_tau)
    noise, of_mean = np.sqrt(of_tau**2 + error**2), np.sqrt(of_tau**2 / count + error**2)
    if not known.all():
        left = np.maximum(_unexplained(columns, means), least**2)
        within = np.mean([residual[own].var(axis=0) for own in parts], axis=0)
        noise, of_mean = np.where(known, noise, np.sqrt(left + within)), np.where(known, of_mean, np.sqrt(left))
    weights = 1.0 / np.where(of_mean > 0, of_mean, 1.0)
    return Residuals(robot, log, predicted, means, columns, weights, noise, bool(known.all()))


def _unexplained(columns: Array, means: Array) -> Array:
    """The variance of means at each joint that no sum of the columns explains, (nv,)."""
    left = []
    for j in range(means.shape[1]):
        A, y = columns[:, j], means[:, j]
        sizes = np.linalg.norm(A, axis=0)
        A = A / np.where(sizes > 0, sizes, 1.0)
        x, _, rank, _ = np.linalg.lstsq(A, y, rcond=DEPENDENT)
        left.append(float(((y - A @ x) ** 2).sum()) / max(len(y) - int(rank), 1))
    return np.array(left)


def _of_differentiation(model: Model, log: Log, predicted: Array) -> Array:
    """What errors of v and a do to tau, (nv,)."""
    if log.others is None:
        return np.zeros(model.nv)
    again = run(model, Batch(model, *log.others))["tau"]
    # Both have noise of their own, that of the first and that of both in the second: their difference is one of them.
    return rms(again - predicted)


def _rows_of_a_mean(log: Log) -> int:
    """So many that there are not more means than can be told apart."""
    shortest = min(own.stop - own.start for own in log.segments)
    step = float(np.median(np.diff(log.time)))
    count = max(1, math.ceil(len(log) / ROWS), math.floor(log.bandwidth / 4 / step))
    return int(min(count, max(1, shortest // 4)))


def _means(robot: Robot, batch: Batch, predicted: Array, parts: Sequence[slice]) -> Array:
    """Means of all columns, (M, nv, columns)."""
    means = []
    count = parts[0].stop - parts[0].start
    together = max(1, AT_ONCE // count)
    for first in range(0, len(parts), together):
        own = parts[first : first + together]
        rows = np.concatenate([np.arange(part.start, part.stop) for part in own])
        whole = _columns(robot, batch, predicted, rows)
        means.append(whole.reshape(len(own), count, *whole.shape[1:]).mean(axis=1))
    return np.concatenate(means)


def _columns(robot: Robot, batch: Batch, predicted: Array, rows: NDArray[np.int64]) -> Array:
    """All columns at some rows, (rows, nv, columns)."""
    q, v, a = batch.q[rows], batch.v[rows], batch.a[rows]
    of_joints = [a, v, np.sign(v), np.ones_like(v), predicted[rows]]
    diagonal = [x[:, :, None] * np.eye(robot.model.nv) for x in of_joints]
    return np.concatenate([robot.regressor(q, v, a), *diagonal, _fields(robot.model, q)], axis=-1)


def _fields(model: Model, q: Array) -> Array:
    """What a unit of gravity along each axis takes, (rows, nv, 3)."""
    still = Batch(model, q, *np.zeros((2, len(q), model.nv)))
    bare = model.without_joint_effects()
    return np.stack([run(bare.with_gravity(own), still)["tau"] for own in np.eye(3)], axis=-1)
