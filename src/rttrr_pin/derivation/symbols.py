"""Symbols of closed forms: what each is called in Python and in LaTeX, what it stands for, and its dimension."""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

Factors = tuple[tuple[str, int], ...]
"""Names of symbols with their exponents, none of them 0, sorted by name."""

Term = tuple[Fraction, Factors]
"""A coefficient and the product that it multiplies."""

Expression = dict[Factors, Fraction]
"""A polynomial: the coefficient of each product of symbols, none of them 0."""


class Dimension(NamedTuple):
    """Exponents of length, mass and time; an angle has none."""

    length: int = 0
    mass: int = 0
    time: int = 0

    def times(self, other: Dimension, power: int = 1) -> Dimension:
        """The dimension of a product, self other^power."""
        return Dimension(*(own + power * more for own, more in zip(self, other, strict=True)))

    @property
    def unit(self) -> str:
        """What people write for it."""
        return UNITS.get(self, str(self))

    def __str__(self) -> str:
        units = zip(("m", "kg", "s"), self, strict=True)
        return " ".join(unit if power == 1 else f"{unit}^{power}" for unit, power in units if power) or "1"


NUMBER = Dimension()
LENGTH = Dimension(length=1)
MASS = Dimension(mass=1)
INERTIA = Dimension(length=2, mass=1)
ACCELERATION = Dimension(length=1, time=-2)
FORCE = Dimension(length=1, mass=1, time=-2)
MOMENT = Dimension(length=2, mass=1, time=-2)

UNITS: Mapping[Dimension, str] = {
    ACCELERATION: "m/s^2",
    FORCE: "N",
    MOMENT: "N m",
    INERTIA: "kg m^2",
    Dimension(time=-1): "rad/s",
    Dimension(time=-2): "rad/s^2",
    Dimension(length=1, time=-1): "m/s",
}
"""Units that are not written as the powers of m, kg and s in this order."""

DIMENSIONS: Mapping[str, Dimension] = {
    "number": NUMBER,
    "angle": NUMBER,
    "length": LENGTH,
    "mass": MASS,
    "inertia": INERTIA,
    "acceleration": ACCELERATION,
    "force": FORCE,
    "moment": MOMENT,
}
"""What a symbol may measure."""


class Role(enum.StrEnum):
    """What a symbol stands for."""

    COORDINATE = "coordinate"
    RATE = "rate"
    ACCELERATION = "acceleration"
    COSINE = "cosine"
    SINE = "sine"
    SIGN = "sign"
    GRAVITY = "gravity"
    PAYLOAD = "payload"
    PARAMETER = "parameter"
    STEP = "step"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Symbol:
    """One symbol of a closed form.

    Attributes:
        name: an identifier, for Python, C and the terms of a polynomial.
        latex: how it is printed.
        role: what it stands for.
        dimension: in length, mass and time.
        index: of a coordinate, rate, acceleration or sign, its place in q, v or a, from 1; of a cosine or sine, that
            of the angle; else 0.
    """

    name: str
    latex: str
    role: Role
    dimension: Dimension = NUMBER
    index: int = 0


def factors_of(exponents: dict[str, int]) -> Factors:
    """Exponents by name as the key of a term."""
    return tuple(sorted((name, power) for name, power in exponents.items() if power))


def expression_of(terms: Iterable[Term]) -> Expression:
    """The sum of terms."""
    total: Expression = {}
    for coefficient, factors in terms:
        total[factors] = total.get(factors, Fraction(0)) + coefficient
    return {factors: coefficient for factors, coefficient in total.items() if coefficient}


def dimension_of(factors: Factors, symbols: Mapping[str, Symbol]) -> Dimension:
    """The dimension of a product."""
    total = NUMBER
    for name, power in factors:
        total = total.times(symbols[name].dimension, power)
    return total


def renamed_factors(factors: Factors, names: Mapping[str, str]) -> Factors:
    """A product with other symbols in place of some."""
    if not any(name in names for name, _ in factors):
        return factors
    powers: dict[str, int] = {}
    for name, power in factors:
        powers[names.get(name, name)] = powers.get(names.get(name, name), 0) + power
    return factors_of(powers)


def renamed(expression: Expression, names: Mapping[str, str]) -> Expression:
    """A polynomial with other symbols in place of some."""
    return expression_of((coefficient, renamed_factors(factors, names)) for factors, coefficient in expression.items())
