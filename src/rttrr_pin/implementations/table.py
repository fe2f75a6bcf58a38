"""A table of states and results as an implementation: CSV, Parquet, or JSON lines, with its own states.

Columns are those of docs/notation.md: q_<joint>, v_<joint>, a_<joint>; tau_<joint>; F_<link>_x, ..., n_<link>_z.
"""

from __future__ import annotations

import csv
import io
import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.inputs import coordinates
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, InputError, RttrrError, UnknownNameError, shortened
from rttrr_pin.implementations.allowance import of_printed
from rttrr_pin.implementations.protocol import Batch, Evaluation, kernel_of, shape_of
from rttrr_pin.implementations.text_results import (
    Digits,
    column_names,
    columns_of,
    flattened,
    json_of,
    judged_at,
    number,
)
from rttrr_pin.urdf.files import read_limited

STATE = ("q", "v", "a")

LONGEST_LINE, LARGEST_PIPE = 4_000_000, 2**26
"""Characters, more than thousands of links need; and bytes of what is no file and may have no end."""

Texts: TypeAlias = dict[str, list[str]]
"""By column, one text for each row."""

Columns: TypeAlias = Mapping[str, "list[str] | np.ndarray[Any, Any]"]
"""By column, texts, or numbers of a binary file."""


class Table:
    """Results that somebody computed and wrote down.

    Its allowance is the default one, and half a unit in the last place that its numbers were printed to. Where states
    and results were printed alike, to fewer digits than float64 has, the program that wrote them knew the states to
    more digits than the table: what half a unit of each coordinate changes is then allowed too.

    Attributes:
        name: the file's.
        quantities: those that it has columns of.
        digits: the significant digits that it is judged at; None where it was printed to all that float64 has.
        notes: the same as a sentence; none where all digits are there.
    """

    version = ""

    def __init__(self, path: Path, model: Model) -> None:
        """Read the file.

        Raises:
            InputError: it cannot be read, or a column, a row or a number cannot be used.
            UnknownNameError: a column is of a joint or link that the robot has not.
            ImplementationError: Parquet, and pyarrow is not installed.
        """
        self.name, self.model = path.name, model
        columns, lines = READERS[path.suffix.lower()](path, model)
        names = _wanted(columns, column_names(model), self.name)
        self.quantities = tuple(key for key in QUANTITIES if key in names)
        parsed = {key: _numbers(columns, names[key], lines, self.name) for key in names}
        printed = [parsed[key][1] for key in self.quantities]
        self.digits, self.notes = judged_at(self.name, printed, "it was printed")
        self._halves = {key: digits.half_units(x) for key, (x, digits) in parsed.items()}
        self._states_rounded = self.digits is not None and any(_alike(parsed[key][1], printed) for key in STATE)
        self._values = {key: x for key, (x, _) in parsed.items()}
        if self._states_rounded:
            _normalise(model, self._values["q"], self._halves["q"])
        try:
            self._values |= {key: coordinates(key, self._values[key], model.moving) for key in STATE}
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from error

    def states(self) -> Batch:
        """The states of the table, in the order of its rows."""
        return Batch(self.model, self._values["q"], self._values["v"], self._values["a"])

    def evaluate(self, batch: Batch) -> Evaluation:
        """The rows of these states.

        Raises:
            ImplementationError: they are not the table's.
        """
        part = slice(batch.first, batch.first + len(batch))
        if not all(np.array_equal(self._values[key][part], getattr(batch, key)) for key in STATE):
            raise ImplementationError(
                f"{self.name} has results at its own states and no others: a search needs a function or a program"
            )
        values, halves = (
            {key: x[key][part].reshape(len(batch), *shape_of(self.model, key)) for key in self.quantities}
            for x in (self._values, self._halves)
        )
        allowance = of_printed(batch, halves)
        if self._states_rounded:
            shifts = self._of_rounded_states(batch, part)
            allowance = {key: x + shifts[key] for key, x in allowance.items()}
        return Evaluation(values, allowance)

    def _of_rounded_states(self, batch: Batch, part: slice) -> dict[str, Array]:
        """What half a unit in the last place of each coordinate, rate and acceleration changes, all added up."""
        kernel = kernel_of(self.model, self.quantities)
        loads = list(batch.loads) or None
        state = {key: getattr(batch, key) for key in STATE}
        here = kernel(batch.q, batch.v, batch.a, payload=loads)
        total = {key: np.zeros(x.shape if key == "tau" else x.shape[:-1]) for key, x in here.items()}
        for key in STATE:
            for k, half in enumerate(self._halves[key][part].T):
                moved = state[key].copy()
                moved[:, k] += half
                if key == "q":
                    _normalise(self.model, moved, self._halves["q"][part])
                there = kernel(**(state | {key: moved}), payload=loads)
                for name, x in there.items():
                    total[name] += np.abs(x - here[name]) if name == "tau" else norm(x - here[name])
        return total


def _normalise(model: Model, q: Array, half: Array) -> None:
    """Make quaternions that are of length 1 to their digits so to all digits, in place."""
    for first in model.quaternions:
        part = slice(first, first + 4)
        length = norm(q[:, part])
        close = np.abs(length - 1.0) <= 2 * half[:, part].sum(axis=1)
        q[close, part] /= length[close, None]


