"""Elements of SVG and HTML in which every text is only a text."""

from __future__ import annotations

import re
from collections.abc import Iterable

from markupsafe import Markup, escape

from rttrr_pin.core.arrays import Array
from rttrr_pin.reporting.output import shown

Value = str | float | None


def element(tag: str, *children: str | Markup, **attributes: Value) -> Markup:
    """An element; what is no Markup yet is escaped, and control characters are question marks.

    Args:
        tag: its name.
        children: texts and elements.
        attributes: `class_` is class, `stroke_width` is stroke-width; those that are None are left out.
    """
    words = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{text(_written(value))}"'
        for name, value in attributes.items()
        if value is not None
    )
    inside = "".join(map(text, children))
    return Markup(f"<{tag}{words}>{inside}</{tag}>" if inside else f"<{tag}{words}/>")


def text(value: str | Markup) -> Markup:
    """A text as markup."""
    return value if isinstance(value, Markup) else escape(shown(value))


def joined(parts: Iterable[Markup]) -> Markup:
    """Elements one after the other."""
    return Markup("").join(parts)


def _written(value: str | float) -> str:
    return value if isinstance(value, str) else short(value)


def slug(name: str) -> str:
    """A name in letters that every file system has."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")[:40] or "unnamed"


def short(value: float) -> str:
    """A length on a page, to a tenth: 12, 0.5, -3.2."""
    words = f"{value:.1f}"
    return words.removesuffix(".0") if words != "-0.0" else "0"


def path(x: Array, y: Array, closed: bool = False) -> str:
    """A line through points, as the attribute `d`; it is interrupted where a point is not finite."""
    parts, begun = [], False
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        if a - a == 0.0 and b - b == 0.0:  # neither is NaN or infinite
            parts.append(f"{'L' if begun else 'M'}{short(a)} {short(b)}")
            begun = True
        else:
            begun = False
    return "".join(parts) + "Z" * (closed and bool(parts))
