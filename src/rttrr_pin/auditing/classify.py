"""Stage 5: pairs of terms -> what is wrong with the printed ones, and what should be printed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations, pairwise

from rttrr_pin.auditing.match import Matching, Pair
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Atom
from rttrr_pin.auditing.reading.trees import atom_of
from rttrr_pin.auditing.results import Finding
from rttrr_pin.auditing.spelling import Writing
from rttrr_pin.derivation.symbols import Dimension, Role, Symbol, Term, dimension_of

KEYS = {Role.COORDINATE: "position", Role.RATE: "velocity", Role.ACCELERATION: "acceleration"}
"""The keys of [coordinates]."""

DOTTED: Mapping[tuple[str, ...], Role] = {
    (): Role.COORDINATE,
    (r"\dot",): Role.RATE,
    (r"\ddot",): Role.ACCELERATION,
}
"""What a letter of a coordinate is with so many dots."""


def corrected_terms(matching: Matching) -> list[tuple[Term, bool]]:
    """The terms as they should be printed, in printed order, and whether each was changed."""
    if any(pair.kinds for pair in matching.pairs):
        return [(pair.derived, bool(pair.kinds)) for pair in matching.pairs if pair.derived is not None]
    return [(pair.reading.term, False) for pair in matching.pairs if pair.reading is not None]


def findings(
    matching: Matching, name: str, write: Writing, dimensions: Collection[Dimension] = ()
) -> tuple[Finding, ...]:
    """The errors of a component: in printed order, then what is missing.

    Every term should have a dimension of `dimensions`, or that of a derived term, which may have numbers for symbols.
    """
    symbols = matching.component.symbols
    known = {*dimensions, *(dimension_of(factors, symbols) for factors in matching.component.derived)}
    hints = _hints(matching.pairs)
    terms = matching.component.printed.terms
    errors = [(pair, kind) for pair in matching.pairs for kind in pair.kinds]
    return tuple(
        Finding(
            id=f"{name}.{k}",
            kind=kind,
            printed=None if pair.position is None else terms[pair.position].text,
            derived=None if pair.derived is None else write([pair.derived])[0],
            dimension_ok=None if pair.reading is None else dimension_of(pair.reading.factors, symbols) in known,
            note="; ".join(filter(None, (pair.reading.note if pair.reading else "", hints.get(id(pair), "")))),
        )
        for k, (pair, kind) in enumerate(errors, start=1)
    )


def undeclared(matching: Matching) -> Iterator[str]:
    """For each spelling that no symbol has, what to declare, by the derived terms that stand beside it."""
    symbols = matching.component.symbols
    beside: dict[str, Counter[str]] = {}
    for pair in matching.pairs:
        for spelling in pair.reading.unknown if pair.reading else ():
            candidates = beside.setdefault(spelling, Counter())
            if pair.reading and pair.derived:
                candidates.update(name for name, _ in pair.derived[1] if name not in dict(pair.reading.factors))
    likely = {x: next((symbols[name] for name, _ in counts.most_common(1)), None) for x, counts in beside.items()}
    atoms = {spelling: _atom(spelling) for spelling in likely}
    moving = {
        (atom.letters, atom.subscript): symbol.index
        for spelling, atom in atoms.items()
        if atom is not None and (symbol := likely[spelling]) is not None and symbol.role in KEYS
    }
    for spelling, symbol in likely.items():
        atom = atoms[spelling]
        index = moving.get((atom.letters, atom.subscript)) if atom is not None else None
        if atom is not None and index is not None and atom.accents in DOTTED:  # what moves does so with its dots
            same = next((x for x in symbols.values() if x.role is DOTTED[atom.accents] and x.index == index), None)
            yield to_declare(spelling, same)
        else:
            yield to_declare(spelling, symbol)


def _atom(spelling: str) -> Atom | None:
    try:
        return atom_of(spelling)
    except UnreadableError:  # of Python
        return None


def to_declare(spelling: str, likely: Symbol | None = None) -> str:
    """What to declare for a spelling that no symbol has, and what the derivation is likely to have in its place."""
    hint = f" (the derivation has `{likely.latex}` there)" if likely else ""
    where = "in [[symbol]]" if likely else "in [[symbol]], or in [coordinates] if it belongs to one"
    if likely and likely.role in KEYS:
        where = f"in [coordinates], as the {KEYS[likely.role]} of coordinate {likely.index}"
    return (
        f"`{spelling}` is no declared symbol{hint}: declare it {where}; if it stands for others, add the equation that "
        'says so, with quantity = "definition"; or correct the text'
    )


def _hints(pairs: Sequence[Pair]) -> dict[int, str]:
    """What may have happened to several terms at once: a sign lost between two, or put into one."""
    hints: dict[int, str] = {}
    missing = [pair for pair in pairs if pair.position is None]
    printed = [pair for pair in pairs if pair.position is not None]
    for pair in (pair for pair in printed if pair.derived is None):
        for one, other in combinations(missing, 2):
            if _derived_powers(one) + _derived_powers(other) == _printed_powers(pair):
                hints[id(pair)] = "the product of two terms that are missing: the sign between them was lost"
                hints[id(one)] = hints[id(other)] = "run together with another missing term, into one product"
    for lacking in missing:
        for one, other in pairwise(printed):
            product = _printed_powers(one) + _printed_powers(other)
            if (one.kinds or other.kinds) and product == _derived_powers(lacking):
                hints[id(lacking)] = "the product of two neighbours as printed: the sign between them is too many"
    return hints


def _derived_powers(pair: Pair) -> Counter[str]:
    return Counter(dict(pair.derived[1] if pair.derived else ()))


def _printed_powers(pair: Pair) -> Counter[str]:
    return Counter(dict(pair.reading.factors if pair.reading else ()))
