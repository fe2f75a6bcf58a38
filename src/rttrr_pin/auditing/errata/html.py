"""Errata sheets as one HTML file: MathML, no scripts, nothing to load; changed terms are marked."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

from rttrr_pin.auditing.errata.sheet import Sheet, program
from rttrr_pin.auditing.errata.typeset import settable

MATHML = "{http://www.w3.org/1998/Math/MathML}"


def html(sheet: Sheet) -> str:
    """The sheet as an HTML document."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("rttrr_pin.auditing.errata", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"mathml": mathml, "kind": kind, "program": program}
    return environment.get_template("errata.html").render(sheet=sheet)


def kind(part: object) -> str:
    """The name of a block or piece, by which the template chooses."""
    return type(part).__name__


def mathml(tex: str) -> Any:
    """A formula as MathML, safe to stand in a page; as escaped code where it cannot be set."""
    from latex2mathml.converter import convert
    from markupsafe import Markup

    if not settable(tex):
        return Markup("<code>{}</code>").format(tex)
    text = convert(tex)
    if not all(element.tag.startswith(MATHML) for element in ElementTree.fromstring(text).iter()):
        return Markup("<code>{}</code>").format(tex)
    return Markup(text)
