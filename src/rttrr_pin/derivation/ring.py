"""Polynomials in the symbols of one robot with rational coefficients, modulo c^2 + s^2 = 1; FLINT computes.

A closed form is such a polynomial: sines and cosines are symbols of their own, a sine's square is always replaced by
1 - c^2, so that two expressions are equal exactly when their polynomials are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.derivation.symbols import Expression, Factors, Role, Symbol

Polynomial = fmpq_mpoly


class Ring:
    """The polynomials in given symbols.

    Attributes:
        symbols: by name, in order.
    """

    def __init__(self, symbols: Iterable[Symbol]) -> None:
        self.symbols: dict[str, Symbol] = {symbol.name: symbol for symbol in symbols}
        # sines first: the leading term of s^2 + c^2 - 1 is then s^2, and division by it replaces s^2 by 1 - c^2
        self._names = sorted(self.symbols, key=lambda name: self.symbols[name].role is not Role.SINE)
        self._context = fmpq_mpoly_ctx.get(tuple(map(_ascii, self._names)) or ("one",), Ordering.lex)
        self._generators = dict(zip(self._names, self._context.gens(), strict=False))
        self._circles = [
            (i, self[name] ** 2 + self[cosine] ** 2 - 1)
            for i, name in enumerate(self._names)
            if self.symbols[name].role is Role.SINE and (cosine := "c" + name.removeprefix("s")) in self.symbols
        ]

    def __getitem__(self, name: str) -> Polynomial:
        """The polynomial that is one symbol."""
        return self._generators[name]

    def __contains__(self, name: str) -> bool:
        return name in self._generators

    def names(self, *roles: Role) -> list[str]:
        """The symbols of some roles, in their order."""
        return [name for name, symbol in self.symbols.items() if symbol.role in roles]

    def lift(self, x: Any) -> Polynomial:
        """Any scalar (an integer, a fraction, a polynomial) as a polynomial."""
        if isinstance(x, fmpq_mpoly):
            if x.context() is not self._context:
                raise ValueError(
                    "a polynomial of another ring: take its terms there, and make a polynomial of them here"
                )
            return x
        if isinstance(x, Fraction):
            x = fmpq(x.numerator, x.denominator)
        return self._context.constant(x)

    def reduced(self, x: Scalar) -> Polynomial:
        """The same modulo c^2 + s^2 = 1: no sine is squared."""
        polynomial = self.lift(x)
        degrees = polynomial.degrees()  # of other sines a division leaves them as they are
        for i, circle in self._circles:
            if degrees[i] > 1:
                polynomial = divmod(polynomial, circle)[1]
        return polynomial

    def reduced_vector(self, x: Vector) -> Vector:
        """The same for each component."""
        return Vector(*(self.reduced(component) for component in x))

    def terms(self, x: Any) -> Expression:
        """A polynomial as coefficients by product."""
        names = self._names
        return {
            tuple(sorted((names[i], int(power)) for i, power in enumerate(exponents) if power)): Fraction(
                int(coefficient.p), int(coefficient.q)
            )
            for exponents, coefficient in self.lift(x).terms()
        }

    def polynomial(self, terms: Mapping[Factors, Fraction]) -> Polynomial:
        """The polynomial with these terms."""
        column = {name: i for i, name in enumerate(self._names)}
        width = max(1, len(self._names))
        entries: dict[tuple[int, ...], fmpq] = {}
        for factors, coefficient in terms.items():
            exponents = [0] * width
            for name, power in factors:
                exponents[column[name]] = power
            entries[tuple(exponents)] = fmpq(coefficient.numerator, coefficient.denominator)
        return self._context.from_dict(entries)

    def derivative(self, x: Scalar, name: str) -> Polynomial:
        """The partial derivative by a symbol; a sine or cosine counts as a symbol of its own."""
        return self.lift(x).derivative(_ascii(name))

    def without(self, x: Scalar, names: Iterable[str]) -> Polynomial:
        """The polynomial with 0 for some symbols."""
        zeros: dict[str | int, int] = {_ascii(name): 0 for name in names}
        return self.lift(x).subs(zeros)

    def substituted(self, x: Any, values: Mapping[str, Any]) -> Polynomial:
        """The polynomial with others in place of some symbols."""
        images = [self.lift(values[name]) if name in values else self[name] for name in self._names]
        return self.reduced(self.lift(x).compose(*images, ctx=self._context))


def _ascii(name: str) -> str:
    """A name as FLINT takes it."""
    return name.encode("ascii", "backslashreplace").decode()


def bits(x: Polynomial) -> int:
    """Of the longest numerator or denominator among the coefficients."""
    return max((int(n).bit_length() for c in x.coeffs() for n in (c.p, c.q)), default=0)


def exact(value: float) -> fmpq:
    """A float as the fraction that it is."""
    return fmpq(*float(value).as_integer_ratio())


def nearest(x: Fraction) -> float:
    """The nearest double, which may be infinite."""
    try:
        return float(x)
    except OverflowError:
        return math.inf if x > 0 else -math.inf


def evaluate(terms: Expression, values: Mapping[str, Any], number: Callable[[Fraction], Any] = nearest) -> Any:
    """The value of a polynomial, summed in the order of its terms.

    Args:
        terms: its terms.
        values: of each symbol, of any kind of scalar.
        number: makes such a scalar of a coefficient.
    """
    total = number(Fraction(0))
    for factors, coefficient in terms.items():
        product = number(coefficient)
        for name, power in factors:
            for _ in range(power):
                product = product * values[name]
        total = total + product
    return total
