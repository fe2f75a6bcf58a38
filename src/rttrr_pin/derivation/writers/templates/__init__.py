"""Texts with places for what is derived: pages and programs, by Jinja."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


def rendered(name: str, filters: Mapping[str, Callable[..., Any]], **values: Any) -> str:
    """A template of this folder, filled in; in HTML every value is escaped.

    Args:
        name: of the file.
        filters: functions that the template applies to values.
        values: by the names that the template has for them.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

    environment = Environment(
        loader=PackageLoader(__package__ or "", "."),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= filters
    return environment.get_template(name).render(**values)
