"""Is one program right, judged by another: states, comparison, verdict, worst state."""

from __future__ import annotations

from rttrr_pin.core.scalars import EPS
from rttrr_pin.validation.compare import Comparison, Row
from rttrr_pin.validation.many import BASES, Entry, Task, validate_many
from rttrr_pin.validation.run import ReferenceSummary, Validation, validate
from rttrr_pin.validation.sampling import SAMPLINGS, Sampler
from rttrr_pin.validation.state import StateComparison, StateReport, compare_state

__all__ = [
    "BASES",
    "EPS",
    "SAMPLINGS",
    "Comparison",
    "Entry",
    "ReferenceSummary",
    "Row",
    "Sampler",
    "StateComparison",
    "StateReport",
    "Task",
    "Validation",
    "compare_state",
    "validate",
    "validate_many",
]
