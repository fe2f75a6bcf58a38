"""Components in which symbols divide, and accelerations solved for: compared as quotients of two sums.

Two quotients are equal where cross-multiplying makes them so. Where they are not, both are brought to one denominator,
or numerator, if one divides the other, and numerators and denominators are paired term by term.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from rttrr_pin.auditing.classify import findings
from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.match import Matching, match_best
from rttrr_pin.auditing.normalise import with_expanded_angles, with_names
from rttrr_pin.auditing.printed import ONE, PrintedComponent, PrintedTerm, Quotient, Reading
from rttrr_pin.auditing.results import Finding
from rttrr_pin.auditing.spelling import Writing
from rttrr_pin.derivation.ring import Polynomial, Ring
from rttrr_pin.derivation.symbols import Expression, Symbol, expression_of, renamed

MOST_TERMS = 500
"""Of a numerator or denominator whose terms are paired."""

Pair = tuple[Polynomial, Polynomial]
"""Numerator and denominator."""


@dataclass(frozen=True)
class Comparison:
    """A printed quotient beside the derived one that it is nearest to.

    Attributes:
        printed, derived: in one form, brought to what they have in common.
        right: whether the printed one is right.
        symbols: of both, by name.
        aliases: symbols that are equal to another.
    """

    printed: Quotient
    derived: Quotient
    right: bool
    symbols: Mapping[str, Symbol]
    aliases: Mapping[str, str]

    def findings(self, name: str, write: Writing) -> tuple[Finding, ...]:
        """The errors, numerator first."""
        errors: list[Finding] = []
        for where in ("numerator", "denominator"):
            printed, derived = getattr(self.printed, where), getattr(self.derived, where)
            matching = _paired(printed, derived, self.symbols, self.aliases, write)
            note = f"in the {where}, brackets multiplied out"
            errors += [
                replace(x, note="; ".join(filter(None, (note, x.note)))) for x in findings(matching, name, write)
            ]
        return tuple(replace(x, id=f"{name}.{k}") for k, x in enumerate(errors, start=1))


def as_quotient(component: PrintedComponent) -> Quotient:
    """What is printed, by its most literal readings."""
    if component.quotient is not None:
        return component.quotient
    unknown = dict.fromkeys(spelling for term in component.terms for spelling in term.readings[0].unknown)
    return Quotient(expression_of(term.literal for term in component.terms), unknown=tuple(unknown))


def compare(printed: Quotient, name: str, derived: Derived, aliases: Mapping[str, str]) -> Comparison:
    """A printed quotient, and what is derived for a component by its name, such as tau2 or a2."""
    candidates = derived.solutions.get(name) or [Quotient(derived.expressions[name])]
    symbols = with_names(derived.symbols, printed.names)
    ring = Ring(symbols.values())
    sides = _expanded(ring, Quotient(renamed(printed.numerator, aliases), renamed(printed.denominator, aliases)))
    right = [_expanded(ring, x) for x in candidates]
    equal = [pair for pair in right if _equal(ring, sides, pair)]
    if not equal and name in derived.solutions and _equal(ring, _solved(ring, sides, name, derived), right[0]):
        equal = right[:1]
    ways = [way for pair in equal or right for way in _in_common(ring, sides, pair)]
    best = min(ways, key=lambda way: _unlike(ring, *way))
    shown = [Quotient(ring.terms(n), ring.terms(d)) for n, d in best]
    return Comparison(shown[0], shown[1], bool(equal), symbols, aliases)


def _expanded(ring: Ring, x: Quotient) -> Pair:
    """Numerator and denominator without sines and cosines of sums, nor of angles that have halves."""
    return tuple(with_expanded_angles(ring, ring.polynomial(side)) for side in (x.numerator, x.denominator))  # type: ignore[return-value]


def _equal(ring: Ring, one: Pair, other: Pair) -> bool:
    return bool(one[1]) and not len(ring.reduced(one[0] * other[1] - other[0] * one[1]))


def _solved(ring: Ring, sides: Pair, name: str, derived: Derived) -> Pair:
    """A quotient with the other accelerations put in, where all equations could be solved together."""
    for other, solutions in derived.solutions.items():
        acceleration = f"a_{other[1:]}"
        if other == name or any(f.startswith("a_") for f in solutions[0].names):
            continue
        n, d = _expanded(ring, solutions[0])
        powers = [_by_power(ring, side, acceleration) for side in sides]
        degree = max((power for side in powers for power in side), default=0)
        sides = tuple(  # type: ignore[assignment]
            ring.reduced(sum((x * n**k * d ** (degree - k) for k, x in side.items()), start=ring.lift(0)))
            for side in powers
        )
    return sides


def _by_power(ring: Ring, x: Polynomial, name: str) -> dict[int, Polynomial]:
    """A polynomial's coefficients as one in a single symbol."""
    parts: dict[int, Expression] = {}
    for factors, coefficient in ring.terms(x).items():
        power = dict(factors).get(name, 0)
        parts.setdefault(power, {})[tuple(f for f in factors if f[0] != name)] = coefficient
    return {power: ring.polynomial(part) for power, part in parts.items()}


def _in_common(ring: Ring, printed: Pair, derived: Pair) -> Iterator[tuple[Pair, Pair]]:
    """Both as they are, and multiplied so that denominators, or numerators, are the same."""
    yield printed, derived
    for k in (1, 0):
        if not printed[k] or not derived[k]:
            continue
        factor, rest = divmod(derived[k], printed[k])
        if not rest:
            yield (ring.reduced(printed[0] * factor), ring.reduced(printed[1] * factor)), derived
        factor, rest = divmod(printed[k], derived[k])
        if not rest:
            yield printed, (ring.reduced(derived[0] * factor), ring.reduced(derived[1] * factor))


def _unlike(ring: Ring, printed: Pair, derived: Pair) -> tuple[int, int]:
    """How many terms differ, and how many there are."""
    sides = [(ring.terms(x), ring.terms(y)) for x, y in zip(printed, derived, strict=True)]
    differ = sum(len(set(x.items()) ^ set(y.items())) for x, y in sides)
    return differ, sum(len(x) + len(y) for x, y in sides)


def _paired(
    printed: Expression, derived: Expression, symbols: Mapping[str, Symbol], aliases: Mapping[str, str], write: Writing
) -> Matching:
    if max(len(printed), len(derived)) > MOST_TERMS:
        same = {factors for factors, x in printed.items() if derived.get(factors) == x}
        printed, derived = ({f: x for f, x in side.items() if f not in same} for side in (printed, derived))
        printed, derived = dict(list(printed.items())[:MOST_TERMS]), dict(list(derived.items())[:MOST_TERMS])
    terms = tuple(PrintedTerm(write([(x, f)])[0], (Reading(x, f),)) for f, x in printed.items())
    return match_best(PrintedComponent("", terms), "", [Derived(symbols, {"": derived})], aliases)


def written(quotient: Quotient, write: Writing, latex: bool) -> str:
    """A quotient as text."""
    above, below = (
        " ".join(write([(x, factors) for factors, x in side.items()]))
        for side in (quotient.numerator, quotient.denominator)
    )
    if quotient.denominator == ONE:
        return above
    return rf"\frac{{{above}}}{{{below}}}" if latex else f"({above})/({below})"
