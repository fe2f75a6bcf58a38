"""Findings: what is wrong with a printed equation, term by term, each with an id and evidence of its own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise

from rttrr_pin.auditing.edits import Kind
from rttrr_pin.auditing.match import Numeral, Pair
from rttrr_pin.auditing.printed import PrintedTerm
from rttrr_pin.derivation.symbols import NUMBER, Dimension, Factors, Symbol


@dataclass(frozen=True, slots=True)
class Finding:
    """One slip.

    Attributes:
        id: the component and a number, such as F5z.3; in printed order, then what is missing.
        kind: what went wrong.
        printed: the term as printed; None where it is missing.
        derived: the term that is right, in the language of the publication; None where there should be none.
        dimension_ok: whether the printed term has the dimension of its quantity, which needs no derivation; None
            where nothing is printed, or a symbol is unknown.
        note: how an ambiguous or stray token was read, and what the slip may have been.
    """

    id: str
    kind: Kind
    printed: str | None
    derived: str | None
    dimension_ok: bool | None
    note: str = ""


def findings_of(
    name: str,
    pairs: Sequence[Pair],
    printed: Sequence[PrintedTerm],
    symbols: Mapping[str, Symbol],
    dimension: Dimension,
    writing: Callable[[Sequence[Numeral]], list[str]],
) -> tuple[Finding, ...]:
    """The findings of one component.

    Args:
        name: of the component.
        pairs: printed with derived terms.
        printed: the printed terms.
        symbols: what the names stand for.
        dimension: that every term should have.
        writing: turns terms into text, in the language of the publication.
    """
    hints = _hints(pairs)
    found: list[Finding] = []
    for pair in pairs:
        for kind in pair.kinds:
            reading = pair.reading
            right = None if reading is None or reading.unknown else _dimension(reading.factors, symbols) == dimension
            notes = [reading.note if reading else "", hints.get(id(pair), "")]
            if reading and reading.unknown:
                notes.append(f"no symbol is spelled {', '.join(reading.unknown)}")
            found.append(
                Finding(
                    id=f"{name}.{len(found) + 1}",
                    kind=kind,
                    printed=None if pair.place is None else printed[pair.place].text,
                    derived=None if pair.derived is None else writing([pair.derived])[0],
                    dimension_ok=right,
                    note="; ".join(note for note in notes if note),
                )
            )
    return tuple(found)


def _dimension(factors: Factors, symbols: Mapping[str, Symbol]) -> Dimension:
    total = NUMBER
    for name, power in factors:
        total = total.times(symbols[name].dimension, power)
    return total


def _hints(pairs: Sequence[Pair]) -> dict[int, str]:
    """What may have happened to several terms at once: a sign lost between two, or put into one."""
    hints: dict[int, str] = {}
    extra = [pair for pair in pairs if pair.place is not None and pair.derived is None]
    missing = [pair for pair in pairs if pair.place is None]
    for pair in extra:
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
    return Counter(dict((pair.derived or (Fraction(0), ()))[1]))


def _product(one: Pair, other: Pair) -> Counter[str]:
    return _powers(one) + _powers(other)


def _printed_product(one: Pair, other: Pair) -> Counter[str]:
    total: Counter[str] = Counter()
    for pair in (one, other):
        if pair.reading:
            total.update(dict(pair.reading.factors))
    return total
