"""Trajectories in NPZ: arrays `time`, `q`, ... or one for each column, read from the archive some rows at a time."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy

from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, listed, shortened
from rttrr_pin.implementations.text_results import PAYLOAD
from rttrr_pin.trajectories.clock import UNITS, counted_from, origin_of, time_of
from rttrr_pin.trajectories.columns import Columns, columns_of_file, payloads_of_file, time_column
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import AT_ONCE, Rows, Source, numbered

NAMES = ("joint_names", "joints", "names")
"""Arrays that say whose the columns of q, v and a are."""


@dataclass(frozen=True, slots=True)
class _Member:
    """An array of the archive."""

    shape: tuple[int, ...]
    fortran: bool
    dtype: np.dtype[Any]


def npz_source(path: Path, model: Model, more: Sequence[str] = ()) -> Source:
    """An archive of arrays.

    Raises:
        InputError, UnknownNameError: it cannot be read, or an array is missing or of another shape.
    """
    members = _members(path)
    arrays = [key for key in ("q", "v", "a", *more) if key in members and len(members[key].shape) == 2]
    if arrays:
        columns, places = _of_arrays(path, model, members, arrays)
    else:
        flat = [key for key, own in members.items() if len(own.shape) == 1 and own.dtype.kind in "iufmM"]
        columns, places = columns_of_file(flat, model, path.name, more), {}
    names = [columns.time, *arrays, *(x for key, own in columns.labels.items() if key not in places for x in own)]
    count = _same_length(path.name, members, names)
    kind = members[columns.time].dtype
    unit = _unit(kind, path.name) if kind.kind in "mM" else columns.unit
    with zipfile.ZipFile(path) as archive, archive.open(f"{columns.time}.npy") as file:
        origin = origin_of(float(_whole(next(_parts(file, path.name)))[0]))

    def read(findings: Findings) -> Iterator[Rows]:
        with ExitStack() as stack:
            archive = stack.enter_context(zipfile.ZipFile(path))
            parts = {key: _parts(stack.enter_context(archive.open(f"{key}.npy")), path.name) for key in names}
            for start in range(0, count, AT_ONCE):
                x = {key: next(part) for key, part in parts.items()}
                values = {
                    key: np.asarray(x[key][:, places[key]], np.float64)
                    if key in places
                    else np.stack([x[name] for name in own], axis=1).astype(np.float64)
                    for key, own in columns.labels.items()
                }
                t = time_of(_whole(x[columns.time]), origin)
                yield Rows(numbered(start, len(t)), t, values)

    return Source(
        path.name,
        read,
        columns.labels,
        columns.loads,
        unit=unit,
        origin=counted_from(origin),
        n_rows=count,
        notes=columns.notes,
    )


def _unit(kind: np.dtype[Any], name: str) -> float:
    """The unit of dates and durations.

    Raises:
        InputError: it is a day, or two seconds.
    """
    unit, count = np.datetime_data(kind)
    if unit not in UNITS or count != 1:
        raise InputError(f"{name}, array time: {kind} is no usual unit of time: write seconds as float64")
    return UNITS[unit]


def _whole(t: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Dates and durations as integers; what is missing is NaN."""
    if t.dtype.kind not in "mM":
        return t
    return np.where(np.isnat(t), np.nan, t.view(np.int64)) if np.isnat(t).any() else t.view(np.int64)


def _same_length(name: str, members: Mapping[str, _Member], names: Sequence[str]) -> int:
    """The number of rows.

    Raises:
        InputError: arrays have different ones, or none.
    """
    lengths = {key: members[key].shape[0] for key in names}
    if len(set(lengths.values())) > 1:
        shown = listed(f"{key} {length}" for key, length in lengths.items())
        raise InputError(f"{name} has arrays of different lengths, {shown}: write one row for each time")
    count = next(iter(lengths.values()))
    if not count:
        raise InputError(f"{name} has no row: write one for each time")
    return count