def _alike(digits: Digits, printed: Sequence[Digits]) -> bool:
    """Whether the numbers of a state were printed as results were, with as many digits or as many decimals."""
    # States are printed in other units than results, so that a fixed count of decimals is alike too.
    result = min(printed, key=lambda own: own.significant)
    return digits.significant >= result.significant or digits.decimals >= max(result.decimals, 1)


def _wanted(columns: Columns, known: Mapping[str, list[str]], name: str) -> dict[str, list[str]]:
    """The columns of each array that the table has; an error if one is there in part, or of another robot."""
    every = dict.fromkeys(column for names in known.values() for column in names)
    for column in columns:
        if column not in every and column.partition("_")[0] in known and "_" in column:
            blanks = "separate columns by commas, semicolons or tabs, " if len(columns) == 1 else ""
            raise UnknownNameError("column", shortened(column), every, f"{blanks}in {name}")
    wanted = {key: names for key, names in known.items() if key in STATE or any(c in columns for c in names)}
    missing = [column for names in wanted.values() for column in names if column not in columns]
    if missing:
        more = f" and {len(missing) - 8} more" if len(missing) > 8 else ""
        raise InputError(f"{name} lacks the columns {', '.join(missing[:8])}{more}: see docs/notation.md")
    if not any(key in QUANTITIES for key in wanted):
        raise InputError(f"{name} has no column of results: add {', '.join(known['tau'][:3])}, ... or F_<link>_x, ...")
    return wanted


def _numbers(columns: Columns, names: Sequence[str], lines: Sequence[int], name: str) -> tuple[Array, Digits]:
    """One array of a state or result, and the digits that it was printed with."""
    digits, parts = Digits(), [np.zeros((len(lines), 0))]
    for column in names:
        texts = columns[column]
        if isinstance(texts, np.ndarray):
            values, of_column = _binary(texts, column, name)
        else:
            values, of_column = _parsed(texts, column, lines, name), Digits.of(texts)
        digits = digits.with_all(of_column)
        parts.append(values[:, None])
    return np.concatenate(parts, axis=1), digits


def _parsed(texts: Sequence[str], column: str, lines: Sequence[int], name: str) -> Array:
    values: list[float] = []
    try:
        values.extend(map(number, texts))
    except ValueError:
        text, line = texts[len(values)], lines[len(values)]
        fix = "write a point for the comma" if "," in text else "expected one such as -1.5e-3, or NaN"
        where = f"{name}, line {line}, column {column}"
        raise InputError(f"{where}: {shortened(repr(text))} is no number: {fix}") from None
    return np.array(values)


def _binary(values: np.ndarray[Any, Any], column: str, name: str) -> tuple[Array, Digits]:
    """A column of a binary file, and the digits that its type holds."""
    if values.dtype.kind not in "iuf":
        raise InputError(f"{name}, column {column}: {values.dtype} is no type of real numbers: write it as float64")
    single = values.dtype.kind == "f" and values.dtype.itemsize < 8
    digits = Digits(int(np.finfo(values.dtype).precision), 400) if single else Digits(17, 400)
    return values.astype(np.float64), digits


def _csv(path: Path, model: Model) -> tuple[Texts, list[int]]:
    """A header and rows, separated by commas, semicolons or tabs; NumPy writes `# ` before the header."""
    lines = _lines_of(path)
    first = next(lines, None)
    if first is None:
        raise InputError(f"{path.name} is empty: expected a header and a row for each state")
    separator = max(",;\t", key=first[1].count)
    header = _split(path.name, *first, separator)
    header[0] = header[0].removeprefix("#").strip()
    column, count = Counter(header).most_common(1)[0]
    if count > 1:
        raise InputError(f"{path.name} has the column {shortened(repr(column))} {count} times: name it once")
    cells, numbers = [], []
    for line_number, line in lines:
        row = _split(path.name, line_number, line, separator)
        if len(row) != len(header):
            raise InputError(f"{path.name}, line {line_number}: {len(row)} cells, and the header has {len(header)}")
        cells.append(row)
        numbers.append(line_number)
    if not cells:
        raise InputError(f"{path.name} has a header and no row: add one for each state")
    return dict(zip(header, map(list, zip(*cells, strict=True)), strict=True)), numbers


def _split(name: str, line_number: int, line: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    except csv.Error as error:
        raise InputError(f"{name}, line {line_number}: {error}") from error


def _json_lines(path: Path, model: Model) -> tuple[Texts, list[int]]:
    """One object a line, with the request and the reply of a program in it (docs/notation.md)."""
    names, by_name = column_names(model), columns_of(model)
    columns: Texts = {}
    numbers: list[int] = []
    for line_number, line in _lines_of(path):
        where = f"{path.name}, line {line_number}"
        try:
            entry = json_of(line)
            row: dict[str, str] = {}
            for key in names.keys() & (entry if isinstance(entry, dict) else ()):
                row |= zip(names[key], flattened(entry[key], by_name[key], f"{where}, {key}"), strict=True)
        except ValueError as error:
            raise InputError(f"{where}: {error}") from error
        except RttrrError as error:
            raise InputError(str(error)) from error
        if numbers and row.keys() != columns.keys():
            raise InputError(f"{where}: other quantities than in the lines before: write the same in all")
        for column, text in row.items():
            columns.setdefault(column, []).append(text)
        numbers.append(line_number)
        if not row:
            break  # no line has columns, and what is missing is said at once
    if not numbers:
        raise InputError(f"{path.name} is empty: expected an object for each state")
    return columns, numbers


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


def _lines_of(path: Path) -> Iterator[tuple[int, str]]:
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
