"""Closed forms as documents and programs.

A new format is one module with a function that fulfils `Writer`, and one line in `WRITERS`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Protocol

from rttrr_pin.derivation import Derivation
from rttrr_pin.derivation.writers.table import show_derivation

__all__ = ["WRITERS", "Writer", "show_derivation"]


class Writer(Protocol):
    """Writes closed forms in one format."""

    def __call__(self, derivation: Derivation, preface: str = "") -> str:
        """The whole text; `preface` is a paragraph to put before all others."""


class Writers(Mapping[str, Writer]):
    """Writers by format, each loaded when it is asked for: C needs the compiler's names, and others do not."""

    FORMATS = ("latex", "markdown", "python", "c")

    def __getitem__(self, name: str) -> Writer:
        if name not in self.FORMATS:
            raise KeyError(name)
        writer: Writer = getattr(import_module(f"{__name__}.{name}"), name)
        return writer

    def __iter__(self) -> Iterator[str]:
        return iter(self.FORMATS)

    def __len__(self) -> int:
        return len(self.FORMATS)


WRITERS = Writers()
"""By format."""
