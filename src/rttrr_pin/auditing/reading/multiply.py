"""From products to terms, of LaTeX and of Python alike: brackets expanded, each term with every way to read it."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import prod

from rttrr_pin.auditing.printed import PrintedTerm, Reading
from rttrr_pin.auditing.reading.ambiguity import MOST, joined, signs, too_many_ways
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import LARGEST_POWER, DividesError, Factor, Group, Named, Product
from rttrr_pin.derivation.numbers import MOST_BITS, fits
from rttrr_pin.derivation.symbols import factors_of

LARGEST = 500
"""Terms that a sum may expand to: the longest of the paper has 56."""

Terms = tuple[PrintedTerm, ...]

Brackets = Sequence[tuple[Group, Terms]]
"""The sums that a product has as factors, as often as they are factors, with what they expand to."""

Ways = Callable[[tuple[Factor, ...]], Iterable[tuple[Iterable[Factor], str]]]
"""Gives every way to read the factors of a product, symbols by their names, with what was decided; at least one."""


def terms_of(products: Sequence[Product], text: str, ways: Ways) -> Terms:
    """The terms of a sum that stands in a text, brackets expanded.

    Raises:
        UnreadableError: something in it is no polynomial, or there are too many terms or readings.
    """
    terms: list[PrintedTerm] = []
    for product in products:
        terms += _terms(product, text, ways)
        if len(terms) > LARGEST:
            raise too_many_terms(product.start)
    return tuple(terms)


def too_many_terms(start: int) -> UnreadableError:
    """The error for what expands to more than `LARGEST` terms."""
    return UnreadableError(f"this expands to more than {LARGEST} terms; print it expanded or as its parts", start)


def _terms(product: Product, text: str, ways: Ways) -> Terms:
    if product.enclosed:
        return terms_of(product.enclosed, text, ways)
    sign = [Reading(Fraction(value), (), note) for value, note in signs(product.signs)]
    readings: list[Reading] = []
    brackets: Brackets = ()
    for factors, note in ways(product.factors):  # its brackets are the same in each way
        reading, brackets = _multiplied(factors, note, text, ways)
        readings.append(reading)
    return _expanded(product, [sign, readings], brackets, text)


def _multiplied(factors: Iterable[Factor], note: str, text: str, ways: Ways) -> tuple[Reading, Brackets]:
    """The product of what is no bracket, and the brackets."""
    coefficient = Fraction(1)
    exponents: Counter[str] = Counter()
    symbols: list[Named] = []
    brackets: list[tuple[Group, Terms]] = []
    for factor in factors:
        body = factor.body
        if isinstance(body, Fraction):
            coefficient *= _power(body, factor, factor.operator == "/")
        elif isinstance(body, Named):
            factor.check_power()
            symbols.append(body)
            exponents[body.name] += factor.power
            coefficient *= body.sign**factor.power
        elif isinstance(body, Group):
            terms = terms_of(body.products, body.text or text, ways)
            if factor.operator == "/":
                coefficient *= _power(_divisor(terms, factor.start), factor, True)
                continue
            factor.check_power()
            if body.divisor:
                divisor = _divisor(terms_of(body.divisor, body.text or text, ways), factor.start)
                coefficient *= _power(divisor, factor, True)
            brackets += [(body, terms)] * factor.power
        if not fits(coefficient):
            raise _too_long(factor.start)
    unknown = tuple(symbol.unknown for symbol in symbols if symbol.unknown)
    notes = joined(note, *(symbol.note for symbol in symbols))
    return Reading(coefficient, factors_of(exponents), notes, unknown), brackets


def _power(value: Fraction, factor: Factor, divides: bool) -> Fraction:
    power = -factor.power if divides else factor.power
    bits = max(value.numerator.bit_length(), value.denominator.bit_length())
    if abs(power) > LARGEST_POWER or bits * abs(power) > MOST_BITS or (value == 0 and power < 0):
        raise UnreadableError("this is no number that can be meant: its power has too many digits", factor.start)
    return Fraction(value**power)


def constant(terms: Terms) -> Fraction | None:
    """The value of a sum of numbers; None where there is a symbol in it, or one that is too long."""
    total = Fraction(0)
    for term in terms:
        if len(term.readings) > 1 or term.readings[0].factors or not fits(total):
            return None
        total += term.readings[0].coefficient
    return total


def _too_long(start: int) -> UnreadableError:
    return UnreadableError("its numbers multiply to more digits than any quantity has", start)


def _divisor(terms: Terms, start: int) -> Fraction:
    value = constant(terms)
    if value is None:
        raise DividesError(start)
    return value


def _expanded(product: Product, choices: Sequence[Sequence[Reading]], brackets: Brackets, text: str) -> Terms:
    """One term for each choice of a term from every bracket; `choices` are the readings of what is no bracket."""
    if prod(len(terms) for _, terms in brackets) > LARGEST:
        raise too_many_terms(product.start)
    expanded = []
    for picked in itertools.product(*(range(len(terms)) for _, terms in brackets)):
        alternatives = [*choices, *(terms[i].readings for (_, terms), i in zip(brackets, picked, strict=True))]
        if prod(map(len, alternatives)) > MOST:
            raise too_many_ways(product.start)
        readings = dict.fromkeys(_product(each, product.start) for each in itertools.product(*alternatives))
        expanded.append(PrintedTerm(_shown(product, brackets, picked, text), tuple(readings)))
    return tuple(expanded)


def _product(readings: Sequence[Reading], start: int) -> Reading:
    """The product of readings; notes and unknown spellings are those of all."""
    exponents: Counter[str] = Counter()
    for reading in readings:
        exponents.update(dict(reading.factors))
    notes = dict.fromkeys(reading.note for reading in readings)
    unknown = dict.fromkeys(spelling for reading in readings for spelling in reading.unknown)
    coefficient = Fraction(1)
    for reading in readings:
        coefficient *= reading.coefficient
        if not fits(coefficient):
            raise _too_long(start)
    return Reading(coefficient, factors_of(exponents), joined(*notes), tuple(unknown))


def _shown(product: Product, brackets: Brackets, picked: Sequence[int], text: str) -> str:
    """The product as printed, on one line, with dots for the terms of each bracket that are not meant."""
    pieces: dict[tuple[int, int], list[str]] = {}
    terms_meant: list[str] = []
    for (group, terms), i in zip(brackets, picked, strict=True):
        if group.abbreviated:
            terms_meant.append(f"{group.abbreviated}: {terms[i].text}")
        elif len(terms) > 1:
            piece = f"{'... ' if i else ''}{terms[i].text}{' ...' if i + 1 < len(terms) else ''}"
            pieces.setdefault((group.start, group.end), []).append(piece)
    shown, position = "", product.start
    for (start, end), alternatives in sorted(pieces.items()):
        shown += text[position:start] + ", ".join(alternatives)
        position = end
    meant = f" (of {', '.join(terms_meant)})" if terms_meant else ""
    return " ".join((shown + text[position : product.end] + meant).replace("\\\\", " ").replace("&", " ").split())
