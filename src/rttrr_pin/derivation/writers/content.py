"""Closed forms as documents: what stands in them, and formulas in lines that fit a page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from rttrr_pin.derivation import QUANTITIES, Derivation, Symbol
from rttrr_pin.derivation.collect import Presenter
from rttrr_pin.derivation.latex import decimal, latex_number, latex_power
from rttrr_pin.derivation.symbols import Expression
from rttrr_pin.derivation.writers import document as doc
from rttrr_pin.derivation.writers import wording as words
from rttrr_pin.derivation.writers.glossary import Entry, glossary
from rttrr_pin.derivation.writers.printing import Notation, lines

ROOM = 47.0
"""Width of a line in em: a page of 210 mm with margins of 20 mm has 48."""

TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[^\\]")

EM = {
    **dict.fromkeys([r"\dot", r"\ddot", r"\mathrm", r"\left", r"\right"], 0.0),
    **dict.fromkeys("{} &", 0.0),
    r"\cdot": 0.73,
    r"\quad": 1.0,
    "+": 1.23,
    "-": 1.23,
    "(": 0.39,
    ")": 0.39,
    ",": 0.45,
    ".": 0.28,
    "=": 1.34,
    "*": 0.5,
    "M": 1.08,
    "N": 0.92,
    "F": 0.79,
    "C": 0.79,
    "J": 0.66,
    r"\omega": 0.63,
    r"\varphi": 0.66,
}
"""Widths in em of ten-point Computer Modern, spaces around operators included; any other letter counts as wide as q."""

LETTER = 0.56

SCRIPT = 0.75
"""A subscript's letters against those of the line; a little is added behind it."""

WIDTHS = (0.09, 0.53, 0.11, 0.27)
"""Symbol, meaning, unit, value."""


def document_of(derivation: Derivation, preface: str = "") -> doc.Document:
    """What a document says; the preface is a paragraph to put before all others."""
    return doc.Document(
        f"Dynamic model of {words.plain(derivation.robot.model.name)}", tuple(_blocks(derivation, preface))
    )


def _blocks(derivation: Derivation, preface: str) -> Iterator[doc.Block]:
    if preface:
        yield doc.Paragraph(_with_code(preface))
    yield from (doc.Paragraph(_with_code(text)) for text in words.conventions(derivation))
    yield doc.Paragraph(f"Links and joints: {words.names_of_links(derivation.robot.model)}.")
    if entries := glossary(derivation):
        yield doc.Heading("Symbols")
        yield doc.Table(("symbol", "meaning", "unit", "value"), tuple(map(_row, entries)), WIDTHS)
    if derivation.steps:
        yield doc.Heading(words.STEPS)
        yield doc.Paragraph(words.STEPS_MEANING)
        yield _equations(derivation, ((step.symbol.latex, step.terms) for step in derivation.steps))
    for name, derived in derivation.quantities.items():
        yield doc.Heading(words.TITLES[name])
        yield doc.Paragraph(words.heading(name))
        upper = [at for at in derived.terms if name != "M" or at[0] <= at[1]]  # of a symmetric matrix
        yield _equations(derivation, ((QUANTITIES[name].latex(at), derived.terms[at]) for at in upper))


def _with_code(text: str) -> doc.Text:
    """Words, with what stands between backquotes as code."""
    return tuple(doc.Code(part) if k % 2 else part for k, part in enumerate(text.split("`")))


def _row(entry: Entry) -> tuple[doc.Text, ...]:
    unit = entry.unit.replace("^2", "²").replace(" ", "\u00a0")
    value = "" if entry.value is None else doc.Formula(decimal(entry.value))
    return doc.Formula(entry.symbol.latex), entry.meaning, unit, value


def _equations(derivation: Derivation, named: Iterable[tuple[str, Expression]]) -> doc.Equations:
    """Polynomials with their names, but for those that only repeat their own name."""
    presenter, how = Presenter(derivation.symbols), notation(derivation.symbols)
    printed = [(left, lines(presenter.expression(terms), how, ROOM - width(left) - EM["="])) for left, terms in named]
    return doc.Equations(tuple((left, right) for left, right in printed if right != [left]))


def notation(symbols: Mapping[str, Symbol]) -> Notation:
    """The notation of formulas in these symbols."""
    return Notation(latex_number, lambda name, power: latex_power(symbols[name], power), r" \cdot ", width, r"\quad ")


def width(latex: str) -> float:
    """How wide a formula prints, in em, rather too much than too little."""
    total, scale, pending = 0.0, [1.0], False
    for token in TOKEN.findall(latex):
        if token in "_^":
            pending = True
        elif token == "{":
            scale.append(scale[-1] * (SCRIPT if pending else 1.0))
            pending = False
        elif token == "}":
            scale.pop()
        else:
            total += EM.get(token, LETTER) * scale[-1] * (SCRIPT if pending else 1.0) + 0.05 * pending
            pending = False
    return total
