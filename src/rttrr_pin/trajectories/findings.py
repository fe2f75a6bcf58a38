"""What is wrong with the rows of a trajectory where it can be read on: one finding for each kind and column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.reporting.results import counted

SENTENCES: Mapping[str, str] = {
    "not finite": "{column} is {value} in {rows}, the first in {place} {first}: left out",
    "repeated time": "the time of the row before is repeated in {rows}, the first in {place} {first}: left out",
    "gap": "{gaps} in time, the longest of {value:.3g} s before {place} {row}, the first before {place} {first}",
    "short part": "{rows} in parts too short to differentiate, the first in {place} {first}: left out",
    "turn": "{column} jumps by a turn before {rows}, the first in {place} {first}: its angle is taken to go on",
    "lower limit": "{column} is below its lower limit in {rows}, the first in {place} {first}, "
    "the least {value:.6g} in {place} {row}",
    "upper limit": "{column} is above its upper limit in {rows}, the first in {place} {first}, "
    "the most {value:.6g} in {place} {row}",
    "rate limit": "{column} is faster than its limit in {rows}, the first in {place} {first}, "
    "the most {value:.6g} in {place} {row}",
    "quaternion": "the quaternion of {column} is not of length 1 in {rows}, the first in {place} {first}, "
    "at worst {value:.9g} in {place} {row}: divided by its length",
    "unknown joint": "{column} is no joint of the robot: left out of {rows}, the first {place} {first}",
    "incomplete": "joints are missing in {rows}, the first in {place} {first}: left out",
    "replaced": "{rows} replaced by a trajectory that begins before, the first in {place} {first}",
}
"""By kind. Where a file can be read on, nothing is repaired in silence."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What is wrong with some rows.

    Attributes:
        kind: a key of `SENTENCES`.
        column: of the file; the joint where it is of several columns.
        count: of rows.
        first: line or row of the first one.
        row: line or row of the worst one.
        value: there.
        sentence: all of it.
    """

    kind: str
    column: str
    count: int
    first: int
    row: int
    value: float
    sentence: str


@dataclass(slots=True)
class _Tally:
    """What was counted so far."""

    count: int
    first: int
    row: int
    value: float
    size: float


class Findings:
    """Findings of one run through a trajectory; as many as kinds and columns, however many rows there are.

    Attributes:
        place: what a row is called in messages: line, row or message.
    """

    def __init__(self, place: str) -> None:
        self.place = place
        self._tallies: dict[tuple[str, str], _Tally] = {}

    def add(self, kind: str, column: str, rows: NDArray[np.int64], values: Array, sizes: Array | None = None) -> None:
        """Some rows more; the worst is the one of the largest size, or of the largest value where none are given."""
        if not len(rows):
            return
        sizes = values if sizes is None else sizes
        worst = int(np.argmax(sizes))
        own = self._tallies.get((kind, column))
        if own is None:
            own = self._tallies[kind, column] = _Tally(0, int(rows[0]), int(rows[0]), float(values[0]), -np.inf)
        own.count += len(rows)
        if sizes[worst] > own.size:
            own.row, own.value, own.size = int(rows[worst]), float(values[worst]), float(sizes[worst])

    def all(self) -> tuple[Finding, ...]:
        """In the order in which they were first seen."""
        return tuple(self._finding(*key, tally) for key, tally in self._tallies.items())

    def _finding(self, kind: str, column: str, own: _Tally) -> Finding:
        sentence = SENTENCES[kind].format(
            column=column,
            rows=counted(own.count, "row"),
            gaps=counted(own.count, "gap"),
            place=self.place,
            first=own.first,
            row=own.row,
            value=own.value,
        )
        return Finding(kind, column, own.count, own.first, own.row, own.value, sentence)
