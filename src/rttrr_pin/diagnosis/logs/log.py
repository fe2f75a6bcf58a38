"""Logs of real robots: time, coordinates and driving forces, with or without rates and accelerations."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inputs import coordinates
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.logs.differentiation import FEWEST, Smoothed, smoothed
from rttrr_pin.diagnosis.logs.noise import white_noise
from rttrr_pin.errors import InputError, UnknownNameError, shortened
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.implementations.table import check_complete, check_names, numbers_of_columns
from rttrr_pin.implementations.table_files import READERS, Columns
from rttrr_pin.implementations.text_results import PAYLOAD, TIMES, column_names

UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

NEXT_UNIT = {"s": 0.5, "ms": 500.0, "us": 1e5}
"""Distance of rows from which the unit is not this one: a robot that is sampled twice a second tells nothing."""

GAP = 5.0
"""Times the usual distance of two rows: farther apart they are not of one motion."""


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """Measured motion and driving forces.

    Attributes:
        name: the file's.
        time: from the first row on, (N,) [s].
        batch: q, v, a, as measured or by splines.
        tau: driving forces, (N, nv).
        noise: standard deviation of the noise of tau, (nv,); NaN where it cannot be told from motion.
        segments: rows without a gap between them.
        others: what v and a might as well be, by the noise of what they were derived from, with q: three arrays; None
            where all were measured.
        bandwidth: distance in time from which on errors of v and a are independent [s]; 0 where they were measured.
        notes: what a reader must know.
    """

    name: str
    time: Array
    batch: Batch
    tau: Array
    noise: Array
    segments: tuple[slice, ...]
    others: tuple[Array, Array, Array] | None
    bandwidth: float
    notes: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.time)


def is_log(path: str | Path, model: Model) -> bool:
    """Whether a table is a log of a real robot: it has a column of time, and driving forces, and time goes on.

    A few rows that have rates and accelerations too are results of a program.

    Raises:
        InputError: the file cannot be read.
    """
    path = Path(path)
    if path.suffix.lower() not in READERS:
        return False
    columns, lines = READERS[path.suffix.lower()](path, model)
    time, names = next((name for name in TIMES if name in columns), None), column_names(model)
    has = {key: any(name in columns for name in names[key]) for key in ("v", "a", "tau")}
    if time is None or not has["tau"] or (len(lines) < FEWEST and has["v"] and has["a"]):
        return False
    return bool((np.diff(_time(columns, time, lines, path.name)) >= 0.0).all())


def read_log(path: str | Path, model: Model) -> Log:
    """Read a log, and derive what it lacks of v and a from q.

    Args:
        path: a table with `time` or `t`, `q_<joint>`, `tau_<joint>`, with or without `v_` and `a_`.
        model: the robot.

    Raises:
        InputError: a column, a row or a number cannot be used, or time does not go on.
        UnknownNameError: a column is of a joint that the robot has not, or the file is no table.
    """
    path = Path(path)
    if path.suffix.lower() not in READERS:
        raise UnknownNameError("format of a log", path.suffix, READERS)
    columns, lines = READERS[path.suffix.lower()](path, model)
    names, notes = column_names(model), list[str]()
    check_names(columns, model, path.name)
    time = next((name for name in TIMES if name in columns), None)
    if time is None:
        raise InputError(f"{path.name} has no column time or t: a log needs the time of each row")
    if payload := [column for column in columns if column.startswith(f"{PAYLOAD}_")]:
        raise InputError(
            f"{path.name} is a log, and has the column {shortened(payload[0])}: what the robot carried is looked for "
            f"in it; leave columns of a payload out, or the column {time}, if these are results of a program"
        )
    measured = [key for key in ("q", "v", "a", "tau") if key in ("q", "tau") or any(c in columns for c in names[key])]
    check_complete(columns, [column for key in measured for column in names[key]], path.name)
    values = {key: numbers_of_columns(columns, names[key], lines, path.name) for key in measured}
    kept, t = _usable(_time(columns, time, lines, path.name), values, lines, path.name, notes)
    values = {key: x[kept] for key, x in values.items()}
    t = t * UNITS[_unit(t, values, model, notes)]
    _unwrap(model, values["q"], notes)
    segments = _segments(t, notes)
    noise = _noise(t, values["tau"], segments)
    values, others, bandwidth, segments, inside = _differentiated(model, t, values, segments, path.name, notes)
    values = {key: x[inside] for key, x in values.items()}
    try:
        q, v, a = (coordinates(key, values[key], model.moving) for key in "qva")
    except InputError as error:
        raise InputError(f"{path.name}: {error}") from error
    if others is not None:
        others = others[0][inside], others[1][inside], others[2][inside]
    return Log(
        path.name, t[inside], Batch(model, q, v, a), values["tau"], noise, segments, others, bandwidth, tuple(notes)
    )


def _time(columns: Columns, name: str, lines: Sequence[int], table: str) -> Array:
    """From the first row on, in the unit of the column: nanoseconds since 1970 have more digits than float64."""
    texts = columns[name]
    if isinstance(texts, np.ndarray):
        return np.asarray(texts - texts[0], dtype=np.float64)
    if all(re.fullmatch(r"[+-]?\d{1,30}", text) for text in texts):
        first = int(texts[0])
        return np.array([float(int(text) - first) for text in texts])
    x = numbers_of_columns(columns, [name], lines, table)[:, 0]
    return np.asarray(x - x[0])


def _usable(
    t: Array, values: dict[str, Array], lines: Sequence[int], name: str, notes: list[str]
) -> tuple[Array, Array]:
    """The rows that can be used, and their times."""
    finite = np.isfinite(t) & np.all([np.isfinite(x).all(axis=1) for x in values.values()], axis=0)
    rows = np.flatnonzero(finite)
    if len(rows) < len(t):
        notes.append(f"{len(t) - len(rows)} rows with a number that is not finite are left out")
    steps = np.diff(t[rows])
    if (steps < 0).any():
        line = lines[rows[int(np.argmax(steps < 0)) + 1]]
        raise InputError(f"{name}, line {line}: time goes back by {-steps.min():.6g}: sort the rows, or cut the file")
    new = np.concatenate([[True], steps > 0])[: len(rows)]
    if not new.all():
        notes.append(f"{int((~new).sum())} rows repeat the time of the row before, and are left out")
    rows = rows[new]
    if len(rows) < FEWEST:
        raise InputError(f"{name} has {len(rows)} rows that can be used: a log needs {FEWEST} or more")
    return rows, t[rows]


def _unit(t: Array, values: dict[str, Array], model: Model, notes: list[str]) -> str:
    """The unit of time: that in which q changes as v says; without v, in which rows are as far apart as they can be."""
    step = float(np.median(np.diff(t)))
    unit = next((own for own, limit in NEXT_UNIT.items() if step < limit), "ns")
    if "v" in values and model.nq == model.nv:
        moved, rate = np.abs(np.diff(values["q"], axis=0)).sum(), np.abs(values["v"][1:] * np.diff(t)[:, None]).sum()
        if moved and rate:
            unit = min(UNITS, key=lambda own: abs(np.log(rate * UNITS[own] / moved)))
    if unit != "s":
        words = {"ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}[unit]
        notes.append(f"time is taken as {words}, since rows are {step:.6g} apart")
    return unit


def _unwrap(model: Model, q: Array, notes: list[str]) -> None:
    """Angles that jump by a turn go on, in place."""
    at = 0
    for joint in model.moving:
        if joint.type.rotates:
            whole = np.unwrap(q[:, at])
            if not np.array_equal(whole, q[:, at]) and np.abs(whole - q[:, at]).max() > 1.0:
                notes.append(f"{joint.name} jumps by a turn: its angle is taken to go on")
                q[:, at] = whole
        at += joint.nq


def _segments(t: Array, notes: list[str]) -> tuple[slice, ...]:
    """Rows without a gap between them; too short ones are left out."""
    steps = np.diff(t)
    ends = [0, *(np.flatnonzero(steps > GAP * np.median(steps)) + 1).tolist(), len(t)]
    whole = [slice(a, b) for a, b in pairwise(ends)]
    long = tuple(own for own in whole if own.stop - own.start >= FEWEST)
    if len(whole) > 1:
        lost = sum(own.stop - own.start for own in whole if own not in long)
        notes.append(f"{len(whole) - 1} gaps in time: {len(long)} parts are used, {lost} rows between them are not")
    if not long:
        raise InputError(f"no {FEWEST} rows follow each other without a gap in time: log faster, or without pauses")
    return long


def _noise(t: Array, tau: Array, segments: Sequence[slice]) -> Array:
    """The largest of all segments' would be of the shortest: that of the longest."""
    longest = max(segments, key=lambda own: own.stop - own.start)
    return white_noise(t[longest], tau[longest])


