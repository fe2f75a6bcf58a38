"""Is one program right, judged by another: states, comparison, verdict, worst state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.core.scalars import EPS as EPS
    from rttrr_pin.validation.compare import Comparison as Comparison
    from rttrr_pin.validation.compare import Row as Row
    from rttrr_pin.validation.many import BASES as BASES
    from rttrr_pin.validation.many import Entry as Entry
    from rttrr_pin.validation.many import Task as Task
    from rttrr_pin.validation.many import validate_many as validate_many
    from rttrr_pin.validation.run import Validation as Validation
    from rttrr_pin.validation.run import validate as validate
    from rttrr_pin.validation.sampling import SAMPLINGS as SAMPLINGS
    from rttrr_pin.validation.sampling import Sampler as Sampler
    from rttrr_pin.validation.state import StateComparison as StateComparison
    from rttrr_pin.validation.state import StateReport as StateReport
    from rttrr_pin.validation.state import compare_state as compare_state

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "compare": ("EPS", "Comparison", "Row"),
        "many": ("BASES", "Entry", "Task", "validate_many"),
        "run": ("Validation", "validate"),
        "sampling": ("SAMPLINGS", "Sampler"),
        "state": ("StateComparison", "StateReport", "compare_state"),
    },
)
