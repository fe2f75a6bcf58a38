"""From rows as a file has them to rows that can be used: finite, in time, of one unit, angles that go on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError
from rttrr_pin.trajectories.clock import GAP, UNITS, unit_of
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import Rows, Source

HEAD = 10_000
"""Rows that tell the unit of time, and how far rows are apart."""

FEW = 100
"""Rows of which the usual distance says nothing; that of the head counts."""

QUATERNION = 1e-3
"""How far the length of a quaternion may be from 1 by rounding: four digits."""

NORMALISED = 1e-9
"""How far it may be that nobody need know."""

ALIKE = 1.0
"""A jump by a turn is one by 2 pi and less than this [rad]."""


NONE = np.zeros(0, np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Rows that can be used.

    Attributes:
        rows: with time in seconds.
        breaks: indices of the rows before which time has a gap.
    """

    rows: Rows
    breaks: NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Clock:
    """What the first rows say of time.

    Attributes:
        unit: of time [s].
        step: between two rows, usually [s]; NaN where there is one row.
        note: where the unit is not seconds; else empty.
    """

    unit: float
    step: float
    note: str


def clock_of(source: Source, model: Model) -> Clock:
    """The unit of time and the usual distance of rows, by the first ones.

    Raises:
        InputError: no row can be used.
    """
    parts: list[Rows] = []
    for rows in in_time(source, Findings(source.place)):
        parts.append(rows)
        if sum(map(len, parts)) >= HEAD:
            break
    head = Rows.joined(parts).part(slice(0, HEAD))
    word, note = unit_of(head.time, head.values, model)
    unit = UNITS[word] if source.unit is None else source.unit
    step = float(np.median(np.diff(head.time))) * unit if len(head) > 1 else math.nan
    return Clock(unit, step, note if source.unit is None else "")


def in_time(source: Source, findings: Findings) -> Iterator[Rows]:
    """The rows whose numbers are finite and whose time is later than that of the row before.

    Raises:
        InputError: time goes back, or no row can be used.
    """
    last, count = -math.inf, 0
    for rows in source.read(findings):
        rows = _finite(rows, source, findings)
        if not len(rows):
            continue
        steps = np.diff(rows.time, prepend=last)
        if not steps.min() > 0.0:
            rows = _later(rows, steps, source, findings)
        if len(rows):
            last, count = float(rows.time[-1]), count + len(rows)
            yield rows
    if not count:
        seen = "; ".join(finding.sentence for finding in findings.all())
        raise InputError(f"{source.name} has no row that can be used{seen and ': '}{seen}")


def _finite(rows: Rows, source: Source, findings: Findings) -> Rows:
    """Rows of finite numbers; what is not is counted by column."""
    good = np.isfinite(rows.time)
    for x in rows.values.values():
        if not math.isfinite(_total(x)):  # which may be an overflow of numbers that are finite
            good &= np.isfinite(x).all(axis=1)
    if good.all():
        return rows
    columns = [("time", rows.time)]
    for key, x in rows.values.items():
        columns += zip(source.labels[key], x.T, strict=True)
    for name, x in columns:
        bad = ~np.isfinite(x)
        findings.add("not finite", name, rows.numbers[bad], x[bad], np.zeros(bad.sum()))
    return rows.part(good)


def _total(x: Array) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        return float(x.sum())


def _later(rows: Rows, steps: Array, source: Source, findings: Findings) -> Rows:
    """Without rows that repeat a time."""
    if (steps < 0.0).any():
        k = int(np.argmax(steps < 0.0))
        raise InputError(
            f"{source.name}, {source.place} {rows.numbers[k]}, column time: it goes back by {-steps[k]:.6g}: "
            "sort the rows, or cut the file"
        )
    same = steps == 0.0
    findings.add("repeated time", "time", rows.numbers[same], rows.time[same], np.zeros(same.sum()))
    return rows.part(~same)