def _differentiated(
    model: Model, t: Array, values: dict[str, Array], segments: Sequence[slice], name: str, notes: list[str]
) -> tuple[dict[str, Array], tuple[Array, Array, Array] | None, float, tuple[slice, ...], Array]:
    """V and a, where they were not measured; without the ends of segments, where splines are at their worst."""
    inside = np.concatenate([np.arange(len(t))[own] for own in segments])
    if "v" in values and "a" in values:
        return values, None, 0.0, _counted(segments), inside
    if "v" not in values:
        several = [joint.name for joint in model.moving if joint.nv > 1]
        if several:
            raise InputError(f"{name} lacks columns v_{several[0]}...: rates of {several[0]} are no derivatives of q")
    source, order = ("v", 1) if "v" in values else ("q", 2)
    x = values[source]
    parts = [smoothed(t[own], x[own]) for own in segments]
    knots = min(part.knots for part in parts)
    new = {key: np.zeros((len(t), model.nv)) for key in "qva"[2 - order :]}
    others = {key: np.zeros_like(own) for key, own in new.items()}
    cut = []
    for own, part in zip(segments, parts, strict=True):
        for k, key in enumerate(new):
            new[key][own], others[key][own] = part.orders[k], part.others[k]
        rows = np.arange(len(t))[own]
        cut.append(rows[(t[rows] >= t[rows[0]] + knots) & (t[rows] <= t[rows[-1]] - knots)])
    new = {key: values[key] if key in values and key == "a" else own for key, own in new.items()}
    others = {key: values[key] if key in values and key == "a" else own for key, own in others.items()}
    inside = np.concatenate(cut)
    notes.append(_said(model, source, parts, new, others, inside, knots))
    whole = values | new
    every = (whole | others)["q"], (whole | others)["v"], (whole | others)["a"]
    return whole, every, knots, _counted([slice(0, len(own)) for own in cut]), inside


