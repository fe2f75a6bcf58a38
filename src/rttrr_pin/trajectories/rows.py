"""Rows as a file has them, some at a time, and where they come from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.trajectories.findings import Findings

AT_ONCE = 65536
"""Rows that are read at a time, where they are numbers; it changes no number."""

LINES_AT_ONCE = 8192
"""Rows of text that are read at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Consecutive rows.

    Attributes:
        numbers: line or row of each, as a message names it, (N,).
        time: in the source's unit and from its origin, (N,).
        values: by q, v, a and whatever else is read, (N, columns).
    """

    numbers: NDArray[np.int64]
    time: Array
    values: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.time)

    def part(self, which: slice | NDArray[np.bool_]) -> Rows:
        """Some of them."""
        return Rows(self.numbers[which], self.time[which], {key: x[which] for key, x in self.values.items()})

    @staticmethod
    def joined(parts: list[Rows]) -> Rows:
        """One after the other, at least one."""
        if len(parts) == 1:
            return parts[0]
        keys = parts[0].values.keys()
        return Rows(
            np.concatenate([own.numbers for own in parts]),
            np.concatenate([own.time for own in parts]),
            {key: np.concatenate([own.values[key] for own in parts]) for key in keys},
        )


Reader: TypeAlias = Callable[[Findings], Iterator[Rows]]


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """Where rows come from.

    Attributes:
        name: as messages call it.
        read: the rows from the first on, each time it is called.
        labels: by q, v, a, payload, and whatever else is read: what each column is called in the file.
        loads: the link of each payload, and whether it is in base axes; six columns of `payload` for each.
        place: what a row is called in messages.
        unit: of time [s]; None where nobody says.
        origin: what time counts from, in words; empty where it is as the file has it.
        n_rows: None where nobody knows before it was read.
        notes: what a reader must know.
    """

    name: str
    read: Reader
    labels: Mapping[str, tuple[str, ...]]
    loads: tuple[tuple[int, bool], ...] = ()
    place: str = "row"
    unit: float | None = None
    origin: str = ""
    n_rows: int | None = None
    notes: tuple[str, ...] = ()

    def has(self, key: str) -> bool:
        """Whether it has these columns."""
        return key in self.labels


def numbered(first: int, count: int) -> NDArray[np.int64]:
    """Rows that follow each other."""
    return np.arange(first, first + count, dtype=np.int64)


def documented(model: Model) -> dict[str, tuple[str, ...]]:
    """The columns of docs/notation.md."""
    return {
        "q": tuple(f"q_{name}" for name in model.q_names),
        "v": tuple(f"v_{name}" for name in model.v_names),
        "a": tuple(f"a_{name}" for name in model.v_names),
    }
