"""Stage 5: pairs of terms -> what is wrong with the printed one, term by term."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise

from rttrr_pin.auditing.differences import Kind
from rttrr_pin.auditing.match import Matching, Pair
from rttrr_pin.derivation.symbols import Dimension, Factors, Role, Symbol, Term, dimension_of

KEYS = {Role.COORDINATE: "position", Role.RATE: "velocity", Role.ACCELERATION: "acceleration"}
"""The keys of [coordinates]."""


@dataclass(frozen=True, slots=True)
class TermError:
    """One error in one term.

    Attributes:
        kind: what went wrong.
        printed: the term as printed; None where it is missing.
        derived: the term that is right; None where there should be none.
        dimension_ok: whether the printed term has the dimension of its quantity; None where nothing is printed.
        note: how an ambiguous or stray token was read, and how the error may have come about.
    """

    kind: Kind
    printed: str | None
    derived: Term | None
    dimension_ok: bool | None
    note: str


@dataclass(frozen=True)
class Classified:
    """What is wrong with a component.

    Attributes:
        matching: printed with derived terms.
        errors: in printed order, then what is missing; none where a symbol is undeclared, since it may be right.
        undeclared: for each spelling that no symbol has, what to declare.
        corrected: the terms as they should be printed, in printed order, and whether each was changed.
        notes: readings of ambiguous or stray tokens in terms that are right.
    """

    matching: Matching
    errors: tuple[TermError, ...]
    undeclared: tuple[str, ...]
    corrected: tuple[tuple[Term, bool], ...]
    notes: tuple[str, ...]


def classify(matching: Matching, dimension: Dimension) -> Classified:
    """What is wrong with a component.

    Args:
        matching: printed with derived terms.
        dimension: that every term should have.
    """
    pairs, symbols = matching.pairs, matching.component.symbols
    undeclared = tuple(_undeclared(pairs, symbols))
    if any(pair.kinds for pair in pairs):
        corrected = [(pair.derived, bool(pair.kinds)) for pair in pairs if pair.derived is not None]
    else:
        corrected = [(pair.reading.term, False) for pair in pairs if pair.reading is not None]
    return Classified(
        matching,
        () if undeclared else tuple(_errors(matching, dimension)),
        undeclared,
        tuple(corrected),
        tuple(pair.reading.note for pair in pairs if pair.reading and pair.reading.note and not pair.kinds),
    )


def _errors(matching: Matching, dimension: Dimension) -> Iterator[TermError]:
    hints = _hints(matching.pairs)
    terms, symbols = matching.component.printed.terms, matching.component.symbols
    for pair in matching.pairs:
        for kind in pair.kinds:
            reading = pair.reading
            yield TermError(
                kind,
                None if pair.place is None else terms[pair.place].text,
                pair.derived,
                None if reading is None else dimension_of(reading.factors, symbols) == dimension,
                "; ".join(filter(None, (reading.note if reading else "", hints.get(id(pair), "")))),
            )


def _undeclared(pairs: Sequence[Pair], symbols: Mapping[str, Symbol]) -> Iterator[str]:
    """For each spelling that no symbol has, what to declare, by the derived terms that stand beside it."""
    beside: dict[str, Counter[str]] = {}
    for pair in pairs:
        for spelling in pair.reading.unknown if pair.reading else ():
            candidates = beside.setdefault(spelling, Counter())
            if pair.reading and pair.derived:
                candidates.update(name for name, _ in pair.derived[1] if name not in dict(pair.reading.factors))
    for spelling, candidates in beside.items():
        likely = [symbols[name] for name, _ in candidates.most_common(1)]
        hint = f" (the derivation has `{likely[0].latex}` there)" if likely else ""
        where = "in [[symbol]]" if likely else "in [[symbol]], or in [coordinates] if it belongs to one"
        if likely and likely[0].role in KEYS:
            where = f"in [coordinates], as the {KEYS[likely[0].role]} of coordinate {likely[0].index}"
        yield f"`{spelling}` is no declared symbol{hint}: declare it {where}, or correct the text"


def _hints(pairs: Sequence[Pair]) -> dict[int, str]:
    """What may have happened to several terms at once: a sign lost between two, or put into one."""
    hints: dict[int, str] = {}
    missing = [pair for pair in pairs if pair.place is None]
    for pair in (pair for pair in pairs if pair.place is not None and pair.derived is None):
        for one, other in combinations(missing, 2):
            if pair.reading and _product(one, other) == Counter(dict(pair.reading.factors)):
                hints[id(pair)] = "the product of two terms that are missing: the sign between them was lost"
                hints[id(one)] = hints[id(other)] = "run together with another missing term, into one product"
    printed = [pair for pair in pairs if pair.place is not None]
    for lacking in missing:
        for one, other in pairwise(printed):
            if (one.kinds or other.kinds) and lacking.derived and _printed_product(one, other) == _powers(lacking):
                hints[id(lacking)] = "the product of two neighbours as printed: the sign between them is too many"
    return hints


def _powers(pair: Pair) -> Counter[str]:
    nothing: tuple[Fraction, Factors] = (Fraction(0), ())
    return Counter(dict((pair.derived or nothing)[1]))


def _product(one: Pair, other: Pair) -> Counter[str]:
    return _powers(one) + _powers(other)


def _printed_product(one: Pair, other: Pair) -> Counter[str]:
    total: Counter[str] = Counter()
    for pair in (one, other):
        if pair.reading:
            total.update(dict(pair.reading.factors))
    return total
