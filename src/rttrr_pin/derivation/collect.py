"""A polynomial as people write it: collected by rates, sines squared where that is shorter, common factors in front.

Nothing is lost: expanded again, and reduced modulo c^2 + s^2 = 1, the expression is the same polynomial.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import TypeAlias

from rttrr_pin.derivation.ring import Ring
from rttrr_pin.derivation.symbols import Expression, Factors, Role, Symbol

GROUPS = (Role.ACCELERATION, Role.RATE, Role.SIGN, Role.GRAVITY, Role.PAYLOAD)
"""Symbols that terms are collected by; what has none of them comes last."""

WITHIN = (Role.PARAMETER, Role.STEP, Role.UNKNOWN, Role.COORDINATE, Role.SINE, Role.COSINE)
"""The order of the other factors of a product."""

DEPTH = 3
"""Brackets within the bracket of a group."""

LEAST, MOST = 4, 100
"""Expression of a sum that is tried whether it is a product of sums."""

SIMPLE = 64
"""The largest denominator of numbers that count as exact, and are factored out."""


@dataclass(frozen=True, slots=True)
class Power:
    """A symbol to a power, 1 or more."""

    name: str
    exponent: int = 1


@dataclass(frozen=True, slots=True)
class Product:
    """A coefficient times factors; the coefficient alone where there are none.

    Attributes:
        coefficient: with the sign.
        factors: powers of symbols, then sums.
    """

    coefficient: Fraction
    factors: tuple[Factor, ...] = ()


@dataclass(frozen=True, slots=True)
class Sum:
    """Expression in the order in which they are printed; 0 where there are none."""

    terms: tuple[Product, ...] = ()


Factor: TypeAlias = Power | Sum


class Presenter:
    """Presents polynomials in given symbols.

    Attributes:
        symbols: by name.
    """

    def __init__(self, symbols: Mapping[str, Symbol]) -> None:
        self.symbols = symbols
        self._rank = {
            name: ((*GROUPS, *WITHIN).index(symbol.role), rank) for rank, (name, symbol) in enumerate(symbols.items())
        }
        self._cosines = {
            "c" + name.removeprefix("s"): name for name, symbol in symbols.items() if symbol.role is Role.SINE
        }

    def expression(self, terms: Expression) -> Sum:
        """The expression for a polynomial.

        Args:
            terms: reduced modulo c^2 + s^2 = 1.

        Returns:
            One term for each product of accelerations, rates, gravity and payload, in this order: accelerations,
            squares of rates, products of rates, single rates, signs, gravity, payload, the rest.
        """
        groups: dict[Factors, Expression] = {}
        for factors, coefficient in terms.items():
            outer = tuple(factor for factor in factors if self.symbols[factor[0]].role in GROUPS)
            inner = tuple(factor for factor in factors if self.symbols[factor[0]].role not in GROUPS)
            groups.setdefault(outer, {})[inner] = coefficient
        printed: list[Product] = []
        for outer in sorted(groups, key=self._group_order):
            inside = self._factored(self.shortest(groups[outer]), DEPTH)
            printed += [self._times(outer, inside)] if outer else inside
        return Sum(tuple(printed))

    def shortest(self, terms: Expression) -> Expression:
        """The same with s^2 for 1 - c^2, angle by angle and cofactor by cofactor, where it saves a term."""
        before = -1
        while len(terms) != before:
            before = len(terms)
            for cosine, sine in self._cosines.items():
                terms = _with_squares(terms, cosine, sine)
        return terms

    def _factored(self, terms: Expression, depth: int) -> tuple[Product, ...]:
        """Terms with what they share in front: of all of them, then again and again of as many as share a symbol."""
        coefficient, common, rest = self._content(terms)
        if len(rest) == 1:
            return (self._product(coefficient, common),)
        number, factors = self._irreducible(rest)
        coefficient *= number
        brackets = [Sum(self._split(factor, depth) if depth else self._sorted(factor)) for factor in factors]
        if len(brackets) == 1 and not common and coefficient == 1:
            return brackets[0].terms
        return (self._product(coefficient, common, brackets),)

    def _irreducible(self, terms: Expression) -> tuple[Fraction, list[Expression]]:
        """A number, and sums whose product with it these terms are; the order does not depend on who factors them."""
        if not LEAST <= len(terms) <= MOST or any(x.denominator > SIMPLE for x in terms.values()):
            return Fraction(1), [terms]
        used = {name for key in terms for name, _ in key}
        ring = Ring(symbol for name, symbol in self.symbols.items() if name in used)  # a small one: FLINT's time grows
        number, factors = ring.polynomial(terms).factor()
        if sum(power for _, power in factors) == 1:
            return Fraction(1), [terms]
        total, sums = Fraction(int(number.p), int(number.q)), []
        for factor, power in factors:
            content, _, rest = self._content(ring.terms(factor))
            content, rest = self._upright(content, rest)
            total *= content**power
            sums += [rest] * power
        return total, sorted(sums, key=lambda x: [self._order(factors) for factors in sorted(x, key=self._order)])

    def _upright(self, number: Fraction, terms: Expression) -> tuple[Fraction, Expression]:
        """The same product, the first term of the sum positive."""
        if terms[min(terms, key=self._order)] > 0:
            return number, terms
        return -number, {factors: -x for factors, x in terms.items()}

    def _split(self, rest: Expression, depth: int) -> tuple[Product, ...]:
        parts: list[Product] = []
        while (shared := self._most_shared(rest)) is not None:
            taken = {factors: x for factors, x in rest.items() if any(name == shared for name, _ in factors)}
            rest = {factors: x for factors, x in rest.items() if factors not in taken}
            parts += self._factored(taken, depth - 1)
        return (*_merged(parts), *self._sorted(rest))

    def _most_shared(self, terms: Expression) -> str | None:
        """The symbol that stands in most terms, in two at least."""
        counts = Counter(name for factors in terms for name, _ in factors)
        shared = [name for name, count in counts.items() if count > 1]
        return min(shared, key=lambda name: (-counts[name], self._rank[name]), default=None)

    def _content(self, terms: Expression) -> tuple[Fraction, Factors, Expression]:
        """A number and a product of symbols that all terms share, and what they leave."""
        first = next(iter(terms))
        powers = {name: min(dict(factors).get(name, 0) for factors in terms) for name, _ in first}
        common = tuple((name, power) for name, power in powers.items() if power)
        if len(terms) == 1:
            return terms[first], common, {(): Fraction(1)}
        number = _common_number(terms.values())
        rest = {_divided(factors, common): x / number for factors, x in terms.items()}
        if common or number != 1:
            number, rest = self._upright(number, rest)
        return number, common, rest

    def _times(self, outer: Factors, inside: tuple[Product, ...]) -> Product:
        """A product of rates times what was collected for it."""
        if len(inside) == 1:
            powers = self._product(Fraction(1), outer).factors
            return Product(inside[0].coefficient, powers + inside[0].factors)
        sign = 1 if inside[0].coefficient > 0 else -1
        return self._product(
            Fraction(sign), outer, [Sum(tuple(Product(sign * term.coefficient, term.factors) for term in inside))]
        )

    def _product(self, coefficient: Fraction, factors: Factors, brackets: Sequence[Sum] = ()) -> Product:
        powers = [Power(name, power) for name, power in sorted(factors, key=lambda factor: self._rank[factor[0]])]
        return Product(coefficient, (*powers, *brackets))

    def _sorted(self, terms: Expression) -> tuple[Product, ...]:
        return tuple(self._product(terms[factors], factors) for factors in sorted(terms, key=self._order))

    def _order(self, factors: Factors) -> list[tuple[tuple[int, int], int]]:
        return sorted((self._rank[name], power) for name, power in factors)

    def _group_order(self, outer: Factors) -> tuple[int, list[tuple[tuple[int, int], int]]]:
        powers = Counter({self.symbols[name].role: 0 for name, _ in outer})
        for name, power in outer:
            powers[self.symbols[name].role] += power
        if not outer:
            rank = len(GROUPS) + 2
        elif Role.ACCELERATION in powers:
            rank = 0
        elif Role.RATE in powers:
            rank = 3 if powers[Role.RATE] == 1 else 1 if len(outer) == 1 else 2
        else:
            rank = 2 + min(GROUPS.index(role) for role in powers)
        return rank, self._order(outer)


def _merged(parts: Iterable[Product]) -> list[Product]:
    """The same sum, where x B + y B is (x + y) B."""
    by_brackets: dict[tuple[Sum, ...], list[Product]] = {}
    for part in parts:
        brackets = tuple(factor for factor in part.factors if isinstance(factor, Sum))
        by_brackets.setdefault(brackets, []).append(part)
    merged: list[Product] = []
    for brackets, alike in by_brackets.items():
        if len(alike) == 1 or not brackets:
            merged += alike
            continue
        sign = 1 if alike[0].coefficient > 0 else -1
        left = [Product(sign * x.coefficient, x.factors[: -len(brackets)]) for x in alike]
        merged.append(Product(Fraction(sign), (Sum(tuple(left)), *brackets)))
    return merged


def _with_squares(terms: Expression, cosine: str, sine: str) -> Expression:
    """Take s^2 for 1 - c^2 where both terms are there."""
    terms = dict(terms)
    for factors in list(terms):
        higher = _divided(factors, ((cosine, -2),))
        if factors not in terms or terms.get(higher) != -terms[factors]:
            continue
        coefficient = terms.pop(factors)
        del terms[higher]
        squared = _divided(factors, ((sine, -2),))
        total = terms.pop(squared, Fraction(0)) + coefficient
        if total:
            terms[squared] = total
    return terms


def _divided(factors: Factors, by: Factors) -> Factors:
    """A product of symbols divided by another."""
    exponents = dict(factors)
    for name, power in by:
        exponents[name] = exponents.get(name, 0) - power
    return tuple(sorted((name, power) for name, power in exponents.items() if power))


def _common_number(coefficients: Iterable[Fraction]) -> Fraction:
    """The largest number that leaves integers; 1 where the coefficients are not as simple as that."""
    numbers = list(coefficients)
    if any(x.denominator > SIMPLE for x in numbers):
        return Fraction(1)
    return Fraction(gcd(*(x.numerator for x in numbers)), lcm(*(x.denominator for x in numbers)))
