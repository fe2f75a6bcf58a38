"""Is one program right, judged by another: states, comparison, verdict, worst state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rttrr_pin.core.scalars import EPS
from rttrr_pin.validation.compare import Comparison, Row
from rttrr_pin.validation.run import Validation, validate
from rttrr_pin.validation.sampling import SAMPLINGS, Sampler
from rttrr_pin.validation.state import StateComparison, StateReport, compare_state

if TYPE_CHECKING:
    from rttrr_pin.validation.many import BASES, Entry, Task, validate_many

__all__ = [
    "BASES",
    "EPS",
    "SAMPLINGS",
    "Comparison",
    "Entry",
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


def __getattr__(name: str) -> Any:
    """Names of `many`, which loads multiprocessing: one robot does without."""
    if name not in ("BASES", "Entry", "Task", "validate_many"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from rttrr_pin.validation import many

    return getattr(many, name)
