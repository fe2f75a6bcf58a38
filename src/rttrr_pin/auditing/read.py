"""Stage 1: the text of an equation -> its terms, in every way that it can be divided into components."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial

from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm, Reading, Split
from rttrr_pin.auditing.publication import Equation, Publication
from rttrr_pin.auditing.reading.abbreviations import expanded
from rttrr_pin.auditing.reading.ambiguity import joined, ways
from rttrr_pin.auditing.reading.component import check_length, printed_component
from rttrr_pin.auditing.reading.grammar import UnreadableError, parse, tokens_of, without_time
from rttrr_pin.auditing.reading.layout import Part, layouts
from rttrr_pin.auditing.reading.nodes import Atom, Group
from rttrr_pin.auditing.reading.python import read_python
from rttrr_pin.auditing.reading.trees import products_of
from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.derivation.symbols import factors_of

Abbreviations = Mapping[Atom, Group]

MULTIPLES = 24
"""A number is read as a multiple of gravity where the factor is as simple as 4 or 3/2: 7 is no multiple of 9.8."""

TIME = Atom("t")

GRAVITIES = tuple(map(Fraction, ("9.8", "9.81", "9.807", "9.8066", "9.80665")))
"""What is printed for the acceleration of gravity where it has no letter."""


def read(publication: Publication, equation: Equation) -> tuple[Split, ...]:
    """The terms of an equation; several ways where its text does not show where components end."""
    if publication.language == "latex" and len(equation.texts) == 1:
        splits = read_latex(
            equation.texts[0],
            publication.vocabulary,
            len(equation.names),
            publication.latex_abbreviations,
            bool(equation.columns),
        )
        return tuple(replace(x, components=tuple(_with_gravity(c, publication) for c in x.components)) for x in splits)
    return (Split(tuple(read_component(publication, text) for text in equation.texts)),)


def read_component(publication: Publication, text: str) -> PrintedComponent:
    """The terms of one component whose text stands by itself."""
    if publication.language == "latex":
        component = read_latex(text, publication.vocabulary, 1, publication.latex_abbreviations)[0].components[0]
    else:
        component = read_python(text, publication.spellings, publication.python_abbreviations)
    return _with_gravity(component, publication)


def read_latex(
    text: str,
    vocabulary: Vocabulary,
    components: int = 1,
    abbreviations: Abbreviations | None = None,
    grid: bool = False,
) -> tuple[Split, ...]:
    r"""Reads a printed equation.

    Args:
        text: what stands between the display's delimiters: sums of products of symbols, sines and cosines of
            coordinates, numbers and brackets; in rows, in a matrix, with a left-hand side and a number or without.
        vocabulary: what its symbols mean. One that it lacks is kept under a name of its own and stands in
            `Reading.unknown`.
        components: how many the equation states.
        abbreviations: what symbols stand for that other equations define.
        grid: whether its matrix may have rows and columns.

    Returns:
        The ways to divide it into components: one where the boundaries are printed. What cannot be read is no
        exception: `PrintedComponent.unparsed` says where and why, and nothing of that component is given.
    """
    try:
        check_length(text)
        tokens = tokens_of(text)
        if TIME not in vocabulary:
            tokens = without_time(tokens)
        divisions = layouts(tokens, text, components, grid)
    except UnreadableError as error:
        unread = PrintedComponent(" ".join(text.split()), (), error.placed(text))
        return (Split((unread,) * components),)
    read_part = partial(_component, vocabulary=vocabulary, abbreviations=abbreviations or {}, text=text)
    return tuple(Split(tuple(map(read_part, parts)), note) for parts, note in divisions)


def _component(part: Part, vocabulary: Vocabulary, abbreviations: Abbreviations, text: str) -> PrintedComponent:
    return printed_component(
        lambda: expanded(products_of(parse(part.tokens(), part.end)), abbreviations),
        text[part.start : part.end],
        text,
        partial(ways, vocabulary=vocabulary),
    )


def _with_gravity(component: PrintedComponent, publication: Publication) -> PrintedComponent:
    """Terms with a number such as 9.81 may also be read with the letter of gravity, where the robot has one."""
    letters = publication.gravity
    if not letters or not component.terms:
        return component
    return replace(component, terms=tuple(_gravity_read(term, letters) for term in component.terms))


def _gravity_read(term: PrintedTerm, letters: Mapping[str, str]) -> PrintedTerm:
    more: list[Reading] = []
    for reading in term.readings:
        if any(name in letters for name, _ in reading.factors):
            continue
        for number in GRAVITIES:
            rest = reading.coefficient / number
            if rest and MULTIPLES % rest.denominator == 0 and abs(rest.numerator) <= MULTIPLES:
                more += [
                    replace(
                        reading,
                        coefficient=rest,
                        factors=factors_of({**dict(reading.factors), name: 1}),
                        note=joined(reading.note, f"the number {float(number):g} read as `{letter}`"),
                    )
                    for name, letter in letters.items()
                ]
    return replace(term, readings=(*term.readings, *more)) if more else term
