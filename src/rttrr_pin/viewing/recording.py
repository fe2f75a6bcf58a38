"""The rows of a trajectory that a viewer shows, and which of them is the worst."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import Batch
from rttrr_pin.robot import Robot
from rttrr_pin.trajectories import Trajectory
from rttrr_pin.validation.comparison import Run
from rttrr_pin.viewing.states import State

KEPT = 20_000
"""Rows that a viewer keeps, at most: every second, fourth, ... of a longer trajectory, and the worst."""

SAMPLED = 1000
"""Random states in which two programs are compared where there is no trajectory."""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Some states in their order.

    Attributes:
        row: the number of each as its source counts, (N,).
        time: (N,) [s]; None where the rows are no motion.
        q: (N, nq).
        v: (N, nv).
        a: (N, nv).
        loads: payloads with (N, 3) each, or (3,).
    """

    row: NDArray[np.int64]
    time: Array | None
    q: Array
    v: Array
    a: Array
    loads: tuple[Load, ...] = ()

    def __len__(self) -> int:
        return len(self.row)

    def taken(self, part: slice | NDArray[np.int64]) -> Rows:
        """Some of them."""
        time = None if self.time is None else self.time[part]
        loads = tuple(load.block(part) for load in self.loads)
        return Rows(self.row[part], time, self.q[part], self.v[part], self.a[part], loads)

    def state(self, k: int) -> State:
        """The k-th."""
        one = self.taken(slice(k, k + 1))
        loads = tuple(replace(load, f=load.f.reshape(3), n=load.n.reshape(3)) for load in one.loads)
        return State(one.q[0], one.v[0], one.a[0], loads)


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """What is played.

    Attributes:
        name: of the trajectory, as messages call it.
        rows: those that are shown.
        total: how many rows there are.
        worst: which of `rows` is the worst of all.
        why: what is largest there, a sentence.
        counted: what a row is called: "row" or "state".
    """

    name: str
    rows: Rows
    total: int
    worst: int
    why: str
    counted: str = "row"

    def place(self, k: int) -> str:
        """Which row the k-th is, and at what time."""
        time = "" if self.rows.time is None else f", t = {self.rows.time[k]:.4f} s"
        return f"{self.counted} {self.rows.row[k]}{time}"

    def at(self, time: float) -> int:
        """The row that is the last at a time."""
        assert self.rows.time is not None
        return int(np.clip(np.searchsorted(self.rows.time, time, side="right") - 1, 0, len(self.rows) - 1))

    @property
    def note(self) -> str:
        """What is left out."""
        left_out = len(self.rows) < self.total
        return f"{len(self.rows):,} of {self.total:,} rows are shown, the worst of all among them" if left_out else ""


Measure = Callable[[Rows], tuple[Array, Callable[[int], str]]]
"""How bad each row is, (N,), and what is so in the k-th, as a sentence."""


def record(trajectory: Trajectory, measure: Measure) -> Recording:
    """Read a trajectory once, in constant memory.

    Raises:
        InputError: it has no row.
    """
    blocks = (Rows(b.rows, b.time, b.q, b.v, b.a, b.payload) for b in trajectory.blocks())
    return recorded(trajectory.name, blocks, measure)


def recorded(name: str, blocks: Iterable[Rows], measure: Measure, counted: str = "row") -> Recording:
    """A recording of rows that come in blocks; which are kept does not depend on the size of the blocks."""
    kept: list[Rows] = []
    stride, total, largest = 1, 0, -np.inf
    worst: Rows | None = None
    why = ""
    for block in blocks:
        values, sentence = measure(block)
        values = np.nan_to_num(values, nan=np.inf)
        k = int(np.argmax(values)) if len(block) else 0
        if len(block) and values[k] > largest:
            largest, worst, why = float(values[k]), block.taken(slice(k, k + 1)), sentence(k)
        kept.append(block.taken(np.flatnonzero((total + np.arange(len(block))) % stride == 0)))
        total += len(block)
        while sum(map(len, kept)) > KEPT:
            stride *= 2
            kept = [_joined(kept).taken(slice(None, None, 2))]
    if worst is None:
        raise InputError(f"{name} has no row: there is nothing to show")
    rows = _joined(kept)
    at = int(np.searchsorted(rows.row, worst.row[0]))
    if at == len(rows) or rows.row[at] != worst.row[0]:
        rows = _joined([rows.taken(slice(0, at)), worst, rows.taken(slice(at, None))])
    return Recording(name, rows, total, at, why, counted)


