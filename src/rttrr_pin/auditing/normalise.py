"""Stage 3: derived sum -> the same sum in the form that the text chose: c^2 or s^2, and c_12 for sums of angles."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm
from rttrr_pin.auditing.reading.angles import add_doubles, doubled, doubles, is_angle, multiple_of
from rttrr_pin.derivation.ring import Polynomial, Ring
from rttrr_pin.derivation.symbols import Expression, Factors, Role, Symbol, factors_of, renamed

HALF = Fraction(1, 2)


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
    products = {factors for term in printed.terms for factors in (term.literal[1],)}
    sums = sums_of_angles(symbols)
    form = folded(derived.expressions[name], sums, products)
    halves = [angle for angle in of_angles(symbols) if doubled(angle)]
    if halves:
        form = folded(halved(form, halves, products), sums, products)
    angles = [name.removeprefix("c_") for name, symbol in symbols.items() if symbol.role is Role.COSINE]
    return Normalised(printed, in_printed_form(form, printed.terms, angles), symbols)


def with_printed_symbols(known: Mapping[str, Symbol], terms: Iterable[PrintedTerm]) -> Mapping[str, Symbol]:
    """The symbols with the sums of angles and the unknown symbols of printed terms."""
    return with_names(known, (name for term in terms for x in term.readings for name, _ in x.factors))


def with_names(known: Mapping[str, Symbol], used: Iterable[str]) -> Mapping[str, Symbol]:
    """The symbols with those of other names: sums of angles, and unknown ones."""
    names = dict.fromkeys(name for name in used if name not in known)
    symbols = dict(known)
    own = of_angles(names)
    own += doubles(own)
    sums = sums_of_angles(f"c_{angle}" for angle in own)
    divided = (angle for angle in own if "d" in angle)
    parts = {part.removeprefix("m") for angle in (*sums, *divided) for part in angle.split("_")}  # or lengths
    for angle in [*sorted(part for part in parts if f"c_{part}" not in known), *sums]:
        subscript = _subscript(angle.split("_"))
        for letter, role in (("s", Role.SINE), ("c", Role.COSINE)):
            symbols[f"{letter}_{angle}"] = Symbol(f"{letter}_{angle}", f"{letter}_{{{subscript}}}", role)
    for name in names:
        symbols.setdefault(name, Symbol(name, name, Role.UNKNOWN))
    return symbols


def _subscript(parts: Sequence[str]) -> str:
    """An angle as the index of c or s: 12, {1,12}, 1-2, 1+1."""
    if any(part.startswith("m") or "d" in part for part in parts) or len(set(parts)) < len(parts):
        return "+".join(parts).replace("+m", "-").replace("d", "/")
    return ("" if all(len(index) == 1 for index in parts) else ",").join(parts)


def of_angles(names: Iterable[str]) -> list[str]:
    """The angles among names of sines and cosines, such as `1_2` of `c_1_2`, each once."""
    return list(dict.fromkeys(name[2:] for name in names if is_angle(name)))


def sums_of_angles(names: Iterable[str]) -> list[str]:
    """The sums of angles among names of sines and cosines, such as `1_2` of `c_1_2`, and those that make them up."""
    needed: set[str] = set()
    for angle in of_angles(names):
        parts = angle.split("_")
        needed |= {"_".join(parts[:k]) for k in range(2, len(parts) + 1)}
    return sorted(needed, key=lambda angle: (angle.count("_"), angle))


def folded(terms: Expression, angles: Iterable[str], printed: Collection[Factors] = ()) -> Expression:
    """The same sum with c_1 c_2 - s_1 s_2 written c_12, and s_1 c_2 + c_1 s_2 written s_12, where it can be.

    A product of two is written as half a sum, as c_1^2 = (1 + c_11) / 2, where `printed` has all that it takes.
    """
    result = dict(terms)
    for angle in angles:
        first, last, sign = _last(angle)
        if first == last and sign > 0:
            _rewrite(result, (f"c_{first}", f"c_{first}"), {(): HALF, (f"c_{angle}",): HALF}, printed)
        if sign < 0:
            s, c, s_minus, c_minus = f"s_{first}_{last}", f"c_{first}_{last}", f"s_{angle}", f"c_{angle}"
            _rewrite(result, (f"s_{first}", f"c_{last}"), {(s,): HALF, (s_minus,): HALF}, printed)
            _rewrite(result, (f"c_{first}", f"s_{last}"), {(s,): HALF, (s_minus,): -HALF}, printed)
            _rewrite(result, (f"c_{first}", f"c_{last}"), {(c,): HALF, (c_minus,): HALF}, printed)
            _rewrite(result, (f"s_{first}", f"s_{last}"), {(c,): -HALF, (c_minus,): HALF}, printed)
        _fold(result, (f"c_{first}", f"c_{last}"), (f"s_{first}", f"s_{last}"), -sign, f"c_{angle}")
        _fold(result, (f"s_{first}", f"c_{last}"), (f"c_{first}", f"s_{last}"), sign, f"s_{angle}")
    return result


def halved(terms: Expression, angles: Iterable[str], printed: Collection[Factors]) -> Expression:
    """The same sum with c = 2 c_h^2 - 1 and s = 2 s_h c_h, h of half the angle, in products that are not printed."""
    result = dict(terms)
    for angle in sorted(angles, key=lambda angle: min(abs(multiple_of(x)) for x in angle.split("_")), reverse=True):
        s, c, whole = f"s_{angle}", f"c_{angle}", doubled(angle)
        for name, new in (
            (f"c_{whole}", {(c, c): Fraction(2), (): Fraction(-1)}),
            (f"s_{whole}", {(s, c): Fraction(2)}),
        ):
            while old := [f for f in result if f not in printed and name in dict(f)]:
                for factors in old:
                    coefficient = result.pop(factors)
                    for names, x in new.items():
                        product = _exchanged(factors, (name,), names) or ()
                        result[product] = result.get(product, Fraction(0)) + coefficient * x
                result = {f: x for f, x in result.items() if x}
    return result


def _last(angle: str) -> tuple[str, str, int]:
    """What an angle is the sum of: all but the last part, the last part, and its sign."""
    first, last = angle.rsplit("_", 1)
    return first, last.removeprefix("m"), -1 if last.startswith("m") else 1


def _rewrite(
    terms: Expression, old: Sequence[str], new: Mapping[tuple[str, ...], Fraction], printed: Collection[Factors]
) -> None:
    """Two factors as a sum of other products, wherever all these, with what else there is, are printed."""
    for factors in list(terms):
        cofactor = _exchanged(factors, old, ())
        if cofactor is None:
            continue
        products = {factors_of(Counter(dict(cofactor)) + Counter(names)): x for names, x in new.items()}
        if all(product in printed for product in products if product != cofactor):
            coefficient = terms.pop(factors)
            for product, x in products.items():
                total = terms.pop(product, Fraction(0)) + coefficient * x
                if total:
                    terms[product] = total


def _fold(terms: Expression, one: tuple[str, str], other: tuple[str, str], sign: int, name: str) -> None:
    """One x y + sign z w = name, wherever both products are there with coefficients that fit."""
    for factors in list(terms):
        partner = _exchanged(factors, one, other)
        if factors not in terms or partner is None or terms.get(partner) != sign * terms[factors]:
            continue
        sum_factors = _exchanged(factors, one, (name,)) or ()
        coefficient = terms.pop(factors)
        if partner == factors:  # s c + c s
            coefficient /= 2
        else:
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
        first, last, sign = _last(angle)
        s, c, s_last, c_last = (values[f"{name}_{part}"] for part in (first, last) for name in "sc")
        s_last = s_last * sign
        values[f"s_{angle}"], values[f"c_{angle}"] = s * c_last + c * s_last, c * c_last - s * s_last


def equal(printed: Expression, derived: Expression, symbols: Mapping[str, Symbol], aliases: Mapping[str, str]) -> bool:
    """Whether two sums are equal modulo c^2 + s^2 = 1, sums of angles of the printed one expanded, aliases made one."""
    ring = Ring(symbols.values())
    difference = ring.polynomial(renamed(printed, aliases)) - ring.polynomial(derived)
    return not len(with_expanded_angles(ring, difference))


def with_expanded_angles(ring: Ring, x: Polynomial) -> Polynomial:
    """A polynomial without sines and cosines of sums of angles, reduced."""
    values: dict[str, Any] = {name: ring[name] for name in ring.symbols}
    add_doubles(values)
    add_sums(values, sums_of_angles(ring.symbols))
    return ring.substituted(x, values)
