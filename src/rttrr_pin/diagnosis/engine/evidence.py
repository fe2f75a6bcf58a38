"""What was seen: states, a program's values beside those of the reference recursion, and what rounding can explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.diagnosis.variants.variant import Values
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.validation.compare import labels, ratio

MOST_TIMES = 2.0**60
"""More than that a difference is not said to be times rounding."""

FRESH = 2.0**-40
"""Of a result that the reference has as zero, what rounding can explain: some hundred terms, and what cancels."""

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

    def of_tolerance(self, predicted: Array, rounding: Array | None = None) -> Array:
        """|values - predicted| over what rounding explains, (N, numbers); `rounding` in place of the recursion's."""
        own = self.rounding if rounding is None else rounding
        return ratio(np.abs(self.values - predicted), self.tolerance + own)

    def rounding_at(self, values: Array) -> Array:
        """What rounding of the recursion can explain where it computes these results in place of those expected.

        It grows as the results do, number by number. Of a result that is zero in every state, as at a link without
        mass, it says nothing: so it is `FRESH` of what takes its place.
        """
        new, old = rms(values), rms(self.expected)
        with np.errstate(divide="ignore", invalid="ignore"):
            growth = np.where(old > 0.0, np.maximum(new / old, 1.0), 1.0)
        return np.where(old > 0.0, self.rounding * growth, np.maximum(self.rounding, FRESH * np.abs(values)))


def results(evidence: Evidence) -> int:
    """How many results there are to fit numbers to: of equal states one, and none where all that is seen is zero."""
    bound = evidence.tolerance + evidence.rounding
    seen = (np.maximum(np.abs(evidence.values), np.abs(evidence.expected)) > bound).any(axis=0)
    return len(_different(evidence.batch)) * int(seen.sum())


def bits(evidence: Evidence) -> float:
    """How much the differences say: of each result, by how many powers of two it is more than rounding explains."""
    ratios = evidence.of_tolerance(evidence.expected)[_different(evidence.batch)]
    return float(np.log2(np.clip(ratios, 1.0, MOST_TIMES)).sum())


def _different(batch: Batch) -> NDArray[np.int64]:
    """The states, of equal ones the first."""
    loads = [np.broadcast_to(x, (len(batch), 3)) for load in batch.loads for x in (load.f, load.n)]
    rows = np.unique(np.hstack([batch.q, batch.v, batch.a, *loads]), axis=0, return_index=True)[1]
    return np.asarray(rows, dtype=np.int64)


def flat(values: Values, quantities: Sequence[str]) -> Array:
    """Arrays by quantity side by side, (N, numbers)."""
    return np.hstack([values[key].reshape(len(values[key]), -1) for key in quantities])


def spread(sizes: dict[str, Array], quantities: Sequence[str]) -> Array:
    """What is known for each vector, (N, links), for each of its components, (N, numbers)."""
    return np.hstack([np.repeat(sizes[key], 3, axis=1) if key in LINK_QUANTITIES else sizes[key] for key in quantities])


def rms(x: Array) -> Array:
    """Root mean square of each column, also where squares overflow."""
    largest = np.abs(x).max(axis=0, initial=0.0)
    largest = np.where(largest > 0.0, largest, 1.0)
    return np.asarray(largest * np.sqrt(np.mean((x / largest) ** 2, axis=0)))


def places(model: Model, quantities: Sequence[str]) -> list[tuple[str, str]]:
    """Quantity, and link or joint, of each number."""
    every = [(key, at) for key, at, _ in labels(model) for _ in range(3 if key in LINK_QUANTITIES else 1)]
    return [own for own in every if own[0] in quantities]


def part_of(batch: Batch, rows: NDArray[np.int64]) -> Batch:
    """Some of the states of a batch."""
    loads = tuple(own.block(rows) for own in batch.loads)
    return Batch(batch.model, batch.q[rows], batch.v[rows], batch.a[rows], loads)


def joined(batches: Sequence[Batch]) -> Batch:
    """States of several batches, with loads at the same links in the same axes, one after the other."""
    q, v, a = (np.concatenate([getattr(own, name) for own in batches]) for name in "qva")
    loads = []
    for group in zip(*(own.loads for own in batches), strict=True):
        f, n = (
            np.concatenate(
                [np.broadcast_to(getattr(x, name), (len(b), 3)) for x, b in zip(group, batches, strict=True)]
            )
            for name in "fn"
        )
        loads.append(Load(group[0].link, f, n, group[0].in_base))
    return Batch(batches[0].model, q, v, a, tuple(loads))


def shape_of_loads(batch: Batch) -> tuple[tuple[int, bool], ...]:
    """What batches have in common that can be joined."""
    return tuple((load.link, load.in_base) for load in batch.loads)


def screened(batch: Batch, most: int = SCREENED) -> NDArray[np.int64]:
    """States to try hypotheses on, (most,) or fewer: of each kind some, half of them of the one in which most moves.

    A kind is how many rates and accelerations are not zero, and whether there is a payload. Every term shows where all
    move; what a term is of shows where little does.
    """
    counts = [np.minimum((getattr(batch, name) != 0).sum(axis=1), 3) for name in "va"]
    kinds = np.stack([*counts, loaded(batch)], axis=1).astype(int).tolist()
    by_kind: dict[tuple[int, ...], list[int]] = {}
    for k, kind in enumerate(kinds):
        by_kind.setdefault(tuple(kind), []).append(k)
    richest, *others = sorted(by_kind.values(), key=lambda rows: (-sum(kinds[rows[0]]), rows))
    share = max(2, most // (2 * len(others))) if others else 0
    chosen = [k for rows in others for k in _spread_out(rows, share)][: most // 2]
    chosen += _spread_out(richest, most - len(chosen))
    left = sorted(set(range(len(batch))) - set(chosen))
    return np.array(sorted([*chosen, *_spread_out(left, most - len(chosen))]), dtype=np.int64)


def with_worst(rows: NDArray[np.int64], ratios: Array) -> NDArray[np.int64]:
    """The states, a third of them replaced by those that differ most, (N,) error / tolerance."""
    kept = rows[np.arange(len(rows)) % 3 != 0]
    worst = [k for k in np.argsort(-ratios, kind="stable").tolist() if k not in kept][: len(rows) - len(kept)]
    return np.array(sorted([*kept.tolist(), *worst]), dtype=np.int64)


def loaded(batch: Batch) -> NDArray[np.bool_]:
    """In which states there is a payload, (N,)."""
    found = np.zeros(len(batch), dtype=bool)
    for load in batch.loads:
        for x in (load.f, load.n):
            found |= np.broadcast_to(x != 0.0, (len(batch), 3)).any(axis=1)
    return found


def _spread_out(rows: Sequence[int], most: int) -> list[int]:
    """So many of the rows at most, the first one and others far apart."""
    if most <= 0 or not rows:
        return []
    return [rows[k] for k in np.unique(np.linspace(0, len(rows) - 1, min(most, len(rows))).astype(int)).tolist()]
