"""Expressions as lines of text, in any notation: what all writers of closed forms share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from rttrr_pin.derivation.collect import Power, Product, Sum

FULL = 0.6
"""How much of a line is filled before it may end."""


@dataclass(frozen=True)
class Notation:
    """How one language writes the parts of an expression.

    Attributes:
        number: a positive number.
        power: a symbol to a power, 1 or more.
        times: what stands between factors.
        width: how much room a piece of text takes.
        indent: what a line that goes on within a bracket begins with.
    """

    number: Callable[[Fraction], str]
    power: Callable[[str, int], str]
    times: str
    width: Callable[[str], float]
    indent: str


class Piece(NamedTuple):
    """Part of a line, before which the line may be broken, and how many brackets are open there."""

    text: str
    depth: int


def lines(expression: Sum, notation: Notation, room: float) -> list[str]:
    """An expression in lines that fit; all but the first begin with + or -, some of them indented.

    Args:
        expression: to be printed.
        notation: how.
        room: width of a line; only a single product wider than it makes a longer line.
    """
    chunks: list[list[Piece]] = []
    bracket = False
    for pieces in _terms(expression, notation, 0):
        if not chunks or bracket or len(pieces) > 1:  # what has brackets stands for itself
            chunks.append([])
        bracket = len(pieces) > 1
        chunks[-1] += pieces
    return [line for pieces in chunks for line in _filled(pieces, notation, room)] or [notation.number(Fraction(0))]


def _filled(pieces: Sequence[Piece], notation: Notation, room: float) -> Iterator[str]:
    """Pieces in lines, each broken where the fewest brackets are open, and as late as can be."""
    widths = [notation.width(piece.text) for piece in pieces]
    start = 0
    while start < len(pieces):
        indent = notation.indent if pieces[start].depth else ""
        left = room - notation.width(indent) - widths[start]
        end, breaks = start + 1, []
        while end < len(pieces) and widths[end] <= left:
            left -= widths[end]
            end += 1
            breaks += [end] if left < (1 - FULL) * room else []
        if end < len(pieces) and breaks:
            end = min(breaks, key=lambda at: (pieces[at].depth, -at))
        line = "".join(piece.text for piece in pieces[start:end])
        yield indent + line.lstrip()
        start = end


def _terms(expression: Sum, notation: Notation, depth: int) -> Iterator[list[Piece]]:
    """The terms, each in pieces that a line may end behind."""
    for k, term in enumerate(expression.terms):
        first, *others = _product(term, notation, depth)
        sign = "-" if term.coefficient < 0 else "+"
        signed = f" {sign} {first.text}" if k else f"-{first.text}" if sign == "-" else first.text
        yield [Piece(signed, depth), *others]


def _product(term: Product, notation: Notation, depth: int) -> list[Piece]:
    """A product without its sign; its brackets are where it may be broken."""
    number = abs(term.coefficient)
    pieces = [Piece(notation.number(number) if number != 1 or not term.factors else "", depth)]
    for k, factor in enumerate(term.factors):
        more = notation.times if k or pieces[-1].text else ""
        if isinstance(factor, Power):
            pieces = _longer(pieces, more + notation.power(factor.name, factor.exponent))
            continue
        first, *others = [piece for pieces in _terms(factor, notation, depth + 1) for piece in pieces]
        pieces = _longer([*_longer(pieces, f"{more}({first.text}"), *others], ")")
    return pieces


def _longer(pieces: Sequence[Piece], more: str) -> list[Piece]:
    *others, last = pieces
    return [*others, Piece(last.text + more, last.depth)]
