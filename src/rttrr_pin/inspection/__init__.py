"""What is wrong with a robot's file, what looks wrong, what other programs do with it, and what can be mended."""

from __future__ import annotations

from rttrr_pin.inspection.fix import Repaired, repair
from rttrr_pin.inspection.parsers import PARSERS, RULES
from rttrr_pin.inspection.results import Behaviour, Finding, LinkRow, RuleMatch, Severity, Verdict
from rttrr_pin.inspection.run import Inspection, inspect
from rttrr_pin.inspection.table import CHECKS

__all__ = [
    "CHECKS",
    "PARSERS",
    "RULES",
    "Behaviour",
    "Finding",
    "Inspection",
    "LinkRow",
    "Repaired",
    "RuleMatch",
    "Severity",
    "Verdict",
    "inspect",
    "repair",
]
