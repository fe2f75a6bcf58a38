"""How far a computed number can be from the true one, what the true one is, and the laws that true ones keep."""

from __future__ import annotations

from rttrr_pin.exact.adjudication import Adjudication, Assessment, Deviation
from rttrr_pin.exact.enclosures import Enclosure, Enclosures, enclose
from rttrr_pin.exact.rounding import BOUNDED, Bounded, bounded_dynamics

__all__ = [
    "BOUNDED",
    "Adjudication",
    "Assessment",
    "Bounded",
    "Deviation",
    "Enclosure",
    "Enclosures",
    "bounded_dynamics",
    "enclose",
]
