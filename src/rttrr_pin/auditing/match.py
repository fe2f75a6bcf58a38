"""Pairs the printed terms of one component with the derived ones, by the least total weight of slips.

Both sides are sums of products modulo c^2 + s^2 = 1. The assignment with the least total weight is found exactly
(Hungarian method); a term without a partner is in excess, or missing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from scipy.optimize import linear_sum_assignment

from rttrr_pin.auditing.edits import LIMIT, REACH, WEIGHT, Kind, between_factors, between_numbers
from rttrr_pin.auditing.printed import PrintedTerm, Reading
from rttrr_pin.derivation.symbols import Factors, Symbol, Terms, renamed_factors

Numeral = tuple[Fraction, Factors]
"""A coefficient and the product that it multiplies."""

DOUBT = 0.01
"""The weight of a reading that is not the most literal one, and of a letter for another that is equal to it."""

LATER = 1e-6
"""How much less a copy weighs for each place that it stands behind the first."""

CROWD = 0.1
"""The weight that a second slip in the same term adds to its own: slips fall on different terms more often."""


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


@dataclass(frozen=True)
class Problem:
    """What is to be paired.

    Attributes:
        printed: the terms as printed.
        symbols: what the names stand for.
        twins: letters that are equal to others.
    """

    printed: Sequence[PrintedTerm]
    symbols: Mapping[str, Symbol]
    twins: Mapping[str, str]


def match(
    printed: Sequence[PrintedTerm],
    derived: Terms,
    symbols: Mapping[str, Symbol],
    twins: Mapping[str, str] | None = None,
) -> list[Pair]:
    """The pairing with the least total weight.

    Args:
        printed: the terms as printed.
        derived: the right-hand side that is right, in the form of c^2 and s^2 that the text chose.
        symbols: what the names stand for.
        twins: letters that are equal to others: one for the other is no slip.

    Returns:
        A pair for each printed term in order, then one for each derived term that is missing.
    """
    problem = Problem(printed, symbols, twins or {})
    settled, rest, owed = _added_up(printed, derived)
    best = _assign(problem, rest, owed, settled)
    for factors in _partly_printed(best):
        other = _assign(problem, *_paid(printed, rest, owed, settled, factors))
        if _weight(other) < _weight(best):
            best = other
            rest, owed, settled = _paid(printed, rest, owed, settled, factors)
    return sorted(best, key=lambda pair: (pair.place is None, pair.place or 0))


def _weight(pairs: Iterable[Pair]) -> float:
    return sum(pair.weight for pair in pairs)


def _matching(place: int, reading: Reading) -> Pair:
    return Pair(place, reading, (reading.coefficient, reading.factors), (), 0.0)


def _added_up(printed: Sequence[PrintedTerm], derived: Terms) -> tuple[list[Pair], list[int], list[Numeral]]:
    """Terms with one product that add up to its coefficient; the places that are left; the derived terms left."""
    owed = dict(derived)
    by_factors: dict[Factors, list[int]] = {}
    for place, term in enumerate(printed):
        by_factors.setdefault(term.readings[0].factors, []).append(place)
    settled: list[Pair] = []
    for factors, places in by_factors.items():
        total = sum((printed[place].readings[0].coefficient for place in places), Fraction(0))
        if len(places) > 1 and total == owed.get(factors, 0):
            settled += [_matching(place, printed[place].readings[0]) for place in places]
            owed.pop(factors, None)
    done = {pair.place for pair in settled}
    left = [place for place in range(len(printed)) if place not in done]
    return settled, left, [(coefficient, factors) for factors, coefficient in owed.items()]


def _partly_printed(pairs: Iterable[Pair]) -> list[Factors]:
    """Products whose coefficient is printed too small: perhaps the other part is printed too, and wrongly."""
    return [
        pair.derived[1]
        for pair in pairs
        if pair.reading
        and pair.derived
        and pair.reading.factors == pair.derived[1]
        and pair.kinds == (Kind.COEFFICIENT,)
        and abs(pair.reading.coefficient) < abs(pair.derived[0])
    ]


def _paid(
    printed: Sequence[PrintedTerm], rest: list[int], owed: list[Numeral], settled: list[Pair], factors: Factors
) -> tuple[list[int], list[Numeral], list[Pair]]:
    """The same with the printed part of one coefficient taken as right, and the other part still owed."""
    part = [place for place in rest if printed[place].readings[0].factors == factors]
    paid = sum((printed[place].readings[0].coefficient for place in part), Fraction(0))
    still = [(coefficient - paid if other == factors else coefficient, other) for coefficient, other in owed]
    matching = [_matching(place, printed[place].readings[0]) for place in part]
    return [place for place in rest if place not in part], still, [*settled, *matching]


def _assign(problem: Problem, rest: Sequence[int], owed: Sequence[Numeral], settled: Sequence[Pair]) -> list[Pair]:
    """The least assignment of what is left, beside the pairs that are settled."""
    n, m = len(rest), len(owed)
    candidates = _candidates(problem, rest, owed)
    unpaired = _unpaired(problem.printed, rest, {*owed, *(pair.derived for pair in settled if pair.derived)})
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
    return [*settled, *chosen]


def _candidates(problem: Problem, rest: Sequence[int], owed: Sequence[Numeral]) -> dict[tuple[int, int], Pair]:
    """Every pair of a printed and a derived term that have enough in common."""
    readings = [
        (i, k, reading) for i, place in enumerate(rest) for k, reading in enumerate(problem.printed[place].readings)
    ]
    mine = [renamed_factors(reading.factors, problem.twins) for _, _, reading in readings]
    theirs = [renamed_factors(factors, problem.twins) for _, factors in owed]
    found: dict[tuple[int, int], Pair] = {}
    for row, j in zip(*np.nonzero(_distances(mine, theirs) <= REACH), strict=True):
        i, k, reading = readings[row]
        slips = between_factors(mine[row], theirs[j], problem.symbols)
        if slips is None:
            continue
        kinds, weight = between_numbers(reading.coefficient, owed[j][0])
        kinds = (*slips[0], *kinds)
        weight += slips[1] + DOUBT * (k + (reading.factors != owed[j][1])) + CROWD * max(0, len(kinds) - 1)
        if weight < LIMIT and ((i, j) not in found or weight < found[i, j].weight):
            found[i, j] = Pair(rest[i], reading, owed[j], kinds, weight)
    return found


def _distances(mine: Sequence[Factors], theirs: Sequence[Factors]) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """How many factors differ, for each pair of products."""
    columns = {name: k for k, name in enumerate(dict.fromkeys(name for x in (*mine, *theirs) for name, _ in x))}

    def table(products: Sequence[Factors]) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
        powers = np.zeros((len(products), len(columns)), dtype=np.int64)
        for row, factors in enumerate(products):
            for name, power in factors:
                powers[row, columns[name]] = power
        return powers

    distances: np.ndarray[tuple[int, ...], np.dtype[np.int64]] = np.abs(table(mine)[:, None] - table(theirs)).sum(
        axis=2
    )
    return distances


def _unpaired(printed: Sequence[PrintedTerm], rest: Sequence[int], right: set[Numeral]) -> list[Pair]:
    """Each printed term as one that nothing derived corresponds to: printed twice, or in excess."""
    copies = Counter((term.readings[0].coefficient, term.readings[0].factors) for term in printed)
    pairs = []
    for place in rest:
        reading = printed[place].readings[0]
        numeral = (reading.coefficient, reading.factors)
        kind = Kind.DUPLICATE if copies[numeral] > 1 and numeral in right else Kind.EXTRA
        later = LATER * place if kind is Kind.DUPLICATE else 0.0  # of two copies, the second is one too many
        pairs.append(Pair(place, reading, None, (kind,), WEIGHT[kind] - later))
    return pairs


def corrected(pairs: Sequence[Pair]) -> list[tuple[Numeral, bool]]:
    """The terms as they should be printed, in printed order, and whether each was changed."""
    return [(pair.derived, bool(pair.kinds)) for pair in pairs if pair.derived is not None]


def as_terms(numerals: Iterable[Numeral]) -> Terms:
    """A sum of terms as a polynomial."""
    total: Terms = {}
    for coefficient, factors in numerals:
        total[factors] = total.get(factors, Fraction(0)) + coefficient
    return {factors: coefficient for factors, coefficient in total.items() if coefficient}
