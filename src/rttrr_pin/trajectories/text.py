"""Trajectories that are text: CSV and JSON lines, some lines at a time."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.table import numbers_of_columns
from rttrr_pin.implementations.table_files import cells_of, header_of, lines_of, objects_of
from rttrr_pin.trajectories.clock import counted_from, origin_of
from rttrr_pin.trajectories.columns import Columns, columns_of_file
from rttrr_pin.trajectories.rows import LINES_AT_ONCE, Rows, Source

WHOLE = re.compile(r"([+-]?\d{1,30})(?:\.(\d{0,30}))?")
"""A number whose digits before and behind the point are kept apart: together they may be more than float64 has."""


def csv_source(path: Path, model: Model, more: Sequence[str] = ()) -> Source:
    """A file with a header.

    Raises:
        InputError, UnknownNameError: a column is missing or unknown.
    """
    lines = lines_of(path)
    header, separator = header_of(path.name, lines)
    columns = columns_of_file(header, model, path.name, more)
    first = next(lines, None)
    if first is None:
        raise InputError(f"{path.name} has a header and no row: add one for each time")
    cells = dict(zip(header, cells_of(path.name, *first, header, separator), strict=True))
    origin = _origin(cells[columns.time])

    def read() -> Iterator[Rows]:
        lines = lines_of(path)
        next(lines)
        while chunk := list(islice(lines, LINES_AT_ONCE)):
            table = _fast(chunk, header, separator, columns)
            if table is None:
                table = _slow(path.name, chunk, header, separator, columns)
            yield _rows([number for number, _ in chunk], *table, columns, origin, path.name)

    return _source(path, columns, origin, read)


def json_source(path: Path, model: Model, more: Sequence[str] = ()) -> Source:
    """One object a line: time, q, and with or without v, a and payload.

    Raises:
        InputError, UnknownNameError: a line is no such object.
    """
    first = next(objects_of(path, model), None)
    if first is None:
        raise InputError(f"{path.name} is empty: expected an object for each time")
    columns = columns_of_file(list(first[1]), model, path.name, more)
    origin = _origin(first[1][columns.time])

    def read() -> Iterator[Rows]:
        entries = objects_of(path, model)
        while chunk := list(islice(entries, LINES_AT_ONCE)):
            numbers = [number for number, _ in chunk]
            texts = {name: [row[name] for _, row in chunk] for name in columns.wanted}
            numeric = numbers_of_columns(texts, columns.wanted[1:], numbers, path.name)
            yield _rows(numbers, texts[columns.time], numeric, columns, origin, path.name)

    return _source(path, columns, origin, read)


def _source(path: Path, columns: Columns, origin: int, read: Callable[[], Iterator[Rows]]) -> Source:
    return Source(
        path.name,
        lambda findings: read(),
        columns.labels,
        columns.loads,
        "line",
        columns.unit,
        counted_from(origin),
        None,
        columns.notes,
    )


def _fast(
    lines: list[tuple[int, str]], header: Sequence[str], separator: str, columns: Columns
) -> tuple[list[str], Array] | None:
    """The texts of time, and the numbers of the other columns; None where a cell is quoted, or anything is wrong."""
    commas, at = len(header) - 1, [header.index(name) for name in columns.wanted]
    texts = [line for _, line in lines]
    if any(line.count(separator) != commas or '"' in line for line in texts):
        return None
    try:
        x = np.loadtxt(texts, np.float64, comments=None, delimiter=separator, usecols=at[1:], ndmin=2)
    except ValueError:
        return None
    times = [line.split(separator, at[0] + 1)[at[0]].strip() for line in texts]
    return (times, x) if len(x) == len(lines) else None


def _slow(
    name: str, lines: list[tuple[int, str]], header: Sequence[str], separator: str, columns: Columns
) -> tuple[list[str], Array]:
    """The same, or an error that says where."""
    cells = [cells_of(name, number, line, header, separator) for number, line in lines]
    texts = dict(zip(header, map(list, zip(*cells, strict=True)), strict=True))
    numbers = [number for number, _ in lines]
    return texts[columns.time], numbers_of_columns(texts, columns.wanted[1:], numbers, name)


def _rows(numbers: list[int], times: list[str], x: Array, columns: Columns, origin: int, name: str) -> Rows:
    ends = np.cumsum([len(own) for own in columns.labels.values()])[:-1]
    parts = np.split(x, ends, axis=1)
    try:
        t = [_time(text, origin) for text in times]
    except ValueError:
        t = numbers_of_columns({columns.time: times}, [columns.time], numbers, name)[:, 0].tolist()
    return Rows(np.array(numbers, np.int64), np.array(t), dict(zip(columns.labels, parts, strict=True)))


def _time(text: str, origin: int) -> float:
    if not origin:
        return float(text) if "_" not in text else math.nan
    match = WHOLE.fullmatch(text)
    if match is None:
        return float(text) - origin
    whole, fraction = match[1], match[2]
    return int(whole) - origin + float(f"{'-' if whole[0] == '-' else ''}0.{fraction or 0}")


def _origin(text: str) -> int:
    match = WHOLE.fullmatch(text)
    try:
        return int(match[1]) if match and origin_of(int(match[1])) else origin_of(float(text))
    except (ValueError, OverflowError):
        return 0