def _members(path: Path) -> dict[str, _Member]:
    """What arrays there are, without reading them."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {
                name.removesuffix(".npy"): _header(archive.open(name))
                for name in archive.namelist()
                if name.endswith(".npy")
            }
    except (OSError, ValueError, zipfile.BadZipFile, NotImplementedError, RuntimeError) as error:
        raise InputError(f"{path.name} cannot be read as NPZ: {shortened(str(error))}") from error


def _header(file: IO[bytes]) -> _Member:
    version = npy.read_magic(file)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    return _Member(*read(file))


def _parts(file: IO[bytes], name: str) -> Iterator[np.ndarray[Any, Any]]:
    """Some rows of an array after the others; one in Fortran's order is read whole."""
    own = _header(file)
    if own.fortran and len(own.shape) > 1:
        x = np.frombuffer(file.read(), own.dtype).reshape(own.shape, order="F")
        yield from (x[start : start + AT_ONCE] for start in range(0, len(x), AT_ONCE))
        return
    width = int(np.prod(own.shape[1:]))
    for start in range(0, own.shape[0], AT_ONCE):
        rows = min(AT_ONCE, own.shape[0] - start)
        data = file.read(rows * width * own.dtype.itemsize)
        if len(data) < rows * width * own.dtype.itemsize:
            raise InputError(f"{name} ends before its arrays do: write it anew")
        yield np.frombuffer(data, own.dtype).reshape(rows, *own.shape[1:])


def _of_arrays(
    path: Path, model: Model, members: Mapping[str, _Member], arrays: Sequence[str]
) -> tuple[Columns, dict[str, list[int]]]:
    """The columns of an archive with q, v, a as arrays, and where in them each coordinate stands."""
    if "q" not in arrays:
        raise InputError(f"{path.name} has no array q of shape (N, {model.nq}): add it")
    key = next((own for own in NAMES if own in members), None)
    given = _strings(path, key) if key else None
    labels: dict[str, tuple[str, ...]] = {}
    places: dict[str, list[int]] = {}
    for name in arrays:
        wanted = model.q_names if name == "q" else model.v_names
        order = list(wanted) if given is None else given
        missing = [label for label in wanted if label not in order]
        if missing:
            raise InputError(f"{path.name}, array {key} lacks {listed(missing)}: name each joint")
        own = members[name]
        if own.shape[1] != len(order) or own.dtype.kind not in "iuf":
            wanted_shape = f"(N, {len(order)}) of float64"
            raise InputError(f"{path.name}, array {name}: {own.shape} of {own.dtype}, expected {wanted_shape}")
        labels[name], places[name] = tuple(f"{name}_{label}" for label in wanted), [*map(order.index, wanted)]
    flat = [name for name, own in members.items() if len(own.shape) == 1 and name not in NAMES]
    time, unit = time_column(flat, path.name)
    loads = payloads_of_file(flat, model, path.name, labels)
    order_note = f"no array {NAMES[0]}: columns are in the robot's order, {listed(model.q_names)}"
    notes = [order_note] if given is None else []
    read = {time, *arrays, *NAMES, *labels.get(PAYLOAD, ())}
    if rest := [shortened(name) for name in members if name not in read]:
        notes.append(f"{'array' if len(rest) == 1 else 'arrays'} not read: {listed(rest)}")
    return Columns(time, unit, labels, loads, tuple(notes)), places


def _strings(path: Path, key: str) -> list[str]:
    with np.load(path, allow_pickle=False) as archive:
        names = archive[key]
    if names.dtype.kind not in "US" or names.ndim != 1:
        raise InputError(f"{path.name}, array {key}: {names.dtype} of shape {names.shape}, expected names, (N,)")
    own = [name.decode() if isinstance(name, bytes) else str(name) for name in names.tolist()]
    twice = [name for name in own if own.count(name) > 1]
    if twice:
        raise InputError(f"{path.name}, array {key} has {shortened(repr(twice[0]))} twice: name each joint once")
    return own
