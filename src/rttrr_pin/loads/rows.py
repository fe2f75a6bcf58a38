"""The rows of a trajectory in blocks of one size, each row with the time that it stands for.

However a trajectory cuts itself into blocks, sums over them are made of the same terms in the same order.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.trajectories import Block

SIZE = 16_384
"""Rows of a block."""


def weighted(blocks: Iterable[Block], size: int = SIZE) -> Iterator[tuple[Block, Array]]:
    """Blocks of one size, but for the last, and the time that each row stands for, (N,) [s].

    By the trapezoidal rule that is half the time between the rows before and behind it. A trajectory of one row has a
    weight of 1, so that means are what they are means of.
    """
    before: float | None = None
    last: Block | None = None
    for block in _aligned(blocks, size):
        if last is not None:
            yield last, _weights(last, before, float(block.time[0]))
            before = float(last.time[-1])
        last = block
    if last is not None:
        yield last, _weights(last, before, None)


def _aligned(blocks: Iterable[Block], size: int) -> Iterator[Block]:
    waiting: list[Block] = []
    count = 0
    for block in blocks:
        if not len(block):
            continue
        waiting.append(block)
        count += len(block)
        if count < size:
            continue
        whole, full = joined(waiting), count // size * size
        yield from (whole.part(slice(start, start + size)) for start in range(0, full, size))
        waiting = [whole.part(slice(full, count))] if count > full else []
        count -= full
    if count:
        yield joined(waiting)


def joined(blocks: Sequence[Block]) -> Block:
    """Rows behind each other as one block; blocks of the same payloads."""
    if len(blocks) == 1:
        return blocks[0]
    first = blocks[0]
    errors = None
    if first.errors is not None:
        errors = np.concatenate([own.errors for own in blocks if own.errors is not None])
    loads = [_joined_loads([own.payload[k] for own in blocks]) for k in range(len(first.payload))]
    return Block(
        first.start,
        np.concatenate([own.rows for own in blocks]),
        np.concatenate([own.time for own in blocks]),
        _by_columns([own.q for own in blocks]),
        _by_columns([own.v for own in blocks]),
        _by_columns([own.a for own in blocks]),
        tuple(loads),
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


def _weights(block: Block, before: float | None, behind: float | None) -> Array:
    if len(block) == 1 and before is None and behind is None:
        return np.ones(1)
    first, last = block.time[0], block.time[-1]
    times = np.concatenate([[first if before is None else before], block.time, [last if behind is None else behind]])
    weights: Array = (times[2:] - times[:-2]) / 2
    return weights


def alone(block: Block, k: int) -> Block:
    """A copy of one row, which does not keep its block in memory."""
    own = block.part(slice(k, k + 1))
    rows, time, q, v, a = own.rows.copy(), own.time.copy(), own.q.copy(), own.v.copy(), own.a.copy()
    loads = tuple(Load(load.link, load.f.copy(), load.n.copy(), load.in_base) for load in own.payload)
    return Block(own.start, rows, time, q, v, a, loads, None if own.errors is None else own.errors.copy())
