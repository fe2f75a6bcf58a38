"""Closed forms: the recursion run on symbols, taken apart and written out or step by step."""

from __future__ import annotations

from rttrr_pin.derivation.forms import FORMS, Derivation, Derived, derive, only_leaf
from rttrr_pin.derivation.quantities import DEFAULT, QUANTITIES
from rttrr_pin.derivation.symbolic_robot import (
    ParameterSymbols,
    SymbolicRobot,
    almost_right_angles,
    default_symbols,
    payload_symbols,
)
from rttrr_pin.derivation.symbols import Symbol

__all__ = [
    "DEFAULT",
    "FORMS",
    "QUANTITIES",
    "Derivation",
    "Derived",
    "ParameterSymbols",
    "Symbol",
    "SymbolicRobot",
    "almost_right_angles",
    "default_symbols",
    "derive",
    "only_leaf",
    "payload_symbols",
]
