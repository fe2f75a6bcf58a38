"""Declarations of symbols with placeholders: `{}^<i>r_{C_{<i><x>}}` stands for that of every link and axis."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

from rttrr_pin.derivation.symbolic_robot import AXES
from rttrr_pin.derivation.symbols import DIMENSIONS, Role, Symbol
from rttrr_pin.derivation.tables import Table, shown

PAIRS = ("xy", "xz", "yz")

LONGEST_TEXT, MOST_SYMBOLS = 200, 2000
"""Characters of a name or spelling, and symbols that one entry may stand for."""

RESERVED = re.compile(r"(q|v|a|s|c|sign|tau)_j?\d+(_m?\d+)*")
"""Names that symbols of motion have."""

KEYS = ("name", "latex", "dimension", "equal", "i", "k")


@dataclass(frozen=True, slots=True)
class Declaration:
    """A symbol as a table declares it.

    Attributes:
        symbol: the symbol.
        spellings: how it is printed; corrections use the first.
        equal: the name of the symbol that it is equal to, as J_yx is to J_xy; empty for most.
    """

    symbol: Symbol
    spellings: tuple[str, ...]
    equal: str = ""


def declarations(table: Table, links: int, latex: bool) -> Iterator[Declaration]:
    """The symbols that an entry of [[symbol]] stands for; `<i>` runs over so many links.

    Raises:
        EquationError: the entry lacks a name or a spelling, or has a dimension that does not exist.
    """
    table.only(KEYS)
    name = table.get("name", str)
    spellings = table.texts("latex", default=[name])
    if not spellings:
        raise table.error("latex is []: leave it out, and the name stands for itself")
    if any(len(text) > LONGEST_TEXT for text in (name, *spellings)):
        raise table.error(f"has a text of more than {LONGEST_TEXT} characters: no symbol is printed so")
    dimension = table.get("dimension", str)
    if dimension not in DIMENSIONS:
        raise table.error(f"dimension is {shown(dimension)}: expected {', '.join(DIMENSIONS)}")
    for values in _combinations(table, (name, *spellings), links):
        identifier = filled(name, values)
        if not identifier.isidentifier():
            raise table.error(f"name is {shown(identifier)}: expected letters, digits and _, such as r_C1x")
        if RESERVED.fullmatch(identifier):
            raise table.error(
                f"name is {shown(identifier)}, which stands for a coordinate, a rate, an acceleration, a sine or a "
                "cosine: choose another name; how it is printed is for `latex` to say"
            )
        printed = tuple(dict.fromkeys(filled(spelling, values, latex) for spelling in spellings))
        symbol = Symbol(identifier, printed[0], Role.PARAMETER, DIMENSIONS[dimension])
        yield Declaration(symbol, printed, filled(table.get("equal", str, ""), values))


def _combinations(table: Table, texts: Sequence[str], links: int) -> Iterator[dict[str, str]]:
    """All values of the placeholders that occur."""
    ranges: dict[str, Sequence[str]] = {
        "i": [str(i) for i in table.get("i", list, list(range(1, links + 1)))],
        "k": [str(k) for k in table.get("k", list, [])],
        "x": AXES,
        "xy": PAIRS,
    }
    used = [key for key in ranges if any(f"<{key}>" in text or f"<{key[::-1]}>" in text for text in texts)]
    if prod(len(ranges[key]) for key in used) > MOST_SYMBOLS or any(len(x) > 10 for key in used for x in ranges[key]):
        raise table.error(f"stands for more than {MOST_SYMBOLS} symbols, or has a number of more than 10 digits")
    for values in product(*(ranges[key] for key in used)):
        yield dict(zip(used, values, strict=True))


def filled(text: str, values: Mapping[str, str], latex: bool = False) -> str:
    """A template with values for its placeholders; in LaTeX, numbers of several digits get braces."""
    for key, value in values.items():
        shown = f"{{{value}}}" if latex and value.isdigit() and len(value) > 1 else value
        text = text.replace(f"<{key}>", shown)
        if len(key) > 1:
            text = text.replace(f"<{key[::-1]}>", value[::-1])
    return text
