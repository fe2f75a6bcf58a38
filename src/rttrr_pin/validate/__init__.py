"""Is our recursion, or anyone's, right: states, comparison with an oracle, verdict, worst state."""

from __future__ import annotations

from rttrr_pin.arithmetic import EPS
from rttrr_pin.validate.compare import Comparison, Row
from rttrr_pin.validate.laws import LawReport, LawRow, check_laws
from rttrr_pin.validate.many import BASES, Entry, Task, validate_many
from rttrr_pin.validate.one_state import StateReport, View, compare_state
from rttrr_pin.validate.run import Against, Validation, validate
from rttrr_pin.validate.states import FAMILIES, Sampler

__all__ = [
    "BASES",
    "EPS",
    "FAMILIES",
    "Against",
    "Comparison",
    "Entry",
    "LawReport",
    "LawRow",
    "Row",
    "Sampler",
    "StateReport",
    "Task",
    "Validation",
    "View",
    "check_laws",
    "compare_state",
    "validate",
    "validate_many",
]
