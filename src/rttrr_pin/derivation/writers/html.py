"""Documents as one HTML file: MathML, no scripts, nothing to load; changed terms are marked."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

from rttrr_pin.derivation.writers.document import Document, pieces
from rttrr_pin.derivation.writers.templates import rendered
from rttrr_pin.derivation.writers.typeset import settable

MATHML = "{http://www.w3.org/1998/Math/MathML}"


def html(document: Document) -> str:
    """A document as HTML."""
    filters = {"mathml": mathml, "pieces": pieces, "kind": lambda part: type(part).__name__}
    return rendered("document.html", filters, document=document)


def mathml(tex: str) -> Any:
    """A formula as MathML, safe to stand in a page; as escaped code where it cannot be set."""
    from latex2mathml.converter import convert
    from markupsafe import Markup

    if settable(tex):
        text = convert(tex)
        if all(element.tag.startswith(MATHML) for element in ElementTree.fromstring(text).iter()):
            return Markup(text)
    return Markup("<code>{}</code>").format(tex)
