"""Closed forms: the recursion run on symbols, taken apart and written out or step by step."""

from __future__ import annotations

from rttrr_pin.symbolic.chain import Letters, SymbolicRobot, default_letters
from rttrr_pin.symbolic.forms import FORMS, Derivation, Derived, derive
from rttrr_pin.symbolic.quantities import SUBJECTS
from rttrr_pin.symbolic.symbols import Symbol

__all__ = [
    "FORMS",
    "SUBJECTS",
    "Derivation",
    "Derived",
    "Letters",
    "Symbol",
    "SymbolicRobot",
    "default_letters",
    "derive",
]
