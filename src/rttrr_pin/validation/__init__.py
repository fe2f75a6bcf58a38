"""Is our recursion, or anyone's, right: states, comparison with an oracle, verdict, worst state."""

from __future__ import annotations

from rttrr_pin.core.scalars import EPS
from rttrr_pin.validation.compare import Comparison, Row
from rttrr_pin.validation.many import BASES, Entry, Task, validate_many
from rttrr_pin.validation.run import Against, Validation, validate
from rttrr_pin.validation.state import StateReport, View, compare_state
from rttrr_pin.validation.states import FAMILIES, Sampler

__all__ = [
    "BASES",
    "EPS",
    "FAMILIES",
    "Against",
    "Comparison",
    "Entry",
    "Row",
    "Sampler",
    "StateReport",
    "Task",
    "Validation",
    "View",
    "compare_state",
    "validate",
    "validate_many",
]
