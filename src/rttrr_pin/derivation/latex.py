"""Products and sums of symbols as LaTeX, in the paper's letters and in its order: number, M, c, s, letters, rates."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction

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
    """A number without its sign: whole, a fraction of small numbers, or a decimal that rounds to the same double."""
    x = abs(x)
    if x.denominator == 1 and x.numerator < 10**6:
        return str(x.numerator)
    if x.denominator <= 100 and x.numerator <= 100:
        return rf"\frac{{{x.numerator}}}{{{x.denominator}}}"
    mantissa, _, exponent = repr(float(x)).partition("e")
    mantissa = mantissa.removesuffix(".0")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else mantissa


def latex_power(symbol: Symbol, power: int) -> str:
    r"""A symbol to a power; that of a sine or cosine before its angle, c^2q_5 or \cos^2 q_5, but s_5^2."""
    if power == 1:
        return symbol.latex
    raised = f"^{power}" if power < 10 else f"^{{{power}}}"
    function = FUNCTION.match(symbol.latex) if symbol.role in (Role.SINE, Role.COSINE) else None
    if function:
        return function[0] + raised + symbol.latex[function.end() :]
    if "^" in symbol.latex.removeprefix("{}^"):
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
    """The factors of a product as people write them: masses, other letters, cosines, sines, what moves."""

    def place(factor: tuple[str, int]) -> tuple[bool, int, str]:
        symbol = symbols[factor[0]]
        return symbol.dimension != MASS, ORDER[symbol.role], symbol.name

    return tuple(sorted(factors, key=place))
