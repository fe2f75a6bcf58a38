"""How far a computed number can be from the true one, and the laws that true ones keep."""

from __future__ import annotations

from rttrr_pin.certify.rounding import BOUNDED, Bounded, bounded_dynamics

__all__ = ["BOUNDED", "Bounded", "bounded_dynamics"]
