"""Trajectories of random states, in blocks of any sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin import Robot
from rttrr_pin.core.payload import Load
from rttrr_pin.loads.rows import joined
from rttrr_pin.trajectories import Block, Differentiation, Trajectory
from rttrr_pin.validation import Sampler

FIRST_ROW = 2
"""As of a file with a header."""


class OfBlock(Trajectory):
    """A trajectory whose rows are there already, cut into blocks of the sizes that it likes."""

    __slots__ = ("_block", "_sizes")

    def __init__(self, robot: Robot, block: Block, sizes: Sequence[int] = (7, 1, 30), name: str = "rows") -> None:
        self.name, self.place, self.model, self.n_rows, self.notes = name, "row", robot.model, len(block), ()
        self._block, self._sizes = block, sizes

    @property
    def findings(self) -> tuple[()]:
        return ()

    @property
    def differentiation(self) -> Differentiation | None:
        return None if self._block.errors is None else Differentiation("v, a", "q", self.model.v_names)

    def blocks(self, size: int = 0) -> Iterator[Block]:
        start, k = 0, 0
        while start < len(self._block):
            stop = start + self._sizes[k % len(self._sizes)]
            yield self._block.part(slice(start, min(stop, len(self._block))))
            start, k = stop, k + 1


def random_rows(robot: Robot, count: int, seed: int = 0, errors: bool = False, payload: bool = False) -> Block:
    """Random states at random times, with errors and payloads on request."""
    rng = np.random.default_rng(seed)
    batch = Sampler(robot.model, seed=seed).draw(0, count)
    nv = robot.model.nv
    L = np.tril(rng.normal(size=(count, nv, 3, 3))) * 1e-3 if errors else None
    loads = ()
    if payload:
        last = len(robot.link_names) - 1
        loads = tuple(
            Load(link, rng.normal(size=(count, 3)), rng.normal(size=(count, 3)), in_base)
            for link, in_base in ((last, False), (0, True))
        )
    time = np.cumsum(rng.uniform(0.001, 0.01, size=count)) + 5.0
    return Block(0, np.arange(count) + FIRST_ROW, time, batch.q, batch.v, batch.a, loads, L)


def repeated(block: Block, times: int) -> Block:
    """The same rows over and over, at times that go on."""
    step = block.time[-1] - block.time[0] + 0.01
    parts = [
        replace(block, start=k * len(block), time=block.time + k * step, rows=block.rows + k * len(block))
        for k in range(times)
    ]
    return joined(parts)
