"""Errata sheets: what an audit found, as a document that can be sent to the authors."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rttrr_pin.auditing.errata.content import sheet_of
from rttrr_pin.auditing.errata.html import html
from rttrr_pin.auditing.errata.latex import latex
from rttrr_pin.auditing.errata.markdown import markdown
from rttrr_pin.auditing.errata.sheet import Sheet
from rttrr_pin.auditing.results import AuditResult

WRITERS: Mapping[str, Callable[[Sheet], str]] = {"markdown": markdown, "latex": latex, "html": html}
"""A new format is a module here with a function from a sheet to its text, an entry, and an option of `audit`."""


def errata(result: AuditResult, form: str) -> str:
    """The errata sheet of an audit.

    Args:
        result: the audit.
        form: "markdown", "latex" or "html".
    """
    return WRITERS[form](sheet_of(result))


__all__ = ["WRITERS", "errata"]
