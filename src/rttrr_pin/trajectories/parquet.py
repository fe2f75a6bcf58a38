"""Trajectories in Parquet: only the columns that are needed, some rows at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, InputError
from rttrr_pin.trajectories.clock import UNITS, counted_from, origin_of, time_of
from rttrr_pin.trajectories.columns import Columns, columns_of_file
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import Rows, Source, numbered

BATCH, BUFFER = 16384, 65536
"""Rows that are decoded at a time, and bytes that are read at a time of each column: little enough to stay in the
cache of the processor, and whatever the size of the file's row groups."""

ParquetFile: TypeAlias = Any


def parquet_source(path: Path, model: Model, more: Sequence[str] = ()) -> Source:
    """A file of columns of numbers; time may be of a type that says its unit.

    Raises:
        InputError, UnknownNameError: it cannot be read, or a column is missing, unknown, or of no numbers.
        ImplementationError: pyarrow is not installed.
    """
    file = _opened(path)
    columns = columns_of_file(file.schema_arrow.names, model, path.name, more)
    unit = _checked(file.schema_arrow, columns, path.name)
    time = next((batch.column(0) for batch in _batches(file, [columns.time], path.name) if batch.num_rows), None)
    if time is None:
        raise InputError(f"{path.name} has no row: write one for each time")
    origin = origin_of(float(_numbers(time.slice(0, 1))[0]))

    def read(findings: Findings) -> Iterator[Rows]:
        first = 1
        for batch in _batches(_opened(path), columns.wanted, path.name):
            yield _rows(batch, columns, origin, first)
            first += batch.num_rows

    return Source(
        path.name,
        read,
        columns.labels,
        columns.loads,
        unit=columns.unit if unit is None else unit,
        origin=counted_from(origin),
        n_rows=file.metadata.num_rows,
        notes=columns.notes,
    )


def _opened(path: Path) -> ParquetFile:
    try:
        from pyarrow import parquet
    except ImportError as error:
        raise ImplementationError(
            "a Parquet table needs pyarrow, which is not installed: pip install 'rttrr-pin[parquet]'"
        ) from error
    try:
        return parquet.ParquetFile(path, buffer_size=BUFFER, pre_buffer=False)
    except (OSError, ValueError) as error:  # pyarrow's own errors are of these two
        raise InputError(f"{path.name} cannot be read as Parquet: {error}") from error


def _batches(file: ParquetFile, names: Sequence[str], name: str) -> Iterator[Any]:
    """Batches of some columns, in this order."""
    batches = file.iter_batches(BATCH, columns=list(names), use_threads=False)
    while True:
        try:
            batch = next(batches, None)
        except (OSError, ValueError) as error:
            raise InputError(f"{name} cannot be read as Parquet: {error}") from error
        if batch is None:
            return
        yield batch.select(list(names))


def _checked(schema: Any, columns: Columns, name: str) -> float | None:
    """The unit of time where its type says it; all columns have types of real numbers.

    Raises:
        InputError: one has not.
    """
    from pyarrow import types

    unit = None
    for column in columns.wanted:
        kind = schema.field(column).type
        if column == columns.time and (types.is_timestamp(kind) or types.is_duration(kind)):
            unit = UNITS[kind.unit]
        elif not (types.is_floating(kind) or types.is_integer(kind)):
            raise InputError(f"{name}, column {column}: {kind} is no type of real numbers: write it as float64")
    return unit


def _rows(batch: Any, columns: Columns, origin: int, first: int) -> Rows:
    """Columns one behind the other in memory, as the file has them: kernels take them so."""
    values: dict[str, Array] = {}
    at = 1
    for key, names in columns.labels.items():
        x = np.empty((len(names), batch.num_rows))
        for k in range(len(names)):
            x[k] = _numbers(batch.column(at + k))
        values[key], at = x.T, at + len(names)
    return Rows(numbered(first, batch.num_rows), time_of(_numbers(batch.column(0)), origin), values)


def _numbers(column: Any) -> np.ndarray[Any, Any]:
    """Without a copy where no number is missing; what is missing is NaN."""
    x = np.asarray(column.to_numpy(zero_copy_only=False))
    if x.dtype.kind not in "mM":
        return x
    missing = np.isnat(x)
    return np.where(missing, np.nan, x.view(np.int64)) if missing.any() else x.view(np.int64)
