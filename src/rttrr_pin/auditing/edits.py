"""What it takes to turn a printed term into a derived one: which slips, and how much they weigh.

A pairing of printed with derived terms is judged by the total of these weights, so they say how slips happen: a dot,
a sign, a number or one letter goes wrong easily; two letters in one term hardly ever do; beyond that it is rather
another term, printed in excess, and one that is missing.
"""

from __future__ import annotations

import enum
from collections import Counter
from collections.abc import Mapping
from fractions import Fraction

from rttrr_pin.derivation.symbols import Factors, Role, Symbol


class Kind(enum.StrEnum):
    """How a printed equation can be wrong."""

    RATE = "rate"
    SIGN = "sign"
    COEFFICIENT = "coefficient"
    SYMBOL = "symbol"
    EXTRA = "extra"
    MISSING = "missing"
    DUPLICATE = "duplicate"


WEIGHT: Mapping[Kind, float] = {
    Kind.RATE: 1.0,
    Kind.SIGN: 1.0,
    Kind.COEFFICIENT: 1.0,
    Kind.SYMBOL: 1.1,
    Kind.DUPLICATE: 0.4,
    Kind.EXTRA: 1.2,
    Kind.MISSING: 1.2,
}
"""The weight of one slip of each kind."""

LIMIT = WEIGHT[Kind.EXTRA] + WEIGHT[Kind.MISSING]
"""From this weight on, two terms have nothing to do with each other."""

REACH = 6
"""Products that differ in more factors than this have nothing to do with each other."""

POWER, SECOND_LETTER, LOST_LETTER = 1.2, 1.3, 1.4
"""The weight of a rate's power lost or added; of each of two letters exchanged; of a letter lost or added."""

DOTS: Mapping[Role, int] = {Role.COORDINATE: 0, Role.RATE: 1, Role.ACCELERATION: 2}
"""How many dots a symbol of each role carries."""

Slips = tuple[tuple[Kind, ...], float]
"""What went wrong, and the weight of it."""


def between_numbers(printed: Fraction, derived: Fraction) -> Slips:
    """The slips between two coefficients."""
    kinds: tuple[Kind, ...] = ()
    if printed * derived < 0:
        kinds += (Kind.SIGN,)
    if abs(printed) != abs(derived):
        kinds += (Kind.COEFFICIENT,)
    return kinds, sum(WEIGHT[kind] for kind in kinds)


def between_factors(printed: Factors, derived: Factors, symbols: Mapping[str, Symbol]) -> Slips | None:
    """The slips between two products of symbols.

    Args:
        printed: the factors as printed.
        derived: the factors that are right.
        symbols: what the names stand for.

    Returns:
        None where the products have too little in common.
    """
    powers, right_powers = Counter(dict(printed)), Counter(dict(derived))
    kept = powers & right_powers
    wrong, right = powers - kept, right_powers - kept
    if wrong.total() + right.total() > REACH:
        return None
    kinds, weight = _dots(wrong, right, symbols)
    if wrong and right:
        exchanged = max(len(wrong), len(right))
        one = exchanged == 1 and wrong.total() == right.total()
        weight += WEIGHT[Kind.SYMBOL] if one else SECOND_LETTER * exchanged
        weight += 0 if one else LOST_LETTER * abs(wrong.total() - right.total())
        kinds += (Kind.SYMBOL,) * exchanged
        if one and _other_dots(symbols[next(iter(wrong))], symbols[next(iter(right))]):
            weight += WEIGHT[Kind.RATE]
            kinds += (Kind.RATE,)
    for name, power in (wrong or right).items() if not (wrong and right) else ():
        rate = symbols[name].role in DOTS and name in kept
        kinds += (Kind.RATE,) if rate else (Kind.SYMBOL,)
        weight += POWER if rate and power == 1 else LOST_LETTER * power
    return (kinds, weight) if weight < LIMIT else None


def _dots(wrong: Counter[str], right: Counter[str], symbols: Mapping[str, Symbol]) -> Slips:
    """Dots too few or too many: what is left of a coordinate on both sides; takes it out of both counters."""
    kinds: tuple[Kind, ...] = ()
    weight = 0.0
    moving = {symbols[name].index for name in wrong if symbols[name].role in DOTS}
    for index in sorted(moving):
        mine, theirs = ([name for name in side if _moves(symbols[name], index)] for side in (wrong, right))
        if not theirs:
            continue
        weight += WEIGHT[Kind.RATE]
        if len(mine) > 1 or len(theirs) > 1 or wrong[mine[0]] != right[theirs[0]]:
            weight += POWER - WEIGHT[Kind.RATE]
        kinds += (Kind.RATE,)
        for name in (*mine, *theirs):
            wrong.pop(name, None)
            right.pop(name, None)
    return kinds, weight


def _other_dots(one: Symbol, other: Symbol) -> bool:
    """Whether two letters are of different coordinates and carry another number of dots."""
    return one.role in DOTS and other.role in DOTS and one.role is not other.role


def _moves(symbol: Symbol, index: int) -> bool:
    return symbol.role in DOTS and symbol.index == index
