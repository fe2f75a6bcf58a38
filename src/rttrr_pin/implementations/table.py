"""A table of states and results as an implementation: CSV, Parquet, or JSON lines, with its own states.

Columns are those of docs/notation.md: q_<joint>, v_<joint>, a_<joint>; tau_<joint>; F_<link>_x, ..., n_<link>_z;
payload_f_<link>_x, ..., payload_n_<link>_z.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.inputs import coordinates, finite
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, same_loads
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, InputError, UnknownNameError, listed, shortened
from rttrr_pin.implementations.allowance import of_printed
from rttrr_pin.implementations.protocol import Batch, Evaluation, kernel_of, shape_of
from rttrr_pin.implementations.table_files import READERS, Columns
from rttrr_pin.implementations.text_results import (
    PAYLOAD,
    Digits,
    column_names,
    judged_at,
    number,
    payload_columns,
)

STATE = ("q", "v", "a")


class Table:
    """Results that somebody computed and wrote down.

    Its allowance is the default one, and half a unit in the last place that its numbers were printed to. Where states
    and results were printed alike, to fewer digits than float64 has, the program that wrote them knew the states to
    more digits than the table: what half a unit of each coordinate, and of each number of a payload, changes is then
    allowed too.

    Attributes:
        name: the file's.
        quantities: those that it has columns of.
        digits: the significant digits that it is judged at; None where it was printed to all that float64 has.
        notes: the same as a sentence, and driving forces of which no digit is left; none where all digits are there.
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
        names = _wanted(columns, model, self.name)
        self.quantities = tuple(key for key in QUANTITIES if key in names)
        parsed = {key: _numbers(columns, names[key], lines, self.name) for key in names}
        printed = [parsed[key][1] for key in self.quantities]
        self.digits, self.notes = judged_at(self.name, printed, "it was printed")
        self._halves = {
            key: _half_units(x, digits, printed) if key in STATE else digits.half_units(x)
            for key, (x, digits) in parsed.items()
        }
        self._payloads = _payloads(columns, model, lines, self.name, printed)
        halves = [*(self._halves[key] for key in STATE), *(half for _, half in self._payloads)]
        self._states_rounded = any(half.any() for half in halves)
        self._values = {key: x for key, (x, _) in parsed.items()}
        self.notes += self._without_digits()
        if self._halves["q"].any():
            _normalise(model, self._values["q"], self._halves["q"])
        try:
            self._values |= {key: coordinates(key, self._values[key], model.moving) for key in STATE}
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from error

    def _without_digits(self) -> tuple[str, ...]:
        """Which driving forces are nowhere larger than what printing left out, so that any small ones would agree."""
        if "tau" not in self.quantities:
            return ()
        x, halves = np.abs(self._values["tau"]), self._halves["tau"]
        empty = np.all((halves > 0.0) & (x <= halves), axis=0)
        names = [name for name, own in zip(self.model.v_names, empty.tolist(), strict=True) if own]
        limit = halves[:, empty].max(initial=0.0)
        return (f"tau of {listed(names)} is nowhere printed as more than {limit:.3g}: no more is judged",) * bool(names)

    def states(self) -> Batch:
        """The states of the table, in the order of its rows, with the payloads that it has columns of.

        A payload that is zero in all rows is none.
        """
        loads = tuple(load for load, _ in self._payloads)
        return Batch(self.model, self._values["q"], self._values["v"], self._values["a"], loads)

    def evaluate(self, batch: Batch) -> Evaluation:
        """The rows of these states.

        Raises:
            ImplementationError: they are not the table's.
        """
        part = slice(batch.first, batch.first + len(batch))
        same = all(np.array_equal(self._values[key][part], getattr(batch, key)) for key in STATE)
        loads = [load.block(part) for load, _ in self._payloads]
        if not same or (loads and not same_loads(loads, batch.loads)):
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
        """What half a unit in the last place of each number that was given to the program changes, all added up."""
        kernel = kernel_of(self.model, self.quantities)
        here = kernel(batch.q, batch.v, batch.a, payload=list(batch.loads) or None)
        total = {key: np.zeros(x.shape if key == "tau" else x.shape[:-1]) for key, x in here.items()}
        for state, loads in self._moved(batch, part):
            for name, x in kernel(state["q"], state["v"], state["a"], payload=loads or None).items():
                total[name] += np.abs(x - here[name]) if name == "tau" else norm(x - here[name])
        return total

    def _moved(self, batch: Batch, part: slice) -> Iterator[tuple[dict[str, Array], list[Load]]]:
        """The states and their payloads, of which one number is half a unit larger; one after the other."""
        state, loads = {key: getattr(batch, key) for key in STATE}, list(batch.loads)
        for key in STATE:
            for k, half in enumerate(self._halves[key][part].T):
                if not half.any():
                    continue
                moved = state[key].copy()
                moved[:, k] += half
                if key == "q":
                    _normalise(self.model, moved, self._halves["q"][part])
                yield state | {key: moved}, loads
        for i, (_, halves) in enumerate(self._payloads):
            load = loads[i]
            for k, half in enumerate(halves[part].T):
                if not half.any():
                    continue
                moved = np.hstack([load.f, load.n])
                moved[:, k] += half
                other = replace(load, f=moved[:, :3], n=moved[:, 3:])
                yield state, [*loads[:i], other, *loads[i + 1 :]]


