"""How far a computed number can be from the true one, what the true one is, and the laws that true ones keep."""

from __future__ import annotations

from rttrr_pin.exact.adjudication import Off, Settlement, Side, eps_in_words, verdict_of
from rttrr_pin.exact.enclosures import Certificate, Enclosure, certify
from rttrr_pin.exact.rounding import BOUNDED, Bounded, bounded_dynamics

__all__ = [
    "BOUNDED",
    "Bounded",
    "Certificate",
    "Enclosure",
    "Off",
    "Settlement",
    "Side",
    "bounded_dynamics",
    "certify",
    "eps_in_words",
    "verdict_of",
]
