"""What was seen: states, a program's values beside those of the reference recursion, and what rounding can explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.diagnosis.variant import Values
from rttrr_pin.implementations.protocol import Batch

SCREENED = 24
"""States on which hypotheses are tried first: a few hundred equations tell nearly all of them apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """A program's results at some states, number by number.

    Attributes:
        batch: the states.
        quantities: those that the program gives.
        values: what it computes, (N, numbers): tau, then F, N, f, n link by link.
        expected: what the reference recursion does, likewise.
        tolerance: what rounding (and printing) of the program can explain, likewise; of a vector for each component.
        rounding: what rounding of the recursion can explain.
    """

    batch: Batch
    quantities: tuple[str, ...]
    values: Array
    expected: Array
    tolerance: Array
    rounding: Array

    @property
    def difference(self) -> Array:
        """Values less expected ones."""
        return self.values - self.expected

    def part(self, rows: NDArray[np.int64]) -> Evidence:
        """Some of the states."""
        arrays = (getattr(self, name)[rows] for name in ("values", "expected", "tolerance", "rounding"))
        return Evidence(part_of(self.batch, rows), self.quantities, *arrays)

    def of_tolerance(self, predicted: Array, growth: Array | float = 1.0) -> Array:
        """|values - predicted| over what rounding explains, where terms are `growth` times as large, (N, numbers)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            error = np.abs(self.values - predicted)
            ratio = np.where(error == 0.0, 0.0, error / (self.tolerance + self.rounding * growth))
        return np.where(np.isnan(ratio), np.inf, ratio)


def flat(values: Values, quantities: Sequence[str]) -> Array:
    """Arrays by quantity side by side, (N, numbers)."""
    return np.hstack([values[key].reshape(len(values[key]), -1) for key in quantities])


def spread(sizes: dict[str, Array], quantities: Sequence[str]) -> Array:
    """What is known for each vector, (N, links), for each of its components, (N, numbers)."""
    return np.hstack([np.repeat(sizes[key], 3, axis=1) if key in LINK_QUANTITIES else sizes[key] for key in quantities])


def places(model: Model, quantities: Sequence[str]) -> list[tuple[str, str]]:
    """Quantity, and link or joint, of each number."""
    labels: list[tuple[str, str]] = []
    for key in quantities:
        if key == "tau":
            labels += [(key, name) for name in model.v_names]
        else:
            labels += [(key, name) for name in model.link_names for _ in range(3)]
    return labels


def part_of(batch: Batch, rows: NDArray[np.int64]) -> Batch:
    """Some of the states of a batch."""
    loads = tuple(replace(own, f=_rows(own.f, rows), n=_rows(own.n, rows)) for own in batch.loads)
    return Batch(batch.model, batch.q[rows], batch.v[rows], batch.a[rows], loads)


def _rows(x: Array, rows: NDArray[np.int64]) -> Array:
    return x if x.ndim == 1 else x[rows]


def joined(batches: Sequence[Batch]) -> Batch:
    """States of several batches, with loads at the same links in the same axes, one after the other."""
    q, v, a = (np.concatenate([getattr(own, name) for own in batches]) for name in "qva")
    loads = []
    for group in zip(*(own.loads for own in batches), strict=True):
        f, n = (
            np.concatenate([np.broadcast_to(getattr(x, name), (len(b), 3)) for x, b in zip(group, batches, strict=True)])
            for name in "fn"
        )
        loads.append(Load(group[0].link, f, n, group[0].in_base))
    return Batch(batches[0].model, q, v, a, tuple(loads))


def shape_of_loads(batch: Batch) -> tuple[tuple[int, bool], ...]:
    """What batches have in common that can be joined."""
    return tuple((load.link, load.in_base) for load in batch.loads)


def screened(evidence: Evidence, most: int = SCREENED) -> NDArray[np.int64]:
    """States to try hypotheses on: of each kind some, simple ones and those that differ most.

    A kind is which of q, v, a and payload are zero, and how many rates and accelerations are not.
    """
    batch = evidence.batch
    loaded = np.zeros(len(batch), dtype=bool)
    for load in batch.loads:
        loaded |= (np.broadcast_to(load.f, (len(batch), 3)) != 0).any(axis=1)
        loaded |= (np.broadcast_to(load.n, (len(batch), 3)) != 0).any(axis=1)
    counts = [np.minimum((getattr(batch, name) != 0).sum(axis=1), 3) for name in "va"]
    kinds = np.stack([*counts, loaded, (batch.q != 0).any(axis=1)], axis=1)
    sizes = evidence.of_tolerance(evidence.expected).max(axis=1)
    by_kind: dict[tuple[int, ...], list[int]] = {}
    for k, kind in enumerate(map(tuple, kinds.astype(int).tolist())):
        by_kind.setdefault(kind, []).append(k)
    # Richest kind first, since there every term shows; within a kind large and ordinary differences alternate.
    queues = []
    for kind in sorted(by_kind, key=lambda kind: -sum(kind)):
        own = sorted(by_kind[kind], key=lambda k: -sizes[k])
        queues.append([k for pair in zip(own, own[len(own) // 2 :] + own, strict=False) for k in pair])
    chosen: dict[int, None] = {}
    depth = 0
    while len(chosen) < min(most, len(batch)):
        for number, queue in enumerate(queues):
            for k in queue[depth : depth + (3 if number == 0 else 1)]:
                if len(chosen) < most:
                    chosen[k] = None
        depth += 3 if len(queues) == 1 else 1
        if depth > 2 * len(batch) + 3:
            break
    return np.array(sorted(chosen), dtype=np.int64)
