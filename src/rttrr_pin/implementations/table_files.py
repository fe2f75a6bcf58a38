"""Files of columns: CSV, Parquet, or JSON lines, as columns of texts or numbers with the lines they stand in."""

from __future__ import annotations

import csv
import io
import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, InputError, RttrrError, shortened
from rttrr_pin.implementations.text_results import (
    PAYLOAD,
    TIMES,
    column_names,
    columns_of,
    flattened,
    flattened_payload,
    json_of,
)
from rttrr_pin.urdf.files import read_limited

LONGEST_LINE, LARGEST_PIPE = 4_000_000, 2**26
"""Characters, more than thousands of links need; and bytes of what is no file and may have no end."""

Texts: TypeAlias = dict[str, list[str]]
"""By column, one text for each row."""

Columns: TypeAlias = Mapping[str, "list[str] | np.ndarray[Any, Any]"]
"""By column, texts, or numbers of a binary file."""


def _csv(path: Path, model: Model) -> tuple[Texts, list[int]]:
    """A header and rows, separated by commas, semicolons or tabs."""
    lines = lines_of(path)
    header, separator = header_of(path.name, lines)
    cells, numbers = [], []
    for line_number, line in lines:
        cells.append(cells_of(path.name, line_number, line, header, separator))
        numbers.append(line_number)
    if not cells:
        raise InputError(f"{path.name} has a header and no row: add one for each state")
    return dict(zip(header, map(list, zip(*cells, strict=True)), strict=True)), numbers


def header_of(name: str, lines: Iterator[tuple[int, str]]) -> tuple[list[str], str]:
    """The columns that the first line names, and what separates them; NumPy writes `# ` before it.

    Raises:
        InputError: there is none, or it names a column twice.
    """
    first = next(lines, None)
    if first is None:
        raise InputError(f"{name} is empty: expected a header and a row for each state")
    separator = max(",;\t", key=first[1].count)
    header = _split(name, *first, separator)
    header[0] = header[0].removeprefix("#").strip()
    column, count = Counter(header).most_common(1)[0]
    if count > 1:
        raise InputError(f"{name} has the column {shortened(repr(column))} {count} times: name it once")
    return header, separator


def cells_of(name: str, line_number: int, line: str, header: Sequence[str], separator: str) -> list[str]:
    """One row, as long as the header.

    Raises:
        InputError: it is not.
    """
    row = _split(name, line_number, line, separator)
    if len(row) != len(header):
        raise InputError(f"{name}, line {line_number}: {len(row)} cells, and the header has {len(header)}")
    return row


def _split(name: str, line_number: int, line: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    except csv.Error as error:
        raise InputError(f"{name}, line {line_number}: {error}") from error


def _json_lines(path: Path, model: Model) -> tuple[Texts, list[int]]:
    """One object a line, with the request and the reply of a program in it (docs/notation.md)."""
    columns: Texts = {}
    numbers: list[int] = []
    for line_number, row in objects_of(path, model):
        for column, text in row.items():
            columns.setdefault(column, []).append(text)
        numbers.append(line_number)
        if not row:
            break  # no line has columns, and what is missing is said at once
    if not numbers:
        raise InputError(f"{path.name} is empty: expected an object for each state")
    return columns, numbers


def objects_of(path: Path, model: Model) -> Iterator[tuple[int, dict[str, str]]]:
    """The objects of a file of JSON lines, as texts by the columns of docs/notation.md; all have the same.

    Raises:
        InputError: a line is no such object.
    """
    names, by_name = column_names(model), columns_of(model)
    first: dict[str, str] | None = None
    for line_number, line in lines_of(path):
        where = f"{path.name}, line {line_number}"
        try:
            entry = json_of(line)
            row: dict[str, str] = {}
            keys = entry.keys() if isinstance(entry, dict) else set()
            for key in names.keys() & keys:
                row |= zip(names[key], flattened(entry[key], by_name[key], f"{where}, {key}"), strict=True)
            if PAYLOAD in keys:
                row |= flattened_payload(entry[PAYLOAD], model, f"{where}, {PAYLOAD}")
            row |= {key: str(entry[key]) for key in TIMES if key in keys}
        except ValueError as error:
            raise InputError(f"{where}: {error}") from error
        except RttrrError as error:
            raise InputError(str(error)) from error
        first = row if first is None else first
        if row.keys() != first.keys():
            raise InputError(f"{where}: other quantities than in the lines before: write the same in all")
        yield line_number, row


def _parquet(path: Path, model: Model) -> tuple[Columns, list[int]]:
    """A file of columns, with the types of its numbers."""
    if path.exists() and not path.is_file():
        raise InputError(f"{path} is no file: Parquet cannot be read from a folder, a pipe or a device")
    try:
        from pyarrow import parquet
    except ImportError as error:
        raise ImplementationError(
            "a Parquet table needs pyarrow, which is not installed: pip install 'rttrr-pin[parquet]'"
        ) from error
    try:
        table = parquet.read_table(path)
    except (OSError, ValueError) as error:  # pyarrow's own errors are of these two
        raise InputError(f"{path.name} cannot be read as Parquet: {error}") from error
    columns = {name: table.column(name).to_numpy() for name in table.column_names}
    return columns, list(range(1, table.num_rows + 1))


def lines_of(path: Path) -> Iterator[tuple[int, str]]:
    """The lines that are not blank, with their numbers."""
    try:
        raw = path.open("rb") if path.is_file() else io.BytesIO(read_limited(path, LARGEST_PIPE))
        with io.TextIOWrapper(raw, encoding="utf-8-sig") as file:
            for count in itertools.count(1):
                line = file.readline(LONGEST_LINE + 1)
                if not line:
                    return
                if len(line) > LONGEST_LINE:
                    raise InputError(f"line {count}: it has more than {LONGEST_LINE:,} characters")
                if line.strip():
                    yield count, line
    except InputError as error:
        raise InputError(f"{path} cannot be read: {error}") from error
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no UTF-8 text: {error.reason} at byte {error.start}; save it as UTF-8") from error


READERS = {".csv": _csv, ".jsonl": _json_lines, ".parquet": _parquet}
"""By the end of the file's name."""
