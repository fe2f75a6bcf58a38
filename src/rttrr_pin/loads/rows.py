"""The rows of a trajectory in blocks of one size, each row with the time that it stands for.

However a trajectory cuts itself into blocks, sums over them are made of the same terms in the same order.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load

if TYPE_CHECKING:
    from rttrr_pin.trajectories import Block

SIZE = 16_384
"""Rows of a block."""

Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Consecutive rows.

    Attributes:
        start: index of the first one.
        rows: as messages name them, (N,).
        time: (N,) [s].
        q: (N, nq).
        v: (N, nv).
        a: (N, nv).
        payload: what the robot exerts on its surroundings.
        errors: as in `Block`; None where all was measured.
        weights: the time that each row stands for by the trapezoidal rule, (N,) [s].
    """

    start: int
    rows: NDArray[np.int64]
    time: Array
    q: Array
    v: Array
    a: Array
    payload: tuple[Load, ...] = ()
    errors: Array | None = None
    weights: Array | None = None

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, part: slice) -> Rows:
        """Some of the rows, whose weights are not known."""
        return Rows(
            self.start + (part.start or 0),
            self.rows[part],
            *(x[part] for x in (self.time, self.q, self.v, self.a)),
            tuple(load.block(part) for load in self.payload),
            None if self.errors is None else self.errors[part],
        )


def weighted(blocks: Iterable[Block], payload: Sequence[Load], size: int = SIZE) -> Iterator[Rows]:
    """Blocks of one size, but for the last, with weights: half the time between the rows before and behind each.

    Args:
        blocks: of a trajectory, of any sizes.
        payload: what the robot exerts beside what the blocks say.
        size: rows in each.
    """
    before: float | None = None
    last: Rows | None = None
    for rows in _aligned((_rows(block, payload) for block in blocks), size):
        if last is not None:
            yield _with_weights(last, before, float(rows.time[0]))
            before = float(last.time[-1])
        last = rows
    if last is not None:
        yield _with_weights(last, before, None)


def _rows(block: Block, payload: Sequence[Load]) -> Rows:
    parts = (block.start, block.rows, block.time, block.q, block.v, block.a)
    return Rows(*parts, (*payload, *block.payload), block.errors)


def _aligned(blocks: Iterable[Rows], size: int) -> Iterator[Rows]:
    waiting: list[Rows] = []
    count = 0
    for block in blocks:
        waiting.append(block)
        count += len(block)
        if count < size:
            continue
        whole = joined(waiting)
        whole_blocks = count // size * size
        for start in range(0, whole_blocks, size):
            yield whole[start : start + size]
        waiting = [whole[whole_blocks:]] if count > whole_blocks else []
        count -= whole_blocks
    if count:
        yield joined(waiting)


def joined(parts: Sequence[Rows]) -> Rows:
    """Rows behind each other, as one block."""
    if len(parts) == 1:
        return parts[0]
    first = parts[0]
    errors = None if first.errors is None else np.concatenate([own.errors for own in parts if own.errors is not None])
    columns = ([getattr(own, name) for own in parts] for name in ("q", "v", "a"))
    return Rows(
        first.start,
        np.concatenate([own.rows for own in parts]),
        np.concatenate([own.time for own in parts]),
        *(_by_columns(x) for x in columns),
        tuple(_joined_loads([own.payload[k] for own in parts]) for k in range(len(first.payload))),
        errors,
    )


def _by_columns(parts: Sequence[Array]) -> Array:
    """Arrays behind each other, each number of consecutive rows side by side."""
    return np.concatenate([x.T for x in parts], axis=1).T


def _joined_loads(loads: Sequence[Load]) -> Load:
    f, n = (_joined_vectors([getattr(load, name) for load in loads]) for name in ("f", "n"))
    return replace(loads[0], f=f, n=n)


def _joined_vectors(parts: Sequence[Array]) -> Array:
    return parts[0] if parts[0].ndim == 1 else np.concatenate(parts)


def _with_weights(rows: Rows, before: float | None, behind: float | None) -> Rows:
    """Trapezoids; a single row stands for itself, with a weight of 1 that says nothing of time."""
    if len(rows) == 1 and before is None and behind is None:
        return replace(rows, weights=np.ones(1))
    first, last = rows.time[0], rows.time[-1]
    times = np.concatenate([[first if before is None else before], rows.time, [last if behind is None else behind]])
    return replace(rows, weights=(times[2:] - times[:-2]) / 2)
