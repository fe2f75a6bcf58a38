"""The states that matter: where something is largest, each once, with all that acts there."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rttrr_pin.loads.evaluation import Evaluator, Values
from rttrr_pin.loads.parts import BAND, Peak
from rttrr_pin.loads.results import NamedState
from rttrr_pin.loads.rows import joined
from rttrr_pin.loads.sums import Place
from rttrr_pin.trajectories import Block


class States:
    """Block where something is largest, in the order of the trajectory.

    Attributes:
        rows: one block of them all.
        values: what acts there, as the evaluator has it.
        named: the same as data.
    """

    def __init__(self, marked: Iterable[tuple[str, Place]], evaluator: Evaluator) -> None:
        """Gather them.

        Args:
            marked: why a row matters, and the row.
            evaluator: of what is to be known there.
        """
        reasons: dict[int, list[str]] = {}
        alone: dict[int, Block] = {}
        for reason, place in marked:
            if place.value == 0.0:  # everywhere: no row matters for it
                continue
            reasons.setdefault(place.at.start, []).append(reason)
            alone[place.at.start] = place.at
        order = sorted(alone)
        self._index = {start: k for k, start in enumerate(order)}
        self.rows = joined([alone[start] for start in order])
        self.values: Values = evaluator.of(self.rows)
        self._half_widths = evaluator.half_widths(self.rows)
        self.named = tuple(_named(", ".join(reasons[start]), alone[start]) for start in order)

    def peak(self, place: Place, quantity: str = "", column: int = 0) -> Peak:
        """A peak at one of the states, with half the width of the band of a column of a quantity."""
        k = self._index.get(place.at.start) if place.value != 0.0 else None
        error = None
        if quantity and k is not None and self._half_widths is not None:
            error = float(self._half_widths[quantity][k, column])
        return Peak(place.value, int(place.at.rows[0]), float(place.at.time[0]), error, k)

    def peak_speed(self, place: Place, j: int) -> Peak:
        """A peak of the rate of a degree of freedom, whose error is known itself."""
        errors = place.at.errors
        error = None if errors is None else BAND * float(np.sqrt((errors[0, j, 1] ** 2).sum()))
        return replace(self.peak(place), error=error)


def _named(name: str, at: Block) -> NamedState:
    payload = tuple(load.block(slice(0, 1)) for load in at.payload)
    flat = (type(load)(load.link, load.f.reshape(3), load.n.reshape(3), load.in_base) for load in payload)
    return NamedState(name, int(at.rows[0]), float(at.time[0]), at.q[0], at.v[0], at.a[0], tuple(flat))
