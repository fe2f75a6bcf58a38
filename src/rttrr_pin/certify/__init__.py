"""How far a computed number can be from the true one, what the true one is, and the laws that true ones keep."""

from __future__ import annotations

from rttrr_pin.certify.rounding import BOUNDED, Bounded, bounded_dynamics
from rttrr_pin.certify.settle import Off, Settlement, Side, eps_in_words, verdict_of
from rttrr_pin.certify.umpire import Certificate, Enclosure, certify

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
