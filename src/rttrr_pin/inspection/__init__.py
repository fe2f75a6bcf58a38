"""What is wrong with a robot's file, what looks wrong, what other programs do with it, and what can be mended."""

from __future__ import annotations

from rttrr_pin.inspection.bodies import LinkRow
from rttrr_pin.inspection.checks import Finding, Severity
from rttrr_pin.inspection.parsers import PARSERS, RULES, Behaviour, RuleMatch, Verdict
from rttrr_pin.inspection.run import CHECKS, Inspection, Repaired, inspect, repair

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
