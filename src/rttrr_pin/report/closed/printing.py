"""Expressions as lines of text, in any notation: what all writers of closed forms share."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from rttrr_pin.symbolic.tree import Power, Product, Sum


@dataclass(frozen=True)
class Notation:
    """How one language writes the parts of an expression.

    Attributes:
        number: a positive number.
        power: a symbol to a power, 1 or more.
        times: what stands between factors.
        width: how much room a piece of text takes.
    """

    number: Callable[[Fraction], str]
    power: Callable[[str, int], str]
    times: str
    width: Callable[[str], float]


def lines(expression: Sum, notation: Notation, room: float) -> list[str]:
    """An expression in lines that fit; all but the first begin with + or -.

    Args:
        expression: to be printed.
        notation: how.
        room: width of a line; only a single product wider than it makes a longer line.
    """
    done: list[str] = []
    line, taken, bracket = "", 0.0, False
    for pieces in _terms(expression, notation):
        fresh = bracket or len(pieces) > 1  # what has brackets stands for itself
        bracket = len(pieces) > 1
        for piece in pieces:
            width = notation.width(piece)
            if line and (fresh or taken + width > room):
                done.append(line)
                line, taken, piece = "", 0.0, piece.lstrip()
            fresh = False
            line, taken = line + piece, taken + width
    return [*done, line] if line else [notation.number(Fraction(0))]


def text(expression: Sum, notation: Notation) -> str:
    """An expression in one line."""
    return "".join(piece for pieces in _terms(expression, notation) for piece in pieces) or notation.number(Fraction(0))


def _terms(expression: Sum, notation: Notation) -> Iterator[list[str]]:
    """The terms, each in pieces that a line may end behind."""
    for k, term in enumerate(expression.terms):
        pieces = _product(term, notation)
        sign = "-" if term.coefficient < 0 else "+"
        pieces[0] = f" {sign} {pieces[0]}" if k else f"-{pieces[0]}" if sign == "-" else pieces[0]
        yield pieces


def _product(term: Product, notation: Notation) -> list[str]:
    """A product without its sign; its brackets are where it may be broken."""
    number = abs(term.coefficient)
    pieces = [notation.number(number)] if number != 1 or not term.factors else [""]
    for k, factor in enumerate(term.factors):
        if k or pieces[-1]:
            pieces[-1] += notation.times
        if isinstance(factor, Power):
            pieces[-1] += notation.power(factor.name, factor.exponent)
            continue
        inside = [piece for pieces in _terms(factor, notation) for piece in pieces]
        pieces[-1] += "(" + inside[0]
        pieces += inside[1:]
        pieces[-1] += ")"
    return pieces
