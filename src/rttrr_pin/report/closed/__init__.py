"""Closed forms as documents and programs.

A new format is one module with a function that fulfils `Writer`, and one line in `WRITERS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from rttrr_pin.report.closed.c import c
from rttrr_pin.report.closed.latex import latex
from rttrr_pin.report.closed.markdown import markdown
from rttrr_pin.report.closed.python import python
from rttrr_pin.report.closed.table import show_derivation
from rttrr_pin.symbolic import Derivation

__all__ = ["WRITERS", "Writer", "show_derivation"]


class Writer(Protocol):
    """Writes closed forms in one format."""

    def __call__(self, derivation: Derivation, preface: str = "") -> str:
        """The whole text; `preface` is a paragraph to put before all others."""


WRITERS: Mapping[str, Writer] = {"latex": latex, "markdown": markdown, "python": python, "c": c}
"""By format."""
