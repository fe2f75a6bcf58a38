"""Logs of real robots: time, coordinates and driving forces, with or without rates and accelerations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, UnknownNameError, shortened
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.implementations.table import numbers_of_columns
from rttrr_pin.implementations.table_files import READERS
from rttrr_pin.implementations.text_results import PAYLOAD, TIMES, column_names
from rttrr_pin.trajectories.cleaning import Cleaner, Part, clock_of
from rttrr_pin.trajectories.derivatives import Record, derived
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.noise import white_noise
from rttrr_pin.trajectories.read import open_source
from rttrr_pin.trajectories.rows import Rows
from rttrr_pin.trajectories.spline import FEWEST


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
    return bool((np.diff(numbers_of_columns(columns, [time], lines, path.name)[:, 0]) >= 0.0).all())


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
    source = open_source(path, model, ("tau",))
    if source.loads:
        raise InputError(
            f"{path.name} is a log, and has the column {shortened(source.labels[PAYLOAD][0])}: what the robot carried "
            "is looked for in it; leave columns of a payload out, or the column of time, if these are results of a "
            "program"
        )
    findings, clock = Findings(source.place), clock_of(source, model)
    parts = list(Cleaner(source, model, clock, findings).parts())
    rows = Rows.joined([part.rows for part in parts])
    if len(rows) < FEWEST:
        raise InputError(f"{path.name} has {len(rows)} rows that can be used: a log needs {FEWEST} or more")
    segments = _segments(parts)
    longest = max(segments, key=lambda own: own.stop - own.start)
    noise = white_noise(rows.time[longest], rows.values["tau"][longest])
    record = Record.of_source(source, model, None)
    pieces = [rows.part(own) for own in segments]
    errors = None
    notes, knots = [*source.notes, *filter(None, [source.origin, clock.note])], 0.0
    if record is not None:
        whole = [_derived(piece, record, findings) for piece in pieces]
        told = record.told()
        knots = min(told.knots)
        whole = [_without_ends(*own, knots) for own in whole]
        pieces, errors = [own for own, _ in whole], np.concatenate([own for _, own in whole])
        notes.append(f"{told.summary()}; {knots:.2g} s at each end are cut")
    used = Rows.joined(pieces)
    t, values = used.time - rows.time[0], used.values
    ends = np.cumsum([0, *map(len, pieces)]).tolist()
    return Log(
        path.name,
        t,
        Batch(model, values["q"], values["v"], values["a"]),
        values["tau"],
        noise,
        tuple(slice(a, b) for a, b in pairwise(ends) if b > a),
        None if errors is None else _others(values, errors),
        knots,
        (*notes, *(finding.sentence for finding in findings.all())),
    )


def _segments(parts: Sequence[Part]) -> list[slice]:
    """Rows without a gap between them; too short ones are left out.

    Raises:
        InputError: all are.
    """
    begins = np.cumsum([0, *(len(part.rows) for part in parts)])
    breaks = [begin + part.breaks for begin, part in zip(begins, parts, strict=False)]
    ends = [0, *np.concatenate(breaks).astype(int).tolist(), int(begins[-1])]
    long = [slice(a, b) for a, b in pairwise(ends) if b - a >= FEWEST]
    if not long:
        raise InputError(f"no {FEWEST} rows follow each other without a gap in time: log faster, or without pauses")
    return long


def _derived(piece: Rows, record: Record, findings: Findings) -> tuple[Rows, Array]:
    """The rows of a segment with v and a, and the factors of their errors."""
    windows = list(derived([Part(piece, np.zeros(0, np.int64))], record, findings))
    return Rows.joined([rows for rows, _ in windows]), np.concatenate([errors for _, errors in windows])


def _without_ends(piece: Rows, errors: Array, knots: float) -> tuple[Rows, Array]:
    """Splines are at their worst at the ends."""
    inside = (piece.time >= piece.time[0] + knots) & (piece.time <= piece.time[-1] - knots)
    return piece.part(inside), errors[inside]


def _others(values: Mapping[str, Array], errors: Array) -> tuple[Array, Array, Array]:
    """What q, v and a might as well be, by their errors."""
    drawn = np.random.default_rng(0).standard_normal(errors.shape[:-1])
    off = (errors @ drawn[..., None])[..., 0]
    return values["q"] + off[..., 0], values["v"] + off[..., 1], values["a"] + off[..., 2]
