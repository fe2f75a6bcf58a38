"""Stage 4: printed and derived terms -> pairs of them, by the least total weight of errors.

Both sides are sums of products modulo c^2 + s^2 = 1. The assignment with the least total weight is found exactly
(Hungarian method); a term without a partner is in excess, or missing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.differences import LIMIT, REACH, WEIGHT, Kind, between_factors, between_numbers
from rttrr_pin.auditing.normalise import Normalised, equal, normalise
from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm, Reading
from rttrr_pin.derivation.symbols import Expression, Factors, Term, expression_of, renamed_factors

Counts = NDArray[np.int64]

DOUBT = 0.01
"""The weight of a reading that is not the most literal one, and of a symbol for another that is equal to it."""

LATER = 1e-6
"""How much less a copy weighs for each place that it stands behind the first."""

CROWD = 0.1
"""The weight that a second error in the same term adds to its own: errors fall on different terms more often."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A printed term and the derived one that it should be.

    Attributes:
        position: of the printed term in the component; None where it is missing.
        reading: how the printed term was read; None where it is missing.
        derived: what is right; None where the printed term is in excess.
        kinds: what went wrong; empty where it matches.
        weight: of the errors.
    """

    position: int | None
    reading: Reading | None
    derived: Term | None
    kinds: tuple[Kind, ...]
    weight: float


@dataclass(frozen=True)
class Matching:
    """One component as printed, paired with what is derived.

    Attributes:
        component: both, in the same form.
        pairs: one for each printed term in order, then one for each derived term that is missing.
    """

    component: Normalised
    pairs: Sequence[Pair]

    @property
    def weight(self) -> float:
        """Of all errors; a component that cannot be read weighs more than any that can."""
        return 1e6 if self.component.printed.unparsed else _weight(self.pairs)

    @property
    def printed(self) -> Expression:
        """The printed sum, by the readings that were taken."""
        return expression_of(pair.reading.term for pair in self.pairs if pair.reading)

    def as_right(self) -> Matching:
        """The same with nothing wrong, where it is equal to what is derived in another way."""
        return replace(self, pairs=[replace(x, kinds=(), weight=0.0) for x in self.pairs if x.position is not None])


def match_best(
    printed: PrintedComponent, name: str, derived: Sequence[Derived], aliases: Mapping[str, str]
) -> Matching:
    """Pair a printed component with what is derived, in the symbols that leave the least to explain.

    `derived` has it in the robot's symbols, and perhaps with the equal symbols of `aliases` kept apart.
    """
    merged = replace(printed, terms=tuple(term.renamed(aliases) for term in printed.terms)) if aliases else printed
    ways = [
        match(normalise(component, name, one), aliases)
        for component, one in zip((merged, printed), derived, strict=False)
    ]
    best = min(ways, key=lambda way: way.weight)
    if printed.unparsed or not any(pair.kinds for pair in best.pairs):
        return best
    right = equal(best.printed, derived[0].expressions[name], best.component.symbols, aliases)
    return best.as_right() if right else best


def match(component: Normalised, aliases: Mapping[str, str]) -> Matching:
    """The pairing with the least total weight; a symbol for one that it is equal to, by `aliases`, is no error."""
    settled = _added_up(component)
    best = _assign(component, aliases, settled)
    for pair in best:  # of the first assignment
        if _partly_printed(pair) and pair.derived:
            positions = {pair.position for pair in settled}
            others = [x for x in _literal(component.printed.terms) if x.position not in positions]
            also = [*settled, *(x for x in others if x.derived and x.derived[1] == pair.derived[1])]
            other = _assign(component, aliases, also)
            if _weight(other) < _weight(best):
                best, settled = other, also
    return Matching(component, sorted(best, key=lambda pair: (pair.position is None, pair.position or 0)))


def _weight(pairs: Iterable[Pair]) -> float:
    return sum(pair.weight for pair in pairs)


def _literal(printed: Sequence[PrintedTerm]) -> Iterator[Pair]:
    """Each printed term, read literally, as right."""
    return (Pair(position, term.readings[0], term.literal, (), 0.0) for position, term in enumerate(printed))


def _added_up(component: Normalised) -> list[Pair]:
    """Several terms with one product that add up to its coefficient: all of them are right."""
    printed = component.printed.terms
    totals = expression_of(term.literal for term in printed)
    copies = Counter(term.literal[1] for term in printed)
    right = {x for x, n in copies.items() if n > 1 and totals.get(x, 0) == component.derived.get(x, 0)}
    return [pair for pair, term in zip(_literal(printed), printed, strict=True) if term.literal[1] in right]


def _partly_printed(pair: Pair) -> bool:
    """The coefficient is printed too small: perhaps the other part is printed too, and wrongly."""
    if pair.kinds != (Kind.COEFFICIENT,) or not pair.reading or not pair.derived:
        return False
    coefficient, factors = pair.derived
    return pair.reading.factors == factors and abs(pair.reading.coefficient) < abs(coefficient)


def _assign(component: Normalised, aliases: Mapping[str, str], settled: Sequence[Pair]) -> list[Pair]:
    """The pairs that are settled, and the least assignment of the other printed terms to what is still owed."""
    positions = {pair.position for pair in settled}
    rest = [position for position in range(len(component.printed.terms)) if position not in positions]
    derived = ((coefficient, factors) for factors, coefficient in component.derived.items())
    paid = ((-pair.reading.coefficient, pair.reading.factors) for pair in settled if pair.reading)
    owed = [(coefficient, factors) for factors, coefficient in expression_of([*derived, *paid]).items()]
    n, m = len(rest), len(owed)
    candidates = _candidates(component, aliases, rest, owed)
    unpaired = _unpaired(component.printed.terms, rest, {*owed, *(pair.derived for pair in settled if pair.derived)})
    # n rows of printed terms and m of missing ones, m columns of derived terms and n of excess: all are used once
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


def _candidates(
    component: Normalised, aliases: Mapping[str, str], rest: Sequence[int], owed: Sequence[Term]
) -> dict[tuple[int, int], Pair]:
    """Every pair of a printed and a derived term that have enough in common."""
    readings = [
        (i, k, reading)
        for i, position in enumerate(rest)
        for k, reading in enumerate(component.printed.terms[position].readings)
    ]
    printed = [renamed_factors(reading.factors, aliases) for _, _, reading in readings]
    derived = [renamed_factors(factors, aliases) for _, factors in owed]
    candidates: dict[tuple[int, int], Pair] = {}
    for row, j in zip(*np.nonzero(_distances(printed, derived) <= REACH), strict=True):
        i, k, reading = readings[row]
        errors = between_factors(printed[row], derived[j], component.symbols)
        if errors is None:
            continue
        kinds, weight = between_numbers(reading.coefficient, owed[j][0])
        kinds = (*errors[0], *kinds)
        weight += errors[1] + DOUBT * (k + (reading.factors != owed[j][1])) + CROWD * max(0, len(kinds) - 1)
        if weight < LIMIT and ((i, j) not in candidates or weight < candidates[i, j].weight):
            candidates[i, j] = Pair(rest[i], reading, owed[j], kinds, weight)
    return candidates


def _distances(printed: Sequence[Factors], derived: Sequence[Factors]) -> Counts:
    """How many factors differ, for each pair of products."""
    products = [*printed, *derived]
    columns: dict[str, Counts] = {}
    for row, factors in enumerate(products):
        for name, power in factors:
            columns.setdefault(name, np.zeros(len(products), dtype=np.int64))[row] = power
    distances: Counts = np.zeros((len(printed), len(derived)), dtype=np.int64)
    for powers in columns.values():  # column by column: all at once would take memory for each pair and symbol
        distances += np.abs(powers[: len(printed), None] - powers[len(printed) :])
    return distances


def _unpaired(printed: Sequence[PrintedTerm], rest: Sequence[int], right: set[Term]) -> list[Pair]:
    """Each printed term as one that nothing derived corresponds to: printed twice, or in excess."""
    copies = Counter(term.literal for term in printed)
    pairs = []
    for position in rest:
        reading = printed[position].readings[0]
        kind = Kind.DUPLICATE if copies[reading.term] > 1 and reading.term in right else Kind.EXTRA
        later = LATER * position if kind is Kind.DUPLICATE else 0.0  # of two copies, the second is one too many
        pairs.append(Pair(position, reading, None, (kind,), WEIGHT[kind] - later))
    return pairs
