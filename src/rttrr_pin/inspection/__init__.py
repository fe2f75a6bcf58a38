"""What is wrong with a robot's file, what looks wrong, what other programs do with it, and what can be mended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.inspection.bodies import LinkRow as LinkRow
    from rttrr_pin.inspection.checks import Finding as Finding
    from rttrr_pin.inspection.checks import Severity as Severity
    from rttrr_pin.inspection.parsers import RULES as RULES
    from rttrr_pin.inspection.rule import PARSERS as PARSERS
    from rttrr_pin.inspection.rule import Behaviour as Behaviour
    from rttrr_pin.inspection.rule import RuleMatch as RuleMatch
    from rttrr_pin.inspection.rule import Verdict as Verdict
    from rttrr_pin.inspection.run import CHECKS as CHECKS
    from rttrr_pin.inspection.run import Inspection as Inspection
    from rttrr_pin.inspection.run import Repaired as Repaired
    from rttrr_pin.inspection.run import inspect as inspect
    from rttrr_pin.inspection.run import repair as repair

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "bodies": ("LinkRow",),
        "checks": ("Finding", "Severity"),
        "parsers": ("RULES",),
        "rule": ("PARSERS", "Behaviour", "RuleMatch", "Verdict"),
        "run": ("CHECKS", "Inspection", "Repaired", "inspect", "repair"),
    },
)
