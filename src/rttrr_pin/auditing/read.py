"""Stage 1: the text of an equation -> its terms, in every way that it can be divided into components."""

from __future__ import annotations

from functools import partial

from rttrr_pin.auditing.printed import PrintedComponent, Split
from rttrr_pin.auditing.publication import Equation, Publication
from rttrr_pin.auditing.reading.ambiguity import ways
from rttrr_pin.auditing.reading.grammar import UnreadableError, parse
from rttrr_pin.auditing.reading.layout import Part, layouts
from rttrr_pin.auditing.reading.multiply import terms_of
from rttrr_pin.auditing.reading.python import read_python
from rttrr_pin.auditing.reading.trees import products_of
from rttrr_pin.auditing.reading.vocabulary import Vocabulary


def read(publication: Publication, equation: Equation) -> tuple[Split, ...]:
    """The terms of an equation; several ways where its text does not show where components end."""
    if publication.language == "latex" and len(equation.texts) == 1:
        return read_latex(equation.texts[0], publication.vocabulary, max(1, len(equation.components)))
    return (Split(tuple(read_component(publication, text) for text in equation.texts)),)


def read_component(publication: Publication, text: str) -> PrintedComponent:
    """The terms of one component whose text stands by itself."""
    if publication.language == "latex":
        return read_latex(text, publication.vocabulary)[0].components[0]
    return read_python(text, publication.spellings)


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
        divisions = layouts(text, components)
    except UnreadableError as error:
        unread = PrintedComponent(" ".join(text.split()), (), error.placed(text))
        return (Split((unread,) * components),)
    return tuple(Split(tuple(_component(part, vocabulary, text) for part in parts), note) for parts, note in divisions)


def _component(part: Part, vocabulary: Vocabulary, text: str) -> PrintedComponent:
    printed = " ".join(text[part.start : part.end].split())
    try:
        products = products_of(parse(part.tokens(), part.end))
        return PrintedComponent(printed, terms_of(products, text, partial(ways, vocabulary=vocabulary)))
    except UnreadableError as error:
        return PrintedComponent(printed, (), error.placed(text))
    except RecursionError:
        fault = UnreadableError("too many brackets in each other; print them expanded", part.start)
        return PrintedComponent(printed, (), fault.placed(text))
