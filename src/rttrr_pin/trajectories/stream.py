"""A trajectory: blocks of rows in constant memory, however long it is."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.text_results import PAYLOAD
from rttrr_pin.reporting.results import Summarised
from rttrr_pin.trajectories.block import Block, Differentiation
from rttrr_pin.trajectories.cleaning import Cleaner, check_limits, clock_of
from rttrr_pin.trajectories.findings import Finding, Findings
from rttrr_pin.trajectories.rows import Rows, Source

BLOCK = 4096
"""Rows of a block, unless others are wanted."""


class Trajectory(Summarised):
    """Motion of a robot over time.

    Attributes:
        name: as messages call it.
        model: of the robot.
        n_rows: rows of the file, of which some may be left out; None where nobody knows before they were read.
        notes: what a reader must know.
        place: what a row is called in messages: line, row or message.
    """

    __slots__ = ("_clock", "_cutoff", "_findings", "_record", "_source", "model", "n_rows", "name", "notes", "place")

    def __init__(self, source: Source, model: Model, cutoff: float | None = None) -> None:
        """Look at the first rows.

        Raises:
            InputError: no row can be used, or rates that cannot be derived are not there.
        """
        from rttrr_pin.trajectories.derivatives import Record

        self.name, self.place, self.model, self.n_rows = source.name, source.place, model, source.n_rows
        self._source, self._cutoff = source, cutoff
        self._findings = Findings(source.place)
        self._record = Record.of_source(source, model, cutoff)
        self._clock = clock_of(source, model)
        self.notes = (*source.notes, *filter(None, [source.origin, self._clock.note]))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is wrong with rows; complete when `blocks` ran to its end."""
        return self._findings.all()

    @property
    def differentiation(self) -> Differentiation | None:
        """What was derived; its figures are complete when `blocks` ran to its end. None where all was given."""
        return None if self._record is None else self._record.told()

    def summary(self) -> str:
        """Name, rows, and what was derived."""
        rows = "" if self.n_rows is None else f", {self.n_rows:,} rows"
        derived = self.differentiation
        return f"{self.name} of {self.model.name}{rows}{f', {derived.summary()}' if derived else ''}"

    def blocks(self, size: int = BLOCK) -> Iterator[Block]:
        """The rows from the first on, at most `size` at a time; their numbers do not depend on it.

        Raises:
            InputError: a row cannot be read, or time goes back.
        """
        if size < 1:
            raise InputError(f"size is {size}: expected 1 or more")
        from rttrr_pin.trajectories.derivatives import Record, derived

        self._findings = findings = Findings(self._source.place)
        self._record = record = Record.of_source(self._source, self.model, self._cutoff)
        parts = Cleaner(self._source, self.model, self._clock, findings).parts()
        start = 0
        whole = ((part.rows, None) for part in parts) if record is None else derived(parts, record, findings)
        for rows, errors in whole:
            check_limits(self.model, rows, self._source.labels["q"], findings)
            q, v, a = (rows.values[key] for key in "qva")
            block = Block(start, rows.numbers, rows.time, q, v, a, self._loads(rows), errors)
            start += len(block)
            ends = [*range(0, len(block), size), len(block)]
            yield from (block.part(slice(a, b)) for a, b in pairwise(ends))

    def _loads(self, rows: Rows) -> tuple[Load, ...]:
        """The payloads of these rows."""
        if not self._source.loads:
            return ()
        parts = np.split(rows.values[PAYLOAD], len(self._source.loads), axis=1)
        return tuple(
            Load(link, x[:, :3], x[:, 3:], in_base)
            for (link, in_base), x in zip(self._source.loads, parts, strict=True)
        )
