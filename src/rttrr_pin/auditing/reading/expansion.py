"""Products of readings: what brackets expand to, and how the terms are shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import prod

from rttrr_pin.auditing.printed import PrintedTerm, Reading
from rttrr_pin.auditing.reading.ambiguity import MOST, joined
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.derivation.symbols import factors_of

LARGEST = 10_000
"""Terms that one product may expand to."""

Terms = tuple[PrintedTerm, ...]


@dataclass(frozen=True, slots=True)
class Bracket:
    """A sum that a product has as a factor.

    Attributes:
        terms: of the sum.
        start, end: where it stands, without its brackets.
    """

    terms: Terms
    start: int
    end: int


def times(readings: Iterable[Reading]) -> Reading:
    """The product of readings; notes and unknown spellings are those of all."""
    coefficient = Fraction(1)
    exponents: Counter[str] = Counter()
    notes: dict[str, None] = {}
    unknown: dict[str, None] = {}
    for reading in readings:
        coefficient *= reading.coefficient
        exponents.update(dict(reading.factors))
        notes[reading.note] = None
        unknown.update(dict.fromkeys(reading.unknown))
    return Reading(coefficient, factors_of(exponents), joined(*notes), tuple(unknown))


def expanded(
    text: str, start: int, end: int, choices: Sequence[Sequence[Reading]], brackets: Sequence[Bracket]
) -> Terms:
    """The terms that a product expands to.

    Args:
        text: that it stands in.
        start: where it begins there, with its sign.
        end: where it ends.
        choices: readings of what is not a bracket; one of each is multiplied.
        brackets: its brackets, as often as they are factors.

    Raises:
        UnreadableError: there are too many terms or readings.
    """
    if prod(len(bracket.terms) for bracket in brackets) > LARGEST:
        raise UnreadableError(f"this expands to more than {LARGEST} terms; print it expanded or as its parts", start)
    terms = []
    for picked in product(*(range(len(bracket.terms)) for bracket in brackets)):
        inner = [bracket.terms[i] for bracket, i in zip(brackets, picked, strict=True)]
        alternatives = [*choices, *(term.readings for term in inner)]
        if prod(map(len, alternatives)) > MOST:
            raise UnreadableError(f"this can be read in more than {MOST} ways; set it apart with brackets", start)
        readings = dict.fromkeys(times(factors) for factors in product(*alternatives))
        terms.append(PrintedTerm(_shown(text, start, end, brackets, picked), tuple(readings)))
    return tuple(terms)


def _shown(text: str, start: int, end: int, brackets: Sequence[Bracket], picked: Sequence[int]) -> str:
    """The product as printed, with dots for the terms of each bracket that are not meant."""
    pieces: dict[tuple[int, int], str] = {}
    for bracket, i in zip(brackets, picked, strict=True):
        if len(bracket.terms) > 1:
            piece = f"{'... ' if i else ''}{bracket.terms[i].text}{' ...' if i + 1 < len(bracket.terms) else ''}"
            place = (bracket.start, bracket.end)
            pieces[place] = f"{pieces[place]}, {piece}" if place in pieces else piece
    shown, here = "", start
    for (begin, stop), piece in sorted(pieces.items()):
        shown += text[here:begin] + piece
        here = stop
    return plain(shown + text[here:end])


def plain(text: str) -> str:
    """Text on one line, without the marks of line breaks and columns."""
    return " ".join(text.replace("\\\\", " ").replace("&", " ").split())
