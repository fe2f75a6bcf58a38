"""Stage 3: derived sum -> the same sum in the form that the text chose: c^2 or s^2, and c_12 for sums of angles."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm
from rttrr_pin.derivation.ring import Ring
from rttrr_pin.derivation.symbols import Expression, Factors, Role, Symbol, Term, factors_of, renamed


@dataclass(frozen=True)
class Normalised:
    """A printed component beside the derived one, in the same form.

    Attributes:
        printed: the component.
        derived: what is right.
        symbols: of both, by name; sums of angles and symbols that nothing declares included.
    """

    printed: PrintedComponent
    derived: Expression
    symbols: Mapping[str, Symbol]


def normalise(printed: PrintedComponent, name: str, derived: Derived) -> Normalised:
    """Bring a derived component into the form of the printed one.

    Args:
        printed: the component as read.
        name: of the component, such as F5z.
        derived: what is right.
    """
    symbols = with_printed_symbols(derived.symbols, printed.terms)
    form = folded(derived.expressions[name], sums_of_angles(symbols))
    angles = [name.removeprefix("c_") for name, symbol in symbols.items() if symbol.role is Role.COSINE]
    return Normalised(printed, in_printed_form(form, printed.terms, angles), symbols)


def with_printed_symbols(known: Mapping[str, Symbol], terms: Iterable[PrintedTerm]) -> Mapping[str, Symbol]:
    """The symbols with the sums of angles and the unknown symbols of printed terms."""
    names = {name: None for term in terms for x in term.readings for name, _ in x.factors if name not in known}
    if not names:
        return known
    sums = {symbol.name: symbol for symbol in _sum_symbols(sums_of_angles(names))}
    unknown = {name: Symbol(name, name, Role.UNKNOWN) for name in names if name not in sums}
    return {**known, **sums, **unknown}


def sums_of_angles(names: Iterable[str]) -> list[str]:
    """The sums of angles among names of sines and cosines, such as `1_2` of `c_1_2`, and those that make them up."""
    needed: set[str] = set()
    for name in names:
        parts = name[2:].split("_")
        if name[:2] in ("c_", "s_") and all(part.isdigit() for part in parts):
            needed |= {"_".join(parts[:k]) for k in range(2, len(parts) + 1)}
    return sorted(needed, key=lambda angle: (angle.count("_"), angle))


def _sum_symbols(angles: Iterable[str]) -> list[Symbol]:
    """Sines and cosines of sums of angles."""
    symbols = []
    for angle in angles:
        subscript = angle.replace("_", "") if all(len(x) == 1 for x in angle.split("_")) else angle.replace("_", ",")
        symbols.append(Symbol(f"s_{angle}", f"s_{{{subscript}}}", Role.SINE))
        symbols.append(Symbol(f"c_{angle}", f"c_{{{subscript}}}", Role.COSINE))
    return symbols


def folded(terms: Expression, angles: Iterable[str]) -> Expression:
    """The same sum with c_1 c_2 - s_1 s_2 written c_12, and s_1 c_2 + c_1 s_2 written s_12."""
    result = dict(terms)
    for angle in angles:
        first, last = angle.rsplit("_", 1)
        _fold(result, (f"c_{first}", f"c_{last}"), (f"s_{first}", f"s_{last}"), -1, f"c_{angle}")
        _fold(result, (f"s_{first}", f"c_{last}"), (f"c_{first}", f"s_{last}"), 1, f"s_{angle}")
    return result


def _fold(terms: Expression, one: tuple[str, str], other: tuple[str, str], sign: int, name: str) -> None:
    """One x y + sign z w = name, wherever both products are there with coefficients that fit."""
    for factors in list(terms):
        partner = _exchanged(factors, one, other)
        if factors not in terms or partner is None or terms.get(partner) != sign * terms[factors]:
            continue
        folded_factors = _exchanged(factors, one, (name,))
        if folded_factors is None:
            continue
        coefficient = terms.pop(factors)
        del terms[partner]
        terms[folded_factors] = terms.get(folded_factors, Fraction(0)) + coefficient


def _exchanged(factors: Factors, old: Iterable[str], new: Iterable[str]) -> Factors | None:
    """The product with other symbols in place of some; None where they are not all in it."""
    powers = Counter(dict(factors))
    for name in old:
        if not powers[name]:
            return None
        powers[name] -= 1
    powers.update(new)
    return factors_of(powers)


def in_printed_form(derived: Expression, printed: Iterable[PrintedTerm], angles: Iterable[str]) -> Expression:
    """The derived sum with each pair of 1, c^2 and s^2 that the text uses for the same product.

    Args:
        derived: free of squares of sines.
        printed: the terms as printed.
        angles: suffixes of the angles, such as `4` of `c_4`.

    Returns:
        An equal sum, with as many printed terms in it as can be.
    """
    text = Counter({term.literal: 1 for term in printed})
    products = Counter(factors for _, factors in text)
    result = dict(derived)
    for angle in angles:
        sine, cosine = f"s_{angle}", f"c_{angle}"
        if not any((sine, 2) in factors for factors in products):
            continue
        for cofactor, (one, squared) in _by_cofactor(result, cosine).items():
            result = _rewritten(result, cofactor, (one, squared), (sine, cosine), text)
    return result


def _by_cofactor(terms: Expression, cosine: str) -> dict[Factors, tuple[Fraction, Fraction]]:
    """For each product without c^2: its own coefficient, and that of c^2 times it."""
    pairs: dict[Factors, tuple[Fraction, Fraction]] = {}
    for factors in terms:
        powers = dict(factors)
        if powers.get(cosine, 0) >= 2:
            powers[cosine] -= 2
            cofactor = factors_of(powers)
            pairs[cofactor] = (terms.get(cofactor, Fraction(0)), terms[factors])
    return pairs


def _rewritten(
    terms: Expression,
    cofactor: Factors,
    coefficients: tuple[Fraction, Fraction],
    trigonometric: tuple[str, str],
    text: Counter[Term],
) -> Expression:
    """The sum with the form of one product that has most in common with the text."""
    one, squared = coefficients
    sine, cosine = trigonometric
    times_sine, times_cosine = (_exchanged(cofactor, (), (name, name)) or () for name in (sine, cosine))
    forms = (
        {cofactor: one, times_cosine: squared},
        {cofactor: one + squared, times_sine: -squared},
        {times_cosine: one + squared, times_sine: one},
    )

    def likeness(form: Expression) -> tuple[int, int, int]:
        there = [(coefficient, factors) for factors, coefficient in form.items() if coefficient]
        printed = {factors for _, factors in text}
        return sum(text[x] for x in there), sum(factors in printed for _, factors in there), -len(there)

    best = max(forms, key=likeness)
    rest = {factors: x for factors, x in terms.items() if factors not in (cofactor, times_cosine, times_sine)}
    return rest | {factors: x for factors, x in best.items() if x}


def add_sums(values: MutableMapping[str, Any], angles: Sequence[str]) -> None:
    """Add sines and cosines of sums of angles, such as `s_1_2`, to those of the angles, in any kind of scalar."""
    for angle in angles:
        first, last = angle.rsplit("_", 1)
        s, c, s_last, c_last = (values[f"{name}_{part}"] for part in (first, last) for name in "sc")
        values[f"s_{angle}"], values[f"c_{angle}"] = s * c_last + c * s_last, c * c_last - s * s_last


def equal(printed: Expression, derived: Expression, symbols: Mapping[str, Symbol], aliases: Mapping[str, str]) -> bool:
    """Whether two sums are equal modulo c^2 + s^2 = 1, sums of angles expanded and equal symbols made one.

    Args:
        printed: a sum in all of the symbols.
        derived: a sum without sums of angles.
        symbols: of both.
        aliases: symbols that are equal to others.
    """
    ring = Ring(symbols.values())
    difference = ring.polynomial(renamed(printed, aliases)) - ring.polynomial(derived)
    values: dict[str, Any] = {name: ring[name] for name in symbols}
    add_sums(values, sums_of_angles(symbols))
    return not len(ring.substituted(difference, values))
