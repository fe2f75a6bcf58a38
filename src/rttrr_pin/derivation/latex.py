"""Numbers, powers, products and sums as LaTeX, in the order of the paper: number, masses, parameters, c, s, rates."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction

from rttrr_pin.derivation.collect import SIMPLE
from rttrr_pin.derivation.ring import nearest
from rttrr_pin.derivation.symbols import MASS, Factors, Role, Symbol

ORDER: Mapping[Role, int] = {
    Role.STEP: 1,
    Role.PARAMETER: 1,
    Role.COSINE: 2,
    Role.SINE: 3,
    Role.PAYLOAD: 4,
    Role.GRAVITY: 4,
    Role.UNKNOWN: 4,
    Role.COORDINATE: 5,
    Role.ACCELERATION: 6,
    Role.RATE: 7,
    Role.SIGN: 8,
}
"""Where in a product symbols of each role stand; masses come before everything else."""

FUNCTION = re.compile(r"(\\(cos|sin)(?![A-Za-z])|\\(mathrm|operatorname|text)\s*\{\w+\}|[csCS])(?!\s*_)")
"""A sine or cosine whose angle stands behind it; s_2 is a symbol with an index."""


def latex_number(x: Fraction) -> str:
    """A number without its sign: whole, a simple fraction, or the shortest decimal of the same float64."""
    x = abs(x)
    if x.denominator == 1 and x.numerator < 10**15:
        return str(x.numerator)
    if x.denominator <= SIMPLE and x.numerator <= SIMPLE:
        return rf"\frac{{{x.numerator}}}{{{x.denominator}}}"
    return decimal(nearest(x))


def decimal(x: float) -> str:
    """The shortest decimal that is read back as the same float64."""
    digits, _, exponent = repr(x).partition("e")
    digits = digits.removesuffix(".0")
    return rf"{digits} \cdot 10^{{{int(exponent)}}}" if exponent else digits


def latex_power(symbol: Symbol, power: int) -> str:
    r"""A symbol to a power; that of a sine or cosine before its angle, c^2q_5 or \cos^2 q_5, but s_5^2."""
    if power == 1:
        return symbol.latex
    raised = f"^{power}" if power < 10 else f"^{{{power}}}"
    function = FUNCTION.match(symbol.latex) if symbol.role in (Role.SINE, Role.COSINE) else None
    if function:
        return function[0] + raised + symbol.latex[function.end() :]
    if "^" in symbol.latex.removeprefix("{}^") or "(" in symbol.latex:
        return rf"\left({symbol.latex}\right){raised}"
    return symbol.latex + raised


def latex_product(coefficient: Fraction, factors: Factors, symbols: Mapping[str, Symbol]) -> str:
    """A term without its sign."""
    parts = [latex_power(symbols[name], power) for name, power in in_order(factors, symbols)]
    number = latex_number(coefficient)
    if number != "1" or not parts:
        parts.insert(0, number)
    return r" \, ".join(parts)


def latex_sum(terms: Iterable[tuple[Fraction, Factors]], symbols: Mapping[str, Symbol]) -> list[str]:
    """A sum, term by term, each with its sign; the first only where it is a minus."""
    texts = [("- " if x < 0 else "+ ") + latex_product(x, factors, symbols) for x, factors in terms]
    if not texts:
        return ["0"]
    return [texts[0].removeprefix("+ "), *texts[1:]]


def in_order(factors: Factors, symbols: Mapping[str, Symbol]) -> Factors:
    """The factors of a product as people write them: masses, other parameters, cosines, sines, what moves."""

    def place(factor: tuple[str, int]) -> tuple[bool, int, str]:
        symbol = symbols[factor[0]]
        return symbol.dimension != MASS, ORDER[symbol.role], symbol.name

    return tuple(sorted(factors, key=place))
