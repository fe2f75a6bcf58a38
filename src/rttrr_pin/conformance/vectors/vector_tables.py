"""The two tables of a robot's vectors: states, and two doubles that each true value lies between (docs/vectors.md)."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.conformance.levels import Case, ProvenCase
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import split_columns
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import InputError
from rttrr_pin.exact.enclosures import Enclosure, Enclosures
from rttrr_pin.implementations.text_results import column_names, payload_columns

KEYS = ("level", "state")
"""The first columns of both tables."""

HEX, LOWER, UPPER = "hex_", "lower_", "upper_"
"""How the columns of hexadecimal numbers, and those of the ends of enclosures, begin."""

Rows: TypeAlias = list[tuple[str, int]]
"""By row the level and the number of its state."""


def state_columns(model: Model, payload: Sequence[str]) -> list[str]:
    """The names of the numbers of a state; `payload` are the links that payloads act at, in their own axes."""
    names, of_payload = column_names(model), payload_columns(model)
    loads = [name for link in payload for name in of_payload[link, False]]
    return [*names["q"], *names["v"], *names["a"], *loads]


def truth_columns(model: Model) -> list[str]:
    """The names of the true values: tau, then F, N, f, n link by link."""
    names = column_names(model)
    return [name for key in QUANTITIES for name in names[key]]


def states_table(cases: Sequence[Case], payload: Sequence[str]) -> str:
    """The states of all levels of a robot."""
    names = state_columns(cases[0].robot.model, payload)
    numbers = np.vstack([_state_numbers(case, payload) for case in cases])
    return _table([*names, *(HEX + name for name in names)], _rows(cases), numbers, numbers)


def truth_table(cases: Sequence[ProvenCase]) -> str:
    """The ends of the enclosures of all levels of a robot."""
    names = truth_columns(cases[0].robot.model)
    header = [start + name for start in (LOWER, UPPER) for name in names]
    numbers = np.vstack([np.hstack(ends_of(case.enclosures)) for case in cases])
    return _table([*header, *(HEX + name for name in header)], _rows(cases), numbers, numbers)


def ends_of(enclosures: Enclosures) -> tuple[Array, Array]:
    """Lower and upper ends, (N, numbers) each, in the order of `truth_columns`."""
    parts = [part for _, part in enclosures.items()]
    rows = len(parts[0].lower)
    lower, upper = (np.hstack([getattr(x, end).reshape(rows, -1) for x in parts]) for end in ("lower", "upper"))
    return lower, upper


def _rows(cases: Sequence[Case]) -> Rows:
    return [(case.level.id, k) for case in cases for k in range(len(case.batch))]


def _state_numbers(case: Case, payload: Sequence[str]) -> Array:
    """q, v, a and payloads, (N, numbers)."""
    batch = case.batch
    loads = dict.fromkeys(payload, np.zeros((len(batch), 6)))
    for load in batch.loads:
        f, n = (np.broadcast_to(x, (len(batch), 3)) for x in (load.f, load.n))
        loads[batch.model.link_names[load.link]] = np.hstack([f, n])
    return np.hstack([batch.q, batch.v, batch.a, *loads.values()]) + 0.0  # without -0.0


def _table(names: Sequence[str], rows: Rows, decimal: Array, hexadecimal: Array) -> str:
    """A header and a row for each state: the shortest decimals that are read back as the same doubles, then hex."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*KEYS, *names])
    for (level, k), own, other in zip(rows, decimal.tolist(), hexadecimal.tolist(), strict=True):
        writer.writerow([level, k, *map(repr, own), *map(float.hex, other)])
    return text.getvalue()


def read_table(path: Path, names: Sequence[str]) -> tuple[Rows, Array]:
    """The rows of a table and its numbers, (rows, names).

    Raises:
        InputError: it has other columns, a word that is no finite number, or a decimal and a hexadecimal number that
            are not the same.
    """
    try:
        return _read(path, names)
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path} is no table of UTF-8 text: {error}; write it anew") from None


def _read(path: Path, names: Sequence[str]) -> tuple[Rows, Array]:
    expected = [*KEYS, *names, *(HEX + name for name in names)]
    rows: Rows = []
    numbers: list[list[float]] = []
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        header = next(reader, [])
        if header != expected:
            at = next((k for k, pair in enumerate(zip(header, expected, strict=False)) if pair[0] != pair[1]), None)
            got = f"{len(header)} columns" if at is None else f"column {at + 1} is {header[at]!r}"
            wanted = f"{len(expected)}" if at is None else repr(expected[at])
            raise InputError(f"{path}: {got}, expected {wanted}: the table is not of this robot; write it anew")
        for words in reader:
            where = f"{path}, line {reader.line_num}"
            if len(words) != len(expected):
                raise InputError(f"{where} has {len(words)} columns, expected {len(expected)}: write it anew")
            try:
                key = words[0], int(words[1])
                decimal = [float(word) for word in words[2 : 2 + len(names)]]
                exact = [float.fromhex(word) for word in words[2 + len(names) :]]
            except ValueError as error:
                raise InputError(f"{where}: {error}: write the table anew") from None
            for name, x, y in zip(names, decimal, exact, strict=True):
                if not (math.isfinite(x) and x == y):
                    raise InputError(f"{where}: {name} is {x!r} and {HEX}{name} is {y!r}: expected one finite number")
            rows.append(key)
            numbers.append(exact)
    return rows, np.array(numbers, dtype=np.float64).reshape(len(rows), len(names))


def loads_of(model: Model, payload: Sequence[str], numbers: Array) -> tuple[Load, ...]:
    """The payloads of some states from their columns; one that is zero in all of them is none."""
    parts = zip(payload, np.split(numbers, len(payload), axis=1) if payload else (), strict=True)
    return tuple(Load(model.link_index(link), x[:, :3], x[:, 3:]) for link, x in parts if x.any())


def enclosures_of(model: Model, lower: Array, upper: Array, bits: int, tight: bool) -> Enclosures:
    """Enclosures from their ends, (N, numbers) each."""
    low, high = split_columns(model, lower), split_columns(model, upper)
    rows = len(lower)
    return Enclosures(
        **{key: Enclosure(low[key], high[key]) for key in QUANTITIES},
        bits=np.full(rows, bits, dtype=np.int64),
        tight=np.full(rows, tight),
        links=model.link_names,
        joints=model.v_names,
        parameters="read",
    )


def steps(lower: Array, upper: Array) -> NDArray[np.int64]:
    """How many doubles each upper end lies above its lower end; 1 for neighbours."""
    return _ordinal(upper) - _ordinal(lower)


def _ordinal(x: Array) -> NDArray[np.int64]:
    """The number of each double, counted from 0.0; enough for any two of one sign or near zero."""
    bits = np.ascontiguousarray(x + 0.0).view(np.int64)
    return np.where(bits < 0, np.int64(-(2**63)) - bits, bits)


WIDTHS = ("one double", "two neighbours", "three", "more, near zero")


def widths(lower: Array, upper: Array) -> dict[str, int]:
    """How many enclosures are how wide; see docs/vectors.md."""
    apart = np.minimum(steps(lower, upper).astype(np.uint64), 3)  # between ends of both signs it may be beyond 2^63
    return {name: int((apart == k).sum()) for k, name in enumerate(WIDTHS)}
