"""Expressions as they are printed: sums and products with brackets, where polynomials have none."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias


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
