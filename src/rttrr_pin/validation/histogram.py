"""How many states are how far off, in memory that does not grow with them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array

FIRST, LAST = -40, 24
"""Powers of two; what is smaller or larger is counted with the first or the last."""

EDGES = tuple(2.0**k for k in range(FIRST - 1, LAST + 1))
"""Of the bins; each has its upper edge in it, as the tolerance is within the tolerance."""


@dataclass(slots=True)
class Histogram:
    """How many of the values are in each power of two.

    Attributes:
        counts: by bin, between two of `EDGES`.
        zero: how many are zero: both programs gave the same bits.
    """

    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(LAST - FIRST + 1, dtype=np.int64))
    zero: int = 0

    def see(self, values: Array) -> None:
        """Take in values that are not negative; infinities are large."""
        positive = values[values > 0.0]
        self.zero += len(values) - len(positive)
        mantissas, exponents = np.frexp(positive)
        exponents = np.where(np.isfinite(positive), exponents - (mantissas == 0.5), LAST)
        self.counts += np.bincount(np.clip(exponents, FIRST, LAST) - FIRST, minlength=len(self.counts))

    def to_dict(self) -> dict[str, object]:
        """The bins that have something in them, by their upper edges, as data for JSON."""
        used = np.flatnonzero(self.counts).tolist()
        return {"zero": self.zero, "up_to": {f"{EDGES[k + 1]:.3g}": int(self.counts[k]) for k in used}}