def _joined(parts: Sequence[Rows]) -> Rows:
    """Consecutive rows as one."""
    first = parts[0]
    if len(parts) == 1:
        return first
    arrays = (np.concatenate([getattr(part, name) for part in parts]) for name in ("row", "q", "v", "a"))
    row, q, v, a = arrays
    time = None if first.time is None else np.concatenate([part.time for part in parts if part.time is not None])
    loads = []
    for j, load in enumerate(first.loads):
        f, n = (
            x if x.ndim == 1 else np.concatenate([getattr(part.loads[j], name) for part in parts])
            for name, x in (("f", load.f), ("n", load.n))
        )
        loads.append(Load(load.link, f, n, load.in_base))
    return Rows(row, time, q, v, a, tuple(loads))


def by_torque(robot: Robot) -> Measure:
    """How bad rows are by themselves: |tau| of the effort limit where a joint has one, else |tau|."""
    model = robot.model
    limits = np.array([joint.limits.effort for joint in model.moving for _ in range(joint.nv)])
    limited = np.isfinite(limits) & (limits > 0.0)
    units = ["N m" if rotates else "N" for rotates in model.rotations]
    kernel = robot.compile("tau") if model.nv else None

    def measure(rows: Rows) -> tuple[Array, Callable[[int], str]]:
        tau = np.zeros((len(rows), 0)) if kernel is None else kernel(rows.q, rows.v, rows.a, list(rows.loads) or None)
        share = np.abs(tau[:, limited]) / limits[limited] if limited.any() else np.abs(tau)
        of = np.flatnonzero(limited) if limited.any() else np.arange(model.nv)

        def sentence(k: int) -> str:
            if not len(of):
                return "no joint moves"
            j = int(of[int(np.argmax(share[k]))])
            largest = f"tau of {model.v_names[j]} is {tau[k, j]:.4g} {units[j]}"
            if limited.any():
                return f"{largest}, {float(share[k].max()):.1%} of its limit of {limits[j]:g} {units[j]}"
            return f"{largest}, the largest"

        return share.max(axis=1, initial=0.0), sentence

    return measure


def by_difference(run: Run) -> Measure:
    """How far two programs are apart, as error / tolerance."""
    model = run.states.sampler.model

    def measure(rows: Rows) -> tuple[Array, Callable[[int], str]]:
        batch = Batch(model, rows.q, rows.v, rows.a, rows.loads, compiled=run.states.compiled)
        difference = run.differences(batch, run.evaluate(batch))[0]
        ratios = difference.of_tolerance

        def sentence(k: int) -> str:
            j = int(np.argmax(ratios[:, k]))
            row = run.comparisons[0].rows[j]
            off = f"{row.quantity} of {row.at} differs by {float(difference.error[j, k]):.3g} {row.unit}"
            return f"{off}, {float(ratios[j, k]):.3g} of what rounding explains"

        return ratios.max(axis=0), sentence

    return measure


def sampled(run: Run) -> Recording:
    """The states of a table among two programs, or random ones, the same as those of `validate`."""
    states = run.states
    batches = states.blocks(SAMPLED, None)
    blocks = (
        Rows(batch.first + np.arange(len(batch), dtype=np.int64), None, batch.q, batch.v, batch.a, batch.loads)
        for batch in batches
    )
    name = "the states of the table" if states.table is not None else f"{SAMPLED:,} random states"
    return recorded(name, blocks, by_difference(run), "state")
