"""Products and sums in which symbols divide, as one quotient of polynomials."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import prod

from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.multiply import Ways
from rttrr_pin.auditing.reading.nodes import LARGEST_POWER, Factor, Group, Named, Product
from rttrr_pin.derivation.numbers import MOST_BITS
from rttrr_pin.derivation.ring import Polynomial, Ring, bits
from rttrr_pin.derivation.symbols import Role, Symbol

MOST_TERMS, LARGEST_DEGREE = 2000, 400
"""Of a numerator or denominator."""

Pair = tuple[Polynomial, Polynomial]
"""Numerator and denominator."""


def quotient_of(products: Sequence[Product], ways: Ways) -> Quotient:
    """The sum of products as a quotient, each product in the most literal way to read it.

    Raises:
        UnreadableError: something divides by 0, or it is too long.
    """
    named = list(_named(products, ways))
    ring = Ring(Symbol(name, name, Role.UNKNOWN) for name in dict.fromkeys(symbol.name for symbol in named))
    numerator, denominator = _sum(products, ways, ring)
    unknown = tuple(dict.fromkeys(symbol.unknown for symbol in named if symbol.unknown))
    return Quotient(ring.terms(numerator), ring.terms(denominator), unknown)


def _factors(product: Product, ways: Ways) -> list[Factor]:
    """In the most literal way."""
    return list(next(iter(ways(product.factors)))[0])


def _named(products: Sequence[Product], ways: Ways) -> Iterator[Named]:
    """The symbols of a sum."""
    for product in products:
        for factor in _factors(product, ways):
            if isinstance(factor.body, Named):
                yield factor.body
            elif isinstance(factor.body, Group):
                yield from _named((*factor.body.products, *factor.body.divisor), ways)


def _sum(products: Sequence[Product], ways: Ways, ring: Ring) -> Pair:
    total = ring.lift(0), ring.lift(1)
    for product in products:
        one = ring.lift(prod(product.signs[-1]) if product.signs else 1), ring.lift(1)
        for factor in _factors(product, ways):
            one = _times(one, _power(_value(factor, ways, ring), factor), factor.start)
        (n, d), (m, e) = total, one
        numerator = _product(n, e, product.start) + _product(m, d, product.start)
        total = _cancelled(numerator, _product(d, e, product.start))
    return total


def _value(factor: Factor, ways: Ways, ring: Ring) -> Pair:
    body = factor.body
    if isinstance(body, Named):
        return ring[body.name] * body.sign, ring.lift(1)
    if isinstance(body, Fraction):
        return ring.lift(body), ring.lift(1)
    if not isinstance(body, Group):
        raise UnreadableError("this is no symbol, number or bracket", factor.start)
    value = _sum(body.products, ways, ring)
    if body.divisor:
        n, d = _sum(body.divisor, ways, ring)
        value = _times(value, (d, n), factor.start)
    return value


def _power(value: Pair, factor: Factor) -> Pair:
    power = -factor.power if factor.operator == "/" else factor.power
    numerator, denominator = value if power >= 0 else value[::-1]
    if not denominator:
        raise UnreadableError("this divides by 0", factor.start)
    if abs(power) > LARGEST_POWER:
        raise UnreadableError("this is no power that can be meant", factor.start)
    result = numerator**0, denominator**0
    for _ in range(abs(power)):
        result = _times(result, (numerator, denominator), factor.start)
    return result


def _times(x: Pair, y: Pair, start: int) -> Pair:
    if not x[1] or not y[1]:
        raise UnreadableError("this divides by 0", start)
    return _cancelled(_product(x[0], y[0], start), _product(x[1], y[1], start))


def _product(x: Polynomial, y: Polynomial, start: int) -> Polynomial:
    long = len(x) * len(y) > MOST_TERMS or sum(x.degrees()) + sum(y.degrees()) > LARGEST_DEGREE
    if long or bits(x) + bits(y) > MOST_BITS:
        raise UnreadableError("this is too long a quotient; print it in parts", start)
    return x * y


def _cancelled(numerator: Polynomial, denominator: Polynomial) -> Pair:
    if denominator.is_constant():
        return numerator / denominator, denominator / denominator
    common = numerator.gcd(denominator)
    return divmod(numerator, common)[0], divmod(denominator, common)[0]
