"""Closed forms as documents and programs.

A new format of documents is one module with a function from `Document` to text, and one line in `WRITERS`; a new
programming language is one `Language` with its template.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from rttrr_pin.derivation import Derivation
from rttrr_pin.derivation.writers.content import document_of
from rttrr_pin.derivation.writers.document import Document
from rttrr_pin.derivation.writers.html import html
from rttrr_pin.derivation.writers.latex import latex
from rttrr_pin.derivation.writers.markdown import markdown
from rttrr_pin.derivation.writers.programs import PYTHON, C
from rttrr_pin.derivation.writers.table import show_derivation

__all__ = ["WRITERS", "Writer", "show_derivation"]


class Writer(Protocol):
    """Writes closed forms in one format."""

    def __call__(self, derivation: Derivation, preface: str = "") -> str:
        """The whole text; `preface` is a paragraph to put before all others."""


def _as(write: Callable[[Document], str]) -> Writer:
    return lambda derivation, preface="": write(document_of(derivation, preface))


WRITERS: Mapping[str, Writer] = {
    "latex": _as(latex),
    "markdown": _as(markdown),
    "html": _as(html),
    "python": PYTHON,
    "c": C,
}
"""By format."""
