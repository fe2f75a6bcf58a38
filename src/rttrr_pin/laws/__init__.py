"""Laws of mechanics, which need no other program."""

from __future__ import annotations

from rttrr_pin.laws.run import LawReport, LawRow, check_laws

__all__ = ["LawReport", "LawRow", "check_laws"]
