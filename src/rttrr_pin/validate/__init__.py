"""Is our recursion, or anyone's, right: states, comparison with an oracle, verdict, worst state."""

from __future__ import annotations

from rttrr_pin.validate.compare import EPS, Comparison, Row
from rttrr_pin.validate.run import StateReport, Validation, compare_state, validate
from rttrr_pin.validate.states import FAMILIES, Sampler

__all__ = [
    "EPS",
    "FAMILIES",
    "Comparison",
    "Row",
    "Sampler",
    "StateReport",
    "Validation",
    "compare_state",
    "validate",
]
