"""Symbols that stand for others: what equations say that only define."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from rttrr_pin.auditing.reading.component import check_length
from rttrr_pin.auditing.reading.grammar import UnreadableError, divided, parse, tokens_of, without_time
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Product
from rttrr_pin.auditing.reading.rows import STOPS, plain_lines
from rttrr_pin.auditing.reading.trees import products_of, single_symbol
from rttrr_pin.auditing.reading.vocabulary import Vocabulary

MOST_FACTORS = 2000
"""Of one abbreviation, those of the abbreviations in it included."""

Name = TypeVar("Name")


def collected(
    texts: Iterable[str], define: Callable[[str, Mapping[Name, Group]], tuple[Name, Group] | None]
) -> dict[Name, Group]:
    """The abbreviations that texts define, in order: each may use those before it. The first definition counts.

    Args:
        texts: of the equations that only define.
        define: reads one, with the abbreviations so far; None where it defines none.
    """
    groups: dict[Name, Group] = {}
    sizes: dict[str, int] = {}
    for text in texts:
        defined = define(text, groups)
        if defined is not None and defined[0] not in groups:
            name, group = defined
            size = _size(group.products, sizes)
            if size <= MOST_FACTORS:
                groups[name], sizes[group.abbreviated] = group, size
    return groups


def _size(products: Sequence[Product], sizes: Mapping[str, int]) -> int:
    groups = [factor.body for product in products for factor in product.factors if isinstance(factor.body, Group)]
    within = (
        sizes[x.abbreviated] if x.abbreviated else _size(x.products, sizes) + _size(x.divisor, sizes) for x in groups
    )
    return sum(len(product.factors) for product in products) + sum(within)


def defined_in_latex(
    text: str, abbreviations: Mapping[Atom, Group], vocabulary: Vocabulary
) -> tuple[Atom, Group] | None:
    r"""The symbol that a text such as `h = m_2 l_1 l_{c2} \sin q_2` defines; None where it defines no new symbol."""
    try:
        check_length(text)
        tokens = [token for token in plain_lines(without_time(tokens_of(text))) if token.type != "AMPERSAND"]
        sides = divided(tokens, "EQUALS")
        if len(sides) != 2:
            return None
        while sides[1] and sides[1][-1].type in STOPS:
            sides[1].pop()
        symbol = single_symbol(products_of(parse(sides[0], 0)))
        products = products_of(parse(sides[1], len(text)))
    except (UnreadableError, RecursionError):
        return None
    atom = None if symbol is None or symbol.exponent is not None else symbol.atom
    if atom is None or atom in vocabulary:
        return None
    return atom, Group(expanded(products, abbreviations), 0, 0, abbreviated=str(atom), text=text)


def expanded(products: Sequence[Product], abbreviations: Mapping[Atom, Group]) -> tuple[Product, ...]:
    """The products with the sums that abbreviations stand for."""
    return tuple(
        replace(product, factors=tuple(_expanded(factor, abbreviations) for factor in product.factors))
        for product in products
    )


def _expanded(factor: Factor, abbreviations: Mapping[Atom, Group]) -> Factor:
    if isinstance(factor.body, Group):
        inner, divisor = (expanded(x, abbreviations) for x in (factor.body.products, factor.body.divisor))
        return replace(factor, body=replace(factor.body, products=inner, divisor=divisor))
    atom = factor.atom
    if atom is None or atom not in abbreviations:
        return factor
    return replace(factor, body=abbreviations[atom], prefix="")
