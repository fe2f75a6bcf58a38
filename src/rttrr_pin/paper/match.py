"""Pairs the printed terms of one component with the derived ones, by the least total weight of slips.

Both sides are sums of products modulo c^2 + s^2 = 1. What is equal is paired first; of the rest, the assignment with
the least total weight is found exactly (Hungarian method), a term without a partner being in excess or missing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from scipy.optimize import linear_sum_assignment

from rttrr_pin.paper.edits import LIMIT, WEIGHT, Kind, between_factors, between_numbers
from rttrr_pin.paper.printed import PrintedTerm, Reading
from rttrr_pin.symbolic.symbols import Factors, Symbol, Terms

Numeral = tuple[Fraction, Factors]
"""A coefficient and the product that it multiplies."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A printed term and the derived one that it should be.

    Attributes:
        place: of the printed term in the component; None where it is missing.
        reading: how the printed term was read; None where it is missing.
        derived: what is right; None where the printed term is in excess.
        kinds: what went wrong; empty where it matches.
        weight: of the slips.
    """

    place: int | None
    reading: Reading | None
    derived: Numeral | None
    kinds: tuple[Kind, ...]
    weight: float


def match(printed: Sequence[PrintedTerm], derived: Terms, symbols: Mapping[str, Symbol]) -> list[Pair]:
    """The pairing with the least total weight.

    Args:
        printed: the terms as printed.
        derived: the right-hand side that is right, in the form of c^2 and s^2 that the text chose.
        symbols: what the names stand for.

    Returns:
        A pair for each printed term in order, then one for each derived term that is missing.
    """
    pairs, rest, owed = _equal(printed, derived)
    best = _assign(printed, rest, owed, symbols, pairs)
    for factors in _partly_printed(printed, rest, derived):
        other_rest, other_owed, other_pairs = _settled(printed, rest, owed, pairs, factors)
        other = _assign(printed, other_rest, other_owed, symbols, other_pairs)
        if _weight(other) < _weight(best):
            best, rest, owed, pairs = other, other_rest, other_owed, other_pairs
    return sorted(best, key=lambda pair: (pair.place is None, pair.place if pair.place is not None else 0))


def _weight(pairs: Iterable[Pair]) -> float:
    return sum(pair.weight for pair in pairs)


def _equal(printed: Sequence[PrintedTerm], derived: Terms) -> tuple[list[Pair], list[int], list[Numeral]]:
    """Pairs of terms that are equal; the places that are left; the derived terms that are left."""
    owed = dict(derived)
    pairs: list[Pair] = []
    by_factors: dict[Factors, list[tuple[int, Reading]]] = {}
    for place, term in enumerate(printed):
        by_factors.setdefault(term.readings[0].factors, []).append((place, term.readings[0]))
    for factors, members in by_factors.items():
        if factors not in owed:
            continue
        taken = _adding_up(members, owed[factors])
        pairs += [_matching(place, reading) for place, reading in taken]
        if taken:
            del owed[factors]
    done = {pair.place for pair in pairs}
    left = [place for place in range(len(printed)) if place not in done]
    return pairs, left, [(coefficient, factors) for factors, coefficient in owed.items()]


def _matching(place: int, reading: Reading) -> Pair:
    return Pair(place, reading, (reading.coefficient, reading.factors), (), 0.0)


def _adding_up(members: Sequence[tuple[int, Reading]], wanted: Fraction) -> Sequence[tuple[int, Reading]]:
    """Which of the terms with one product make up its coefficient: all, one, or all but one."""
    total = sum((reading.coefficient for _, reading in members), Fraction(0))
    if total == wanted:
        return members
    for k, (_, reading) in enumerate(members):
        if reading.coefficient == wanted:
            return members[k : k + 1]
    for k, (_, reading) in enumerate(members):
        if total - reading.coefficient == wanted:
            return [*members[:k], *members[k + 1 :]]
    return ()


def _partly_printed(printed: Sequence[PrintedTerm], rest: Sequence[int], derived: Terms) -> list[Factors]:
    """Products whose printed coefficients fall short of the right one: perhaps the other part is printed wrongly."""
    sums: Counter[Factors] = Counter()
    signs: dict[Factors, set[bool]] = {}
    for place in rest:
        reading = printed[place].readings[0]
        sums[reading.factors] += reading.coefficient  # type: ignore[assignment]
        signs.setdefault(reading.factors, set()).add(reading.coefficient > 0)
    return [
        factors
        for factors, total in sums.items()
        if factors in derived and signs[factors] == {derived[factors] > 0} and abs(total) < abs(derived[factors])
    ]


def _settled(
    printed: Sequence[PrintedTerm], rest: Sequence[int], owed: Sequence[Numeral], pairs: Sequence[Pair], factors: Factors
) -> tuple[list[int], list[Numeral], list[Pair]]:
    """The same with the printed part of one coefficient taken as right, and the other part still owed."""
    part = [place for place in rest if printed[place].readings[0].factors == factors]
    paid = sum((printed[place].readings[0].coefficient for place in part), Fraction(0))
    still = [(coefficient - paid if other == factors else coefficient, other) for coefficient, other in owed]
    settled = [_matching(place, printed[place].readings[0]) for place in part]
    return [place for place in rest if place not in part], still, [*pairs, *settled]


def _assign(
    printed: Sequence[PrintedTerm],
    rest: Sequence[int],
    owed: Sequence[Numeral],
    symbols: Mapping[str, Symbol],
    pairs: Sequence[Pair],
) -> list[Pair]:
    """The least assignment of what is left, beside the pairs that are settled."""
    known = {pair.derived for pair in pairs}
    n, m = len(rest), len(owed)
    candidates = {
        (i, j): candidate
        for i, place in enumerate(rest)
        for j, right in enumerate(owed)
        if (candidate := _candidate(place, printed[place], right, symbols)) is not None
    }
    unpaired = [_unpaired(place, printed[place], known) for place in rest]
    cost = np.full((n + m, n + m), LIMIT * (n + m + 1))
    cost[n:, m:] = 0.0
    for (i, j), candidate in candidates.items():
        cost[i, j] = candidate.weight
    for i, pair in enumerate(unpaired):
        cost[i, m + i] = pair.weight
    for j in range(m):
        cost[n + j, j] = WEIGHT[Kind.MISSING]
    chosen = []
    for i, j in zip(*linear_sum_assignment(cost), strict=True):
        if i < n:
            chosen.append(candidates[i, j] if j < m else unpaired[i])
        elif j < m:
            chosen.append(Pair(None, None, owed[j], (Kind.MISSING,), WEIGHT[Kind.MISSING]))
    return [*pairs, *chosen]


def _candidate(place: int, term: PrintedTerm, right: Numeral, symbols: Mapping[str, Symbol]) -> Pair | None:
    """The reading of a printed term that is nearest to a derived one."""
    best: Pair | None = None
    for k, reading in enumerate(term.readings):
        factors = between_factors(reading.factors, right[1], symbols)
        if factors is None:
            continue
        number, weight = between_numbers(reading.coefficient, right[0])
        total = factors[1] + weight + 0.01 * k  # of two readings as near, the more literal one
        if total < LIMIT and (best is None or total < best.weight):
            best = Pair(place, reading, right, (*factors[0], *number), total)
    return best


def _unpaired(place: int, term: PrintedTerm, known: set[Numeral | None]) -> Pair:
    """A printed term that nothing derived corresponds to."""
    for reading in term.readings:
        if (reading.coefficient, reading.factors) in known:
            return Pair(place, reading, None, (Kind.DUPLICATE,), WEIGHT[Kind.DUPLICATE])
    return Pair(place, term.readings[0], None, (Kind.EXTRA,), WEIGHT[Kind.EXTRA])


def corrected(pairs: Sequence[Pair]) -> list[tuple[Numeral, bool]]:
    """The terms as they should be printed, in printed order, and whether each was changed."""
    return [(pair.derived, bool(pair.kinds)) for pair in pairs if pair.derived is not None]


def as_terms(numerals: Iterable[Numeral]) -> Terms:
    """A sum of terms as a polynomial."""
    total: Terms = {}
    for coefficient, factors in numerals:
        total[factors] = total.get(factors, Fraction(0)) + coefficient
    return {factors: coefficient for factors, coefficient in total.items() if coefficient}


__all__ = ["Numeral", "Pair", "as_terms", "corrected", "match", "replace"]
