"""Results as people and programs read them: tables for a terminal, JSON for everything else."""

from __future__ import annotations

from rttrr_pin.report.audit import audit_data, show_audit, show_equations
from rttrr_pin.report.data import as_json, state_data, validation_data, write_whole
from rttrr_pin.report.errata import errata
from rttrr_pin.report.inspection import inspection_data, repair_data, show_inspection, show_repair
from rttrr_pin.report.laws import laws_data, show_laws
from rttrr_pin.report.many import many_data, show_many
from rttrr_pin.report.search import search_data, show_search
from rttrr_pin.report.text import show_state, show_validation

__all__ = [
    "as_json",
    "audit_data",
    "errata",
    "inspection_data",
    "laws_data",
    "many_data",
    "repair_data",
    "search_data",
    "show_audit",
    "show_equations",
    "show_inspection",
    "show_laws",
    "show_many",
    "show_repair",
    "show_search",
    "show_state",
    "show_validation",
    "state_data",
    "validation_data",
    "write_whole",
]