def _normalise(model: Model, q: Array, half: Array) -> None:
    """Make quaternions that are of length 1 to their digits so to all digits, in place."""
    for first in model.quaternions:
        part = slice(first, first + 4)
        length = norm(q[:, part])
        close = np.abs(length - 1.0) <= 2 * half[:, part].sum(axis=1)
        q[close, part] /= length[close, None]


def _half_units(x: Array, digits: Digits, printed: Sequence[Digits]) -> Array:
    """Half a unit of the last place of numbers of a state: 0 where they were not rounded as results were, but round.

    Accelerations of 1, 0.5 and -1 beside results of six digits are these numbers, and not some between 0.5 and 1.5.
    """
    rounded = not all(own.full for own in printed) and _alike(digits, printed)
    return digits.half_units(x) if rounded else np.zeros_like(x)


def _alike(digits: Digits, printed: Sequence[Digits]) -> bool:
    """Whether the numbers of a state were printed as results were, with as many digits or as many decimals."""
    # States are printed in other units than results, so that a fixed count of decimals is alike too.
    result = min(printed, key=lambda own: own.significant)
    return digits.significant >= result.significant or digits.decimals >= max(result.decimals, 1)


def _wanted(columns: Columns, model: Model, name: str) -> dict[str, list[str]]:
    """The columns of each array that the table has; an error if one is there in part, or of another robot."""
    known = column_names(model)
    check_names(columns, model, name)
    wanted = {key: names for key, names in known.items() if key in STATE or any(c in columns for c in names)}
    check_complete(columns, [column for names in wanted.values() for column in names], name)
    if not any(key in QUANTITIES for key in wanted):
        raise InputError(f"{name} has no column of results: add {', '.join(known['tau'][:3])}, ... or F_<link>_x, ...")
    return wanted


def check_names(columns: Columns, model: Model, name: str) -> None:
    """Columns that begin like those of docs/notation.md are of a joint or link of the robot.

    Raises:
        UnknownNameError: one is of another.
    """
    known: dict[str, list[str]] = column_names(model)
    known[PAYLOAD] = [c for (_, in_base), names in payload_columns(model).items() if not in_base for c in names]
    hidden = {c for (_, in_base), names in payload_columns(model).items() if in_base for c in names}
    every = dict.fromkeys(column for names in known.values() for column in names)
    for column in columns:
        if column in every or column in hidden:
            continue
        if column.partition("_")[0] in known and "_" in column:
            blanks = "separate columns by commas, semicolons or tabs, " if len(columns) == 1 else ""
            raise UnknownNameError("column", shortened(column), every, f"{blanks}in {name}")


def check_complete(columns: Columns, names: Sequence[str], table: str) -> None:
    """All of these columns are there.

    Raises:
        InputError: some are missing.
    """
    missing = [column for column in names if column not in columns]
    if missing:
        raise InputError(f"{table} lacks the columns {listed(missing, 8)}: see docs/notation.md")


def _payloads(
    columns: Columns, model: Model, lines: Sequence[int], name: str, printed: Sequence[Digits]
) -> list[tuple[Load, Array]]:
    """The payloads that are not zero in all rows, each with half units of its numbers (N, 6)."""
    payloads = []
    for (link, in_base), names in payload_columns(model).items():
        if not any(column in columns for column in names):
            continue
        check_complete(columns, names, name)
        x, digits = _numbers(columns, names, lines, name)
        try:
            for column, values in zip(names, x.T, strict=True):
                finite(column, values)
        except InputError as error:
            raise InputError(f"{name}: {error}") from error
        if x.any():
            load = Load(model.link_index(link), x[:, :3], x[:, 3:], in_base)
            payloads.append((load, _half_units(x, digits, printed)))
    return payloads


def numbers_of_columns(columns: Columns, names: Sequence[str], lines: Sequence[int], name: str) -> Array:
    """The numbers of some columns of a table of that name, (rows, columns).

    Raises:
        InputError: one is no number.
    """
    parts = [np.zeros((len(lines), 0))]
    for column in names:
        texts = columns[column]
        if isinstance(texts, np.ndarray):
            parts.append(_binary(texts, column, name)[:, None])
        else:
            parts.append(_parsed(texts, column, lines, name)[:, None])
    return np.concatenate(parts, axis=1)


def _numbers(columns: Columns, names: Sequence[str], lines: Sequence[int], name: str) -> tuple[Array, Digits]:
    """One array of a state or result, and the digits that it was printed with."""
    printed = (_digits(columns[column]) for column in names)
    return numbers_of_columns(columns, names, lines, name), reduce(Digits.with_all, printed, Digits())


def _digits(texts: Sequence[str] | np.ndarray[Any, Any]) -> Digits:
    """Those that a column was printed with, or that its type holds."""
    if not isinstance(texts, np.ndarray):
        return Digits.of(texts)
    single = texts.dtype.kind == "f" and texts.dtype.itemsize < 8
    return Digits(int(np.finfo(texts.dtype).precision) if single else 17, 400)


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


def _binary(values: np.ndarray[Any, Any], column: str, name: str) -> Array:
    """A column of a binary file."""
    if values.dtype.kind not in "iuf":
        raise InputError(f"{name}, column {column}: {values.dtype} is no type of real numbers: write it as float64")
    return values.astype(np.float64)
