"""Documents as one HTML file: MathML, no scripts, nothing to load; changed terms are marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from rttrr_pin.derivation.writers.document import Block, Document, pieces
from rttrr_pin.derivation.writers.templates import rendered
from rttrr_pin.derivation.writers.typeset import settable

if TYPE_CHECKING:
    from markupsafe import Markup

MATHML = "{http://www.w3.org/1998/Math/MathML}"


def html(document: Document) -> str:
    """A document as HTML."""
    return rendered("document.html", FILTERS, document=document)


def part(blocks: Sequence[Block]) -> Markup:
    """Some blocks as a part of a page."""
    from markupsafe import Markup

    return Markup(rendered("part.html", FILTERS, blocks=blocks))


def mathml(tex: str) -> Any:
    """A formula as MathML, safe to stand in a page; as escaped code where it cannot be set."""
    from latex2mathml.converter import convert
    from markupsafe import Markup

    if settable(tex):
        text = convert(tex)
        if all(element.tag.startswith(MATHML) for element in ElementTree.fromstring(text).iter()):
            return Markup(text)
    return Markup("<code>{}</code>").format(tex)


FILTERS = {"mathml": mathml, "pieces": pieces, "kind": lambda part: type(part).__name__}
"""What the templates apply to values."""
