"""What it takes to turn a printed term into a derived one: which errors, and how much they weigh.

A pairing of printed with derived terms is judged by the total of these weights, so they say how errors happen: a dot,
a sign, a number or one symbol goes wrong easily; two symbols in one term hardly ever do; beyond that it is rather
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
"""The weight of one error of each kind."""

LIMIT = WEIGHT[Kind.EXTRA] + WEIGHT[Kind.MISSING]
"""From this weight on, two terms have nothing to do with each other."""

REACH = 6
"""Products that differ in more factors than this have nothing to do with each other."""

POWER, SECOND_SYMBOL, LOST_SYMBOL = 1.2, 1.3, 1.4
"""The weight of a rate's power lost or added; of each of two symbols exchanged; of a symbol lost or added."""

DOTS: Mapping[Role, int] = {Role.COORDINATE: 0, Role.RATE: 1, Role.ACCELERATION: 2}
"""How many dots a symbol of each role carries."""

Errors = tuple[tuple[Kind, ...], float]
"""What went wrong, and the weight of it."""


def between_numbers(printed: Fraction, derived: Fraction) -> Errors:
    """The errors between two coefficients."""
    kinds: tuple[Kind, ...] = ()
    if printed * derived < 0:
        kinds += (Kind.SIGN,)
    if abs(printed) != abs(derived):
        kinds += (Kind.COEFFICIENT,)
    return kinds, sum(WEIGHT[kind] for kind in kinds)


def between_factors(printed: Factors, derived: Factors, symbols: Mapping[str, Symbol]) -> Errors | None:
    """The errors between two products of symbols; None where they have too little in common."""
    powers, right_powers = Counter(dict(printed)), Counter(dict(derived))
    kept = powers & right_powers
    wrong, right = powers - kept, right_powers - kept
    if wrong.total() + right.total() > REACH:
        return None
    kinds, weight = _dots(wrong, right, symbols)
    if wrong and right:
        exchanged = max(len(wrong), len(right))
        one = exchanged == 1 and wrong.total() == right.total()
        weight += WEIGHT[Kind.SYMBOL] if one else SECOND_SYMBOL * exchanged
        weight += 0 if one else LOST_SYMBOL * abs(wrong.total() - right.total())
        kinds += (Kind.SYMBOL,) * exchanged
        roles = {symbols[name].role for name in (*wrong, *right)}
        if one and len(roles) > 1 and roles <= DOTS.keys():  # of different coordinates, with another number of dots
            weight += WEIGHT[Kind.RATE]
            kinds += (Kind.RATE,)
    for name, power in (wrong or right).items() if not (wrong and right) else ():
        rate = symbols[name].role in DOTS and name in kept
        kinds += (Kind.RATE,) if rate else (Kind.SYMBOL,)
        weight += POWER if rate and power == 1 else LOST_SYMBOL * power
    return (kinds, weight) if weight < LIMIT else None


def _dots(wrong: Counter[str], right: Counter[str], symbols: Mapping[str, Symbol]) -> Errors:
    """Dots too few or too many: what is left of a coordinate on both sides; takes it out of both counters."""
    kinds: tuple[Kind, ...] = ()
    weight = 0.0
    # a product may have q_1 and v_1 both: all dots of one coordinate are compared at once, whatever their number
    moving = {symbols[name].index for name in wrong if symbols[name].role in DOTS}
    for index in sorted(moving):
        printed, derived = (
            [name for name in side if symbols[name].role in DOTS and symbols[name].index == index]
            for side in (wrong, right)
        )
        if not derived:
            continue
        weight += WEIGHT[Kind.RATE]
        if len(printed) > 1 or len(derived) > 1 or wrong[printed[0]] != right[derived[0]]:
            weight += POWER - WEIGHT[Kind.RATE]
        kinds += (Kind.RATE,)
        for name in (*printed, *derived):
            wrong.pop(name, None)
            right.pop(name, None)
    return kinds, weight
