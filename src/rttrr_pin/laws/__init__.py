"""Laws of mechanics, which need no other program."""

from __future__ import annotations

from rttrr_pin.laws.law import Law
from rttrr_pin.laws.run import LAWS, LawReport, LawRow, check_laws

__all__ = ["LAWS", "Law", "LawReport", "LawRow", "check_laws"]
