"""One component from its products, in any language: a sum of terms, or a quotient of two sums."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rttrr_pin.auditing.printed import PrintedComponent
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.multiply import Ways, terms_of
from rttrr_pin.auditing.reading.nodes import DividesError, Product
from rttrr_pin.auditing.reading.quotient import quotient_of

LONGEST = 12_000
"""Characters of one text: the longest of the paper has 6,000."""


def check_length(text: str) -> None:
    """Raises UnreadableError where a text is longer than any equation."""
    if len(text) > LONGEST:
        raise UnreadableError(f"the text has more than {LONGEST:,} characters; give it in parts", 0)


def printed_component(products: Callable[[], Sequence[Product]], part: str, text: str, ways: Ways) -> PrintedComponent:
    """What is printed for a component.

    Args:
        products: reads them.
        part: what is printed for it.
        text: the whole text, which places are counted in.
        ways: gives every way to read the factors of a product.

    Returns:
        Its terms, or its quotient; `PrintedComponent.unparsed` says why it cannot be read, and where.
    """
    printed = " ".join(part.split())
    try:
        check_length(part)
        read_products = products()
        try:
            return PrintedComponent(printed, terms_of(read_products, text, ways))
        except DividesError:
            return PrintedComponent(printed, (), quotient=quotient_of(read_products, ways))
    except UnreadableError as error:
        return PrintedComponent(printed, (), error.placed(text))
    except (RecursionError, MemoryError):
        fault = UnreadableError("too many brackets in each other, or terms, to be read; print it in parts", 0)
        return PrintedComponent(printed, (), fault.placed(text))
