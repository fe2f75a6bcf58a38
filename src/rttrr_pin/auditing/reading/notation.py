"""How a text spells its symbols: each in the way that it is printed first."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache

from rttrr_pin.auditing.reading.ambiguity import sums_coordinates, takes_argument, ways
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Product
from rttrr_pin.auditing.reading.products import terms_of
from rttrr_pin.auditing.reading.trees import sum_of
from rttrr_pin.auditing.reading.vocabulary import FUNCTIONS, Vocabulary, angle_name

POWER = re.compile(r"\s*(\^\s*(\{\s*\d+\s*\}|\d)|[²³¹⁰⁴-⁹]+)\s*$")
"""Behind a symbol."""


def spellings_of(products: Sequence[Product], vocabulary: Vocabulary, text: str) -> tuple[tuple[str, str], ...]:
    """Each known symbol of a sum by its name, as the text spells it first.

    Args:
        products: of the sum.
        vocabulary: what its symbols mean.
        text: that it stands in.
    """
    found: dict[str, str] = {}
    for name, candidates in _printed(products, vocabulary, text):
        if name not in found:
            spelling = next((x for x in candidates if _means(x, name, vocabulary)), None)
            found |= {} if spelling is None else {name: spelling}
    return tuple(found.items())


@lru_cache(maxsize=4096)
def _means(spelling: str, name: str, vocabulary: Vocabulary) -> bool:
    """Whether a spelling is read as this symbol, and in no other way."""
    try:
        (term,) = terms_of(sum_of(spelling), vocabulary, spelling)
    except (UnreadableError, ValueError):
        return False
    (reading, *others) = term.readings
    return not others and reading.coefficient == 1 and reading.factors == ((name, 1),)


def _printed(products: Sequence[Product], vocabulary: Vocabulary, text: str) -> Iterator[tuple[str, list[str]]]:
    """The symbols of a sum in printed order, each with spellings that it may have, the most literal first."""
    for product in products:
        factors, _ = ways(product.factors, vocabulary)[0]
        for i, factor in enumerate(factors):
            if takes_argument(factors, i, vocabulary):
                yield from _function(factor, factors[i + 1], vocabulary, text)
            elif isinstance(factor.body, Group):
                yield from _printed((*factor.body.products, *factor.body.divisor), vocabulary, text)
            elif factor.atom is not None:
                angle = vocabulary.indexed_angle(factor.atom)
                if angle or factor.atom in vocabulary:
                    spellings = [_literal(factor, text), str(factor.atom)]
                    yield angle or vocabulary.identifier(factor.atom), spellings


def _function(factor: Factor, argument: Factor, vocabulary: Vocabulary, text: str) -> Iterator[tuple[str, list[str]]]:
    """A sine or cosine with its angle."""
    atom, body = factor.atom, argument.body
    if isinstance(body, Group):
        indices = sums_coordinates(body, vocabulary)
    else:
        indices = [index] if isinstance(body, Atom) and (index := vocabulary.coordinate(body)) is not None else None
    if atom is not None and indices:
        function, angle = _literal(factor, text), _literal(argument, text)
        apart = text[factor.end : argument.start].isspace() or (atom.letters.startswith("\\") and angle[0].isalpha())
        name = angle_name(FUNCTIONS[atom.letters], indices)
        yield name, [f"{function} {angle}" if apart else f"{function}{angle}", f"{atom} {body}"]


def _literal(factor: Factor, text: str) -> str:
    """A factor as printed, without its power; a superscript before it stands on nothing."""
    printed = " ".join(text[factor.start : factor.end].split())
    if factor.exponent is not None:
        printed = POWER.sub("", printed)
    return "{}" + printed if printed.startswith("^") else printed
