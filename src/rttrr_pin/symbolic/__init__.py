"""Closed forms: the recursion run on symbols, taken apart and written out or step by step."""

from __future__ import annotations

from rttrr_pin.symbolic.chain import Letters, SymbolicRobot, almost_right_angles, default_letters, payload_letters
from rttrr_pin.symbolic.forms import FORMS, Derivation, Derived, derive, only_leaf
from rttrr_pin.symbolic.quantities import DEFAULT, SUBJECTS
from rttrr_pin.symbolic.symbols import Symbol

__all__ = [
    "DEFAULT",
    "FORMS",
    "SUBJECTS",
    "Derivation",
    "Derived",
    "Letters",
    "Symbol",
    "SymbolicRobot",
    "almost_right_angles",
    "default_letters",
    "derive",
    "only_leaf",
    "payload_letters",
]
