"""What is not given of v and a, derived from rows as they come, with its error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError
from rttrr_pin.trajectories.block import Differentiation
from rttrr_pin.trajectories.cleaning import Clock, Part
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import Rows, Source


@dataclass(slots=True, eq=False)
class Record:
    """What is to be derived, and the figures of what was."""

    derived: str
    source: str
    names: tuple[str, ...]
    cutoff: float | None

    @staticmethod
    def of(source: Source, model: Model, cutoff: float | None) -> Record | None:
        """None where all is given."""
        if source.has("v") and source.has("a"):
            return None
        several = [joint.name for joint in model.moving if joint.nv > 1]
        if several and not source.has("v"):
            raise InputError(
                f"{source.name} lacks columns v_{several[0]}...: rates of {several[0]} are no derivatives of q"
            )
        raise InputError(f"{source.name} lacks v or a, which cannot be derived yet")

    def told(self) -> Differentiation:
        """So far."""
        return Differentiation(self.derived, self.source, self.names)


def derived(
    parts: Iterable[Part], record: Record, clock: Clock, findings: Findings
) -> Iterator[tuple[Rows, Array | None]]:
    """Rows with q, v, a, and their errors."""
    raise NotImplementedError
