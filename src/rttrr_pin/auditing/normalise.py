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
from rttrr_pin.derivation.symbols import Expression, Factors, Role, Symbol, factors_of, renamed


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
    """Bring a derived component, by its name such as F5z, into the form of the printed one."""
    symbols = with_printed_symbols(derived.symbols, printed.terms)
    form = folded(derived.expressions[name], sums_of_angles(symbols))
    angles = [name.removeprefix("c_") for name, symbol in symbols.items() if symbol.role is Role.COSINE]
    return Normalised(printed, in_printed_form(form, printed.terms, angles), symbols)


def with_printed_symbols(known: Mapping[str, Symbol], terms: Iterable[PrintedTerm]) -> Mapping[str, Symbol]:
    """The symbols with the sums of angles and the unknown symbols of printed terms."""
    names = dict.fromkeys(name for term in terms for x in term.readings for name, _ in x.factors if name not in known)
    symbols = dict(known)
    for angle in sums_of_angles(names):
        subscript = angle.replace("_", "" if all(len(index) == 1 for index in angle.split("_")) else ",")
        for letter, role in (("s", Role.SINE), ("c", Role.COSINE)):
            symbols[f"{letter}_{angle}"] = Symbol(f"{letter}_{angle}", f"{letter}_{{{subscript}}}", role)
    for name in names:
        symbols.setdefault(name, Symbol(name, name, Role.UNKNOWN))
    return symbols


def sums_of_angles(names: Iterable[str]) -> list[str]:
    """The sums of angles among names of sines and cosines, such as `1_2` of `c_1_2`, and those that make them up."""
    needed: set[str] = set()
    for name in names:
        parts = name[2:].split("_")
        if name[:2] in ("c_", "s_") and all(part.isdigit() for part in parts):
            needed |= {"_".join(parts[:k]) for k in range(2, len(parts) + 1)}
    return sorted(needed, key=lambda angle: (angle.count("_"), angle))


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
        sum_factors = _exchanged(factors, one, (name,)) or ()
        coefficient = terms.pop(factors)
        del terms[partner]
        terms[sum_factors] = terms.get(sum_factors, Fraction(0)) + coefficient


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
    text = {term.literal for term in printed}
    products = {factors for _, factors in text}

    def likeness(form: Expression) -> tuple[int, int, int]:
        terms = [(coefficient, factors) for factors, coefficient in form.items() if coefficient]
        return sum(term in text for term in terms), sum(factors in products for _, factors in terms), -len(terms)

    result = dict(derived)
    for angle in angles:
        sine, cosine = f"s_{angle}", f"c_{angle}"
        if not any((sine, 2) in factors for factors in products):
            continue
        before = dict(result)
        for times_cosine, squared in before.items():
            cofactor = _exchanged(times_cosine, (cosine, cosine), ())
            if cofactor is None:
                continue
            # a + b c^2 = (a + b) - b s^2 = (a + b) c^2 + a s^2, each times the cofactor
            one = before.get(cofactor, Fraction(0))
            times_sine = factors_of(Counter(dict(cofactor)) + Counter({sine: 2}))
            forms = (
                {cofactor: one, times_cosine: squared},
                {cofactor: one + squared, times_sine: -squared},
                {times_cosine: one + squared, times_sine: one},
            )
            best = max(forms, key=likeness)
            rest = {x: number for x, number in result.items() if x not in (cofactor, times_cosine, times_sine)}
            result = rest | {x: number for x, number in best.items() if number}
    return result


def add_sums(values: MutableMapping[str, Any], angles: Sequence[str]) -> None:
    """Add sines and cosines of sums of angles, such as `s_1_2`, to those of the angles, in any kind of scalar."""
    for angle in angles:
        first, last = angle.rsplit("_", 1)
        s, c, s_last, c_last = (values[f"{name}_{part}"] for part in (first, last) for name in "sc")
        values[f"s_{angle}"], values[f"c_{angle}"] = s * c_last + c * s_last, c * c_last - s * s_last


def equal(printed: Expression, derived: Expression, symbols: Mapping[str, Symbol], aliases: Mapping[str, str]) -> bool:
    """Whether two sums are equal modulo c^2 + s^2 = 1, sums of angles of the printed one expanded, aliases made one."""
    ring = Ring(symbols.values())
    difference = ring.polynomial(renamed(printed, aliases)) - ring.polynomial(derived)
    values: dict[str, Any] = {name: ring[name] for name in symbols}
    add_sums(values, sums_of_angles(symbols))
    return not len(ring.substituted(difference, values))
