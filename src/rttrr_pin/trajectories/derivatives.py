"""What is not given of v and a, derived from rows as they come, in windows fixed by row number, with its error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arguments import positive
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError
from rttrr_pin.trajectories.block import Differentiation
from rttrr_pin.trajectories.cleaning import Part
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import Rows, Source
from rttrr_pin.trajectories.spline import FEWEST, Fit, fitted

CORE, MARGIN = 2048, 512
"""Rows that a window gives, and rows on either side that it sees besides."""

DOUBT = 0.2
"""Of accelerations, a standard error from which a cut-off as high as possible is no good sign."""


@dataclass(slots=True, eq=False)
class Record:
    """What is to be derived, and the figures of what was.

    Attributes:
        source: its name.
        keys: what is derived: v, a, or both.
        of: what from: q or v.
        names: of the degrees of freedom.
        cutoff: as the caller wants it [Hz].
    """

    source: str
    keys: tuple[str, ...]
    of: str
    names: tuple[str, ...]
    cutoff: float | None
    _rows: int = 0
    _knots: list[Array] = field(default_factory=list)
    _noise: Array | None = None
    _error: Array | None = None
    _size: Array | None = None
    _finest: NDArray[np.bool_] | None = None

    @staticmethod
    def of_source(source: Source, model: Model, cutoff: float | None) -> Record | None:
        """None where all is given.

        Raises:
            InputError: rates are missing that are no derivatives, or the cut-off is no frequency.
        """
        cutoff = None if cutoff is None else positive("cutoff", cutoff, "Hz", "--cutoff")
        keys = tuple(key for key in "va" if not source.has(key))
        if not keys:
            return None
        several = [joint.name for joint in model.moving if joint.nv > 1]
        if several and "v" in keys:
            raise InputError(
                f"{source.name} lacks columns v_{several[0]}...: rates of {several[0]} are no derivatives of q"
            )
        return Record(source.name, keys, "q" if "v" in keys else "v", model.v_names, cutoff)

    def count(self, fit: Fit, part: slice, order: int) -> None:
        """One window more."""
        errors = fit.covariance[part, :, order, order]
        zero = np.zeros(len(self.names))
        self._noise = (zero if self._noise is None else self._noise) + len(errors) * fit.noise**2
        self._error = (zero if self._error is None else self._error) + errors.sum(axis=0)
        size = (fit.orders[part, :, order] ** 2).sum(axis=0)
        self._size = (zero if self._size is None else self._size) + size
        self._finest = (zero > 0.0 if self._finest is None else self._finest) | fit.finest
        own = self._knots or [fit.knots, fit.knots]
        self._knots = [np.minimum(own[0], fit.knots), np.maximum(own[1], fit.knots)]
        self._rows += len(errors)

    def told(self) -> Differentiation:
        """So far."""
        said = Differentiation(", ".join(self.keys), self.of, self.names, chosen=self.cutoff is None)
        if self._noise is None or self._error is None or self._size is None or self._finest is None:
            return said
        doubtful = self._finest & (self._error > DOUBT**2 * self._size) & (self.cutoff is None)
        least, most = self._knots
        return Differentiation(
            said.derived,
            said.source,
            said.names,
            tuple(zip((0.5 / most).tolist(), (0.5 / least).tolist(), strict=True)),
            tuple(np.sqrt(self._noise / self._rows).tolist()),
            tuple(np.sqrt(self._error / self._rows).tolist()),
            said.chosen,
            tuple(name for name, own in zip(self.names, doubtful.tolist(), strict=True) if own),
        )


def derived(parts: Iterable[Part], record: Record, findings: Findings) -> Iterator[tuple[Rows, Array]]:
    """Rows with q, v, a, and the factors of their errors' covariance, (N, nv, 3, 3).

    Raises:
        InputError: nowhere do enough rows follow each other without a gap.
    """
    some = False
    for rows, inside in _windows(parts):
        if len(rows) < FEWEST:
            findings.add("short part", "time", rows.numbers, rows.time, np.zeros(len(rows)))
            continue
        some = True
        yield _derived(rows, inside, record)
    if not some:
        missing = " and ".join(record.keys)
        raise InputError(
            f"{record.source} lacks {missing}, and no {FEWEST} rows follow each other without a gap to derive "
            f"{'it' if len(record.keys) == 1 else 'them'} from: give {missing}, or more rows"
        )


def _windows(parts: Iterable[Part]) -> Iterator[tuple[Rows, slice]]:
    """Rows between two gaps in windows, and which of each are given; the last one takes the rest."""
    held: list[Rows] = []
    done = 0
    for part in parts:
        ends = [0, *part.breaks.tolist(), len(part.rows)]
        for k, (a, b) in enumerate(pairwise(ends)):
            if k and held:
                yield _last(held, done)
                held, done = [], 0
            if b > a:
                held.append(part.rows.part(slice(a, b)))
            while sum(map(len, held)) - done >= CORE + 2 * MARGIN:
                rows = Rows.joined(held)
                yield rows.part(slice(0, done + CORE + MARGIN)), slice(done, done + CORE)
                held, done = [rows.part(slice(done + CORE - MARGIN, None))], MARGIN
    if held:
        yield _last(held, done)


def _last(held: list[Rows], done: int) -> tuple[Rows, slice]:
    rows = Rows.joined(held)
    return rows, slice(done, len(rows))


def _derived(rows: Rows, inside: slice, record: Record) -> tuple[Rows, Array]:
    """One window."""
    fit = fitted(rows.time, rows.values[record.of], record.cutoff)
    first = "qva".index(record.of)
    kept = rows.part(inside)
    values = dict(kept.values)
    covariance = np.zeros((len(kept), len(record.names), 3, 3))
    given = [key for key in "qva"[first + 1 :] if key not in record.keys]
    ours = [k for k in range(first, 3) if "qva"[k] not in given]
    for k in ours:
        values["qva"[k]] = fit.orders[inside, :, k - first]
        for j in ours:
            covariance[..., k, j] = fit.covariance[inside, :, k - first, j - first]
    record.count(fit, inside, ours[-1] - first)
    return Rows(kept.numbers, kept.time, values), _factor(covariance)


def _factor(covariance: Array) -> Array:
    """The lower triangular L with L L^T the covariance; columns of nothing are zero."""
    L = np.zeros_like(covariance)
    for i in range(3):
        for j in range(i + 1):
            rest = covariance[..., i, j] - (L[..., i, :j] * L[..., j, :j]).sum(axis=-1)
            if i == j:
                L[..., i, i] = np.sqrt(np.maximum(rest, 0.0))
            else:
                np.divide(rest, L[..., j, j], out=L[..., i, j], where=L[..., j, j] > 0.0)
    return L
