"""C(q, v) is not unique: another is right where it is the same times the rates as that of the Christoffel symbols."""

from __future__ import annotations

from collections.abc import Mapping

from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.match import Matching
from rttrr_pin.auditing.normalise import equal
from rttrr_pin.auditing.publication import parts_of
from rttrr_pin.derivation.symbols import Expression, Symbol, expression_of, factors_of

OTHER = "not the C of the Christoffel symbols; its rows times the rates are the same, which is all that C must give"
INCOMPLETE = (
    "the entry is not that of the Christoffel symbols, and C is not unique: state all entries of its row, {row}, so "
    "that the row times the rates can be compared"
)


def other_matrices(
    matchings: Mapping[str, Matching], derived: Derived, rates: int, aliases: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, str]]:
    """Entries of C that differ from the Christoffel symbols and may be right.

    Returns:
        Why each is right after all, by name; and what the file must say before it can be judged.
    """
    right: dict[str, str] = {}
    open_: dict[str, str] = {}
    for index in {parts_of(name)[1] for name in matchings if parts_of(name)[0] == "C"}:
        row = [f"C{index + 1},{column}" for column in range(1, rates + 1)]
        wrong = [name for name in row if name in matchings and any(pair.kinds for pair in matchings[name].pairs)]
        if not wrong:
            continue
        if any(name not in matchings for name in row):
            open_ |= dict.fromkeys(wrong, INCOMPLETE.format(row=f"{row[0]} to {row[-1]}"))
        elif not any(matchings[name].component.printed.unparsed for name in row):
            symbols: dict[str, Symbol] = {}
            for name in row:
                symbols |= matchings[name].component.symbols
            printed = _times_rates([matchings[name].printed for name in row])
            if equal(printed, _times_rates([derived.expressions[name] for name in row]), symbols, aliases):
                right |= dict.fromkeys(wrong, OTHER)
    return right, open_


def _times_rates(row: list[Expression]) -> Expression:
    return expression_of(
        (x, factors_of({**dict(factors), f"v_{k}": dict(factors).get(f"v_{k}", 0) + 1}))
        for k, entry in enumerate(row, start=1)
        for factors, x in entry.items()
    )
