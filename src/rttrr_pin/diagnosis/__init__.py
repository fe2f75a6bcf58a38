"""Why two programs differ: the cause, or the smallest set of causes, that brings the difference down to rounding."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.diagnosis.descriptions.compare import Comparison as Comparison
    from rttrr_pin.diagnosis.descriptions.compare import compare_robots as compare_robots
    from rttrr_pin.diagnosis.descriptions.difference import Difference as Difference
    from rttrr_pin.diagnosis.descriptions.effects_of import Effect as Effect
    from rttrr_pin.diagnosis.logs.log import Log as Log
    from rttrr_pin.diagnosis.logs.log import is_log as is_log
    from rttrr_pin.diagnosis.logs.log import read_log as read_log
    from rttrr_pin.diagnosis.logs.log_diagnosis import JointResidual as JointResidual
    from rttrr_pin.diagnosis.logs.log_diagnosis import LogCause as LogCause
    from rttrr_pin.diagnosis.logs.log_diagnosis import LogDiagnosis as LogDiagnosis
    from rttrr_pin.diagnosis.logs.log_diagnosis import diagnose_log as diagnose_log
    from rttrr_pin.diagnosis.results import Cause as Cause
    from rttrr_pin.diagnosis.results import Diagnosis as Diagnosis
    from rttrr_pin.diagnosis.results import NearMiss as NearMiss
    from rttrr_pin.diagnosis.results import Residual as Residual
    from rttrr_pin.diagnosis.run import diagnose as diagnose
    from rttrr_pin.diagnosis.states import Sample as Sample
    from rttrr_pin.diagnosis.states import sample_states as sample_states

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "descriptions.compare": ("Comparison", "compare_robots"),
        "run": ("diagnose",),
        "descriptions.difference": ("Difference",),
        "descriptions.effects_of": ("Effect",),
        "logs.log": ("Log", "is_log", "read_log"),
        "logs.log_diagnosis": ("JointResidual", "LogCause", "LogDiagnosis", "diagnose_log"),
        "results": ("Cause", "Diagnosis", "NearMiss", "Residual"),
        "states": ("Sample", "sample_states"),
    },
)
