"""Laws of mechanics, which need no other program."""

from __future__ import annotations

from rttrr_pin.laws.run import LawReport, LawRow, check_laws
from rttrr_pin.laws.table import LAWS, Law

__all__ = ["LAWS", "Law", "LawReport", "LawRow", "check_laws"]
