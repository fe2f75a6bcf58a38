"""From the LaTeX of a printed equation to its terms, each with every way it can be read."""

from __future__ import annotations

from rttrr_pin.auditing.printed import PrintedComponent, Split
from rttrr_pin.auditing.reading.grammar import UnreadableError, parse
from rttrr_pin.auditing.reading.layout import Part, layouts
from rttrr_pin.auditing.reading.products import terms_of
from rttrr_pin.auditing.reading.trees import products_of
from rttrr_pin.auditing.reading.vocabulary import Vocabulary


def read_latex(text: str, vocabulary: Vocabulary, components: int = 1) -> tuple[Split, ...]:
    r"""Reads a printed equation.

    Args:
        text: what stands between the display's delimiters: sums of products of symbols, sines and cosines of
            coordinates, numbers and brackets; in rows, in a matrix, with a left-hand side and a number or without.
        vocabulary: what its symbols mean. One that it lacks is kept under a name of its own and stands in
            `Reading.unknown`.
        components: how many the equation states.

    Returns:
        The ways to divide it into components: one where the boundaries are printed. What cannot be read is no
        exception: `PrintedComponent.unparsed` says where and why, and nothing of that component is given.
    """
    try:
        ways = layouts(text, components)
    except UnreadableError as error:
        unread = PrintedComponent(" ".join(text.split()), (), error.placed(text))
        return (Split((unread,) * components),)
    return tuple(Split(tuple(_component(part, vocabulary, text) for part in way.parts), way.note) for way in ways)


def _component(part: Part, vocabulary: Vocabulary, text: str) -> PrintedComponent:
    printed = " ".join(text[part.start : part.end].split())
    try:
        if part.fault is not None:
            raise part.fault
        products = products_of(parse(part.tokens, part.end))
        return PrintedComponent(printed, terms_of(products, vocabulary, text))
    except UnreadableError as error:
        return PrintedComponent(printed, (), error.placed(text))
    except RecursionError:
        fault = UnreadableError("too many brackets in each other; print them expanded", part.start)
        return PrintedComponent(printed, (), fault.placed(text))
