"""Why two programs differ: the cause, or the smallest set of causes, that brings the difference down to rounding."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.diagnosis.compare import Comparison as Comparison
    from rttrr_pin.diagnosis.compare import compare_robots as compare_robots
    from rttrr_pin.diagnosis.difference import Difference as Difference
    from rttrr_pin.diagnosis.effects_of import Effect as Effect
    from rttrr_pin.diagnosis.states import Sample as Sample
    from rttrr_pin.diagnosis.states import sample_states as sample_states

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "compare": ("Comparison", "compare_robots"),
        "difference": ("Difference",),
        "effects_of": ("Effect",),
        "states": ("Sample", "sample_states"),
    },
)