def _said(
    model: Model,
    source: str,
    parts: Sequence[Smoothed],
    new: dict[str, Array],
    others: dict[str, Array],
    inside: Array,
    knots: float,
) -> str:
    """How large the error of differentiation is."""
    noise = np.max([part.noise for part in parts], axis=0)
    errors = {key: np.sqrt(((new[key] - others[key])[inside] ** 2).mean(axis=0)) for key in "va" if key in new}
    said = ", ".join(f"{key} to {x.max(initial=0.0):.2g}" for key, x in errors.items() if x.any())
    worst = model.v_names[int(np.argmax(errors["a"]))] if model.nv and errors.get("a", noise).any() else ""
    by = f"by splines of {source}, knots {knots:.2g} s apart, whose noise is {noise.max(initial=0.0):.2g} or less"
    where = f" at worst (a of {shortened(worst)})" if worst else ""
    known = f"known to {said or '0'}{where}; {knots:.2g} s at each end are cut"
    return f"{' and '.join(errors)} {by}: {known}"


def _counted(segments: Sequence[slice]) -> tuple[slice, ...]:
    """Segments of rows of which nothing lies between them any more."""
    ends = np.cumsum([0, *(own.stop - own.start for own in segments)]).tolist()
    return tuple(slice(a, b) for a, b in pairwise(ends) if b > a)
