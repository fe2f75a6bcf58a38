"""From products as printed to terms with their readings, by a vocabulary."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from rttrr_pin.auditing.printed import Reading
from rttrr_pin.auditing.reading.ambiguity import Factors, joined, signs, sums_coordinates, takes_argument, ways
from rttrr_pin.auditing.reading.expansion import Bracket, Terms, expanded
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Product
from rttrr_pin.auditing.reading.vocabulary import FUNCTIONS, Vocabulary, angle_name
from rttrr_pin.derivation.symbols import factors_of

LARGEST_POWER = 400
"""Of a number: 10^400 is past every quantity."""


def terms_of(products: Sequence[Product], vocabulary: Vocabulary, text: str) -> Terms:
    """The terms of a sum, brackets expanded.

    Args:
        products: of the sum.
        vocabulary: what its symbols mean.
        text: that it stands in.

    Raises:
        UnreadableError: something in it is no polynomial.
    """
    return tuple(term for product in products for term in _terms(product, vocabulary, text))


def _terms(product: Product, vocabulary: Vocabulary, text: str) -> Terms:
    if product.enclosed:
        return terms_of(product.enclosed, vocabulary, text)
    literals = [_Literal(vocabulary, text).read(factors, note) for factors, note in ways(product.factors, vocabulary)]
    sign = [Reading(Fraction(value), (), note) for value, note in signs(product.signs)]
    readings = [reading for reading, _ in literals]
    return expanded(text, product.start, product.end, [sign, readings], literals[0][1])


@dataclass
class _Literal:
    """Reads the factors of a product one after the other, in one of the ways they can be read."""

    vocabulary: Vocabulary
    text: str
    coefficient: Fraction = Fraction(1)
    exponents: Counter[str] = field(default_factory=Counter)
    unknown: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    brackets: list[Bracket] = field(default_factory=list)

    def read(self, factors: Factors, note: str) -> tuple[Reading, list[Bracket]]:
        """What is no bracket, and the brackets."""
        i = 0
        while i < len(factors):
            if takes_argument(factors, i, self.vocabulary):
                self._function(factors[i], factors[i + 1])
                i += 2
            else:
                self._factor(factors[i])
                i += 1
        notes = joined(note, *self.notes)
        return Reading(self.coefficient, factors_of(self.exponents), notes, tuple(self.unknown)), self.brackets

    def _factor(self, factor: Factor) -> None:
        if isinstance(factor.body, Fraction):
            self._number(factor.body, factor)
        elif isinstance(factor.body, Group):
            self._group(factor.body, factor)
        else:
            self._symbol(replace(factor.body, prefix=factor.prefix), factor)

    def _number(self, value: Fraction, factor: Factor) -> None:
        power = -factor.power if factor.operator == "/" else factor.power
        if abs(power) > LARGEST_POWER or (value == 0 and power < 0):
            raise UnreadableError(f"this is no number that can be meant: {value} to the power {power}", factor.start)
        self.coefficient *= value**power

    def _group(self, group: Group, factor: Factor) -> None:
        terms = terms_of(group.products, self.vocabulary, self.text)
        if factor.operator == "/":
            self._number(_constant(terms, factor), factor)
            return
        self._positive(factor)
        if group.divisor:
            divisor = _constant(terms_of(group.divisor, self.vocabulary, self.text), factor)
            self._number(divisor, replace(factor, operator="/"))
        self.brackets += [Bracket(terms, group.start, group.end)] * factor.power

    def _symbol(self, atom: Atom, factor: Factor) -> None:
        self._positive(factor)
        angle = self.vocabulary.indexed_angle(atom)
        if angle is None and atom.letters.startswith(("\\cos", "\\sin")):
            raise UnreadableError("a sine or cosine is wanted with a coordinate or a sum of coordinates", factor.start)
        if angle is None and atom not in self.vocabulary:
            self.unknown.append(str(atom))
        self.exponents[angle or self.vocabulary.identifier(atom)] += factor.power

    def _function(self, factor: Factor, argument: Factor) -> None:
        self._positive(factor)
        self._positive(argument)
        name, body = factor.atom, argument.body
        if isinstance(body, Group):
            indices = sums_coordinates(body, self.vocabulary)
        else:
            indices = [index] if isinstance(body, Atom) and (index := self.vocabulary.coordinate(body)) else None
            if argument.exponent is not None:
                self.notes.append(f"the power {argument.exponent} behind {body} read as that of its sine or cosine")
        if name is None or not indices:
            raise UnreadableError("the angle is wanted as a coordinate or a sum of coordinates", argument.start)
        self.exponents[angle_name(FUNCTIONS[name.letters], indices)] += factor.power * argument.power

    def _positive(self, factor: Factor) -> None:
        if factor.operator == "/":
            raise UnreadableError("only numbers may divide; write the quotient out as a product", factor.start)
        if not 0 <= factor.power <= LARGEST_POWER:
            raise UnreadableError(
                f"wanted a power from 0 to {LARGEST_POWER}, got {factor.power}; write the power out", factor.start
            )


def _constant(terms: Terms, factor: Factor) -> Fraction:
    """The value of a sum of numbers."""
    if any(len(term.readings) > 1 or term.readings[0].factors for term in terms):
        raise UnreadableError("only numbers may divide; write the quotient out as a product", factor.start)
    return sum((term.readings[0].coefficient for term in terms), Fraction(0))
