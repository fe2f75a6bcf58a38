"""Closed forms as documents and programs.

A new format is one module with a function that fulfils `Writer`, and one line in `WRITERS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from rttrr_pin.derivation import Derivation
from rttrr_pin.derivation.writers.c import c
from rttrr_pin.derivation.writers.latex import latex
from rttrr_pin.derivation.writers.markdown import markdown
from rttrr_pin.derivation.writers.python import python
from rttrr_pin.derivation.writers.table import show_derivation

__all__ = ["WRITERS", "Writer", "show_derivation"]


class Writer(Protocol):
    """Writes closed forms in one format."""

    def __call__(self, derivation: Derivation, preface: str = "") -> str:
        """The whole text; `preface` is a paragraph to put before all others."""


WRITERS: Mapping[str, Writer] = {"latex": latex, "markdown": markdown, "python": python, "c": c}
"""By format."""
