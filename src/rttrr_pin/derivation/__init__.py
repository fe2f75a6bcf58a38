"""Closed forms: the recursion run on symbols, taken apart and written out or step by step."""

from __future__ import annotations

from rttrr_pin.derivation.chain import Letters, SymbolicRobot, almost_right_angles, default_letters, payload_letters
from rttrr_pin.derivation.forms import FORMS, Derivation, Derived, derive, only_leaf
from rttrr_pin.derivation.quantities import DEFAULT, SUBJECTS
from rttrr_pin.derivation.symbols import Symbol

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
