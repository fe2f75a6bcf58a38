"""Brings a derived sum into the form that a text chose: c^2 or s^2, and c_12 where it has sums of angles."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from fractions import Fraction

from rttrr_pin.auditing.printed import PrintedTerm
from rttrr_pin.derivation.ring import Ring
from rttrr_pin.derivation.symbols import Factors, Role, Symbol, Terms, factors_of


def summed_angles(names: Iterable[str]) -> list[str]:
    """The sums of angles among names of sines and cosines, such as `1_2` of `c_1_2`; shorter ones first."""
    found = {name[2:] for name in names if name[:2] in ("c_", "s_") and all(x.isdigit() for x in name[2:].split("_"))}
    return sorted((angle for angle in found if "_" in angle), key=lambda angle: (angle.count("_"), angle))


def with_sums(angles: Iterable[str]) -> list[str]:
    """The sums, and the shorter sums that they are made of: 1_2_3 needs 1_2."""
    needed: set[str] = set()
    for angle in angles:
        parts = angle.split("_")
        needed |= {"_".join(parts[:k]) for k in range(2, len(parts) + 1)}
    return sorted(needed, key=lambda angle: (angle.count("_"), angle))


def sum_symbols(angles: Iterable[str]) -> list[Symbol]:
    """Sines and cosines of sums of angles."""
    symbols = []
    for angle in angles:
        subscript = angle.replace("_", "") if all(len(x) == 1 for x in angle.split("_")) else angle.replace("_", ",")
        symbols.append(Symbol(f"s_{angle}", f"s_{{{subscript}}}", Role.SINE))
        symbols.append(Symbol(f"c_{angle}", f"c_{{{subscript}}}", Role.COSINE))
    return symbols


def expansions(ring: Ring, angles: Iterable[str]) -> Mapping[str, object]:
    """Each sine and cosine of a sum by those of its angles: c_12 = c_1 c_2 - s_1 s_2."""
    found: dict[str, object] = {}
    for angle in angles:
        sine, cosine = ring.lift(0), ring.lift(1)
        for k in angle.split("_"):
            s, c = ring[f"s_{k}"], ring[f"c_{k}"]
            sine, cosine = sine * c + cosine * s, cosine * c - sine * s
        found |= {f"s_{angle}": ring.reduced(sine), f"c_{angle}": ring.reduced(cosine)}
    return found


def folded(terms: Terms, angles: Iterable[str]) -> Terms:
    """The same sum with c_1 c_2 - s_1 s_2 written c_12, and s_1 c_2 + c_1 s_2 written s_12."""
    result = dict(terms)
    for angle in angles:
        first, last = angle.rsplit("_", 1)
        _fold(result, (f"c_{first}", f"c_{last}"), (f"s_{first}", f"s_{last}"), -1, f"c_{angle}")
        _fold(result, (f"s_{first}", f"c_{last}"), (f"c_{first}", f"s_{last}"), 1, f"s_{angle}")
    return result


def _fold(terms: Terms, one: tuple[str, str], other: tuple[str, str], sign: int, name: str) -> None:
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
    """The product with other letters in place of some; None where they are not all in it."""
    powers = Counter(dict(factors))
    for name in old:
        if not powers[name]:
            return None
        powers[name] -= 1
    powers.update(new)
    return factors_of(powers)


def in_printed_form(derived: Terms, printed: Iterable[PrintedTerm], angles: Iterable[str]) -> Terms:
    """The derived sum with each pair of 1, c^2 and s^2 that the text uses for the same product.

    Args:
        derived: free of squares of sines.
        printed: the terms as printed.
        angles: suffixes of the angles, such as `4` of `c_4`.

    Returns:
        An equal sum, with as many printed terms in it as can be.
    """
    text = Counter({(term.readings[0].coefficient, term.readings[0].factors): 1 for term in printed})
    products = Counter(factors for _, factors in text)
    result = dict(derived)
    for angle in angles:
        sine, cosine = f"s_{angle}", f"c_{angle}"
        if not any((sine, 2) in factors for factors in products):
            continue
        for cofactor, (one, squared) in _by_cofactor(result, cosine).items():
            result = _rewritten(result, cofactor, (one, squared), (sine, cosine), text)
    return result


def _by_cofactor(terms: Terms, cosine: str) -> dict[Factors, tuple[Fraction, Fraction]]:
    """For each product without c^2: its own coefficient, and that of c^2 times it."""
    found: dict[Factors, tuple[Fraction, Fraction]] = {}
    for factors in terms:
        powers = dict(factors)
        if powers.get(cosine, 0) >= 2:
            powers[cosine] -= 2
            cofactor = factors_of(powers)
            found[cofactor] = (terms.get(cofactor, Fraction(0)), terms[factors])
    return found


def _rewritten(
    terms: Terms,
    cofactor: Factors,
    coefficients: tuple[Fraction, Fraction],
    trigonometric: tuple[str, str],
    text: Counter[tuple[Fraction, Factors]],
) -> Terms:
    """The sum with the form of one product that has most in common with the text."""
    one, squared = coefficients
    sine, cosine = trigonometric
    times_sine, times_cosine = (_exchanged(cofactor, (), (name, name)) or () for name in (sine, cosine))
    forms = (
        {cofactor: one, times_cosine: squared},
        {cofactor: one + squared, times_sine: -squared},
        {times_cosine: one + squared, times_sine: one},
    )

    def likeness(form: Terms) -> tuple[int, int, int]:
        there = [(coefficient, factors) for factors, coefficient in form.items() if coefficient]
        printed = {factors for _, factors in text}
        return sum(text[x] for x in there), sum(factors in printed for _, factors in there), -len(there)

    best = max(forms, key=likeness)
    rest = {factors: x for factors, x in terms.items() if factors not in (cofactor, times_cosine, times_sine)}
    return rest | {factors: x for factors, x in best.items() if x}


__all__ = ["expansions", "folded", "in_printed_form", "sum_symbols", "summed_angles", "with_sums"]