@dataclass(slots=True, eq=False)
class Cleaner:
    """What is remembered from one part of a trajectory to the next.

    Attributes:
        source: of the rows.
        model: of the robot.
        clock: unit and step.
        findings: of this run.
    """

    source: Source
    model: Model
    clock: Clock
    findings: Findings
    _last_time: float = math.nan
    _turns: dict[int, float] = field(default_factory=dict)
    _last: dict[int, float] = field(default_factory=dict)

    def parts(self) -> Iterator[Part]:
        """All rows that can be used.

        Raises:
            InputError: time goes back, a quaternion is none, or no row can be used.
        """
        for rows in in_time(self.source, self.findings):
            t = rows.time * self.clock.unit if self.clock.unit != 1.0 else rows.time
            values = dict(rows.values)
            if "q" in values:
                values["q"] = self._normalised(self._unwrapped(values["q"], rows.numbers), rows.numbers)
            yield Part(Rows(rows.numbers, t, values), self._breaks(t, rows.numbers))

    def _breaks(self, t: Array, numbers: NDArray[np.int64]) -> NDArray[np.int64]:
        """Gaps in time: by the usual distance here, since rates may change."""
        steps = np.diff(t, prepend=self._last_time)
        first, self._last_time = math.isnan(self._last_time), float(t[-1])
        if first and len(t) == 1:
            return NONE
        least, most = float(np.nanmin(steps)), float(np.nanmax(steps))
        if most <= GAP * least and (len(t) >= FEW or most <= GAP * self.clock.step):
            return NONE
        usual = float(np.nanmedian(steps)) if len(t) >= FEW else self.clock.step
        breaks = np.flatnonzero(steps > GAP * usual)
        self.findings.add("gap", "time", numbers[breaks], steps[breaks])
        return breaks

    def _unwrapped(self, q: Array, numbers: NDArray[np.int64]) -> Array:
        """Angles that jump by a turn go on."""
        at, copied = 0, False
        for joint in self.model.moving:
            if joint.type.rotates:
                x = q[:, at]
                jumps, turns = _turns(x, self._last.get(at, float(x[0])))
                self._last[at] = float(x[-1])
                before = self._turns.get(at, 0.0)
                if len(jumps) or before:
                    if not copied:
                        q, copied = q.copy(order="K"), True
                    added = np.zeros(len(x))
                    added[jumps] = turns
                    q[:, at] -= 2 * np.pi * (before + np.cumsum(added))
                    self._turns[at] = before + float(turns.sum())
                    self.findings.add("turn", joint.name, numbers[jumps], x[jumps], np.zeros(len(jumps)))
            at += joint.nq
        return q

    def _normalised(self, q: Array, numbers: NDArray[np.int64]) -> Array:
        """Quaternions of length 1 to all digits."""
        for first in self.model.quaternions:
            own = slice(first, first + 4)
            length = norm(q[:, own])
            off = np.abs(length - 1.0)
            name = self.model.q_names[first].rpartition(".")[0]
            if off.max() > QUATERNION:
                k = int(np.argmax(off > QUATERNION))
                raise InputError(
                    f"{self.source.name}, {self.source.place} {numbers[k]}, columns {self.source.labels['q'][first]}"
                    f", ...: a quaternion (x, y, z, w) of length {length[k]:.6g}, expected 1: divide it by its length"
                )
            bad = off > NORMALISED
            self.findings.add("quaternion", name, numbers[bad], length[bad], off[bad])
            q = q.copy(order="K")
            q[:, own] /= length[:, None]
        return q


def _turns(x: Array, last: float) -> tuple[NDArray[np.int64], Array]:
    """Where an angle jumps by one turn or more, and by how many."""
    if max(float(x.max()), last) - min(float(x.min()), last) <= np.pi:
        return NONE, np.zeros(0)
    steps = np.diff(x, prepend=last)
    turns = np.round(steps / (2 * np.pi))
    jumps = np.flatnonzero((turns != 0.0) & (np.abs(steps - 2 * np.pi * turns) < ALIKE))
    return jumps, turns[jumps]


def check_limits(model: Model, rows: Rows, labels: Sequence[str], findings: Findings) -> None:
    """Coordinates and rates beyond the limits of the robot's file are found."""
    at = k = 0
    for joint in model.moving:
        own = joint.limits
        if joint.nq == 1:
            x = rows.values["q"][:, at]
            for kind, sign, limit in (("lower limit", -1.0, own.lower), ("upper limit", 1.0, own.upper)):
                if math.isfinite(limit) and (x.max() > limit if sign > 0 else x.min() < limit):
                    bad = sign * (x - limit) > 0.0
                    findings.add(kind, labels[at], rows.numbers[bad], x[bad], sign * x[bad])
            v = rows.values["v"][:, k]
            if 0.0 < own.velocity < max(v.max(), -v.min()):
                speed = np.abs(v)
                bad = speed > own.velocity
                findings.add("rate limit", joint.name, rows.numbers[bad], v[bad], speed[bad])
        at, k = at + joint.nq, k + joint.nv
