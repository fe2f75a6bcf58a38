"""What is wrong with a robot's file, what looks wrong, what other programs do with it, and what can be mended."""

from __future__ import annotations

from rttrr_pin.inspection.fix import Repaired, repair
from rttrr_pin.inspection.parsers import CONSUMERS, RULES
from rttrr_pin.inspection.results import Does, Finding, Inspection, LinkRow, Severity, Verdict
from rttrr_pin.inspection.run import inspect
from rttrr_pin.inspection.table import CHECKS

__all__ = [
    "CHECKS",
    "CONSUMERS",
    "RULES",
    "Does",
    "Finding",
    "Inspection",
    "LinkRow",
    "Repaired",
    "Severity",
    "Verdict",
    "inspect",
    "repair",
]
