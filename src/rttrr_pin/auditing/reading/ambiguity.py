r"""Where the print leaves open what it says: each way to read the signs and the factors of a product.

The tables of this module are its functions: each takes a list of factors and the place of one of them, and gives the
lists that the print may mean there, the most literal first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import prod

from rttrr_pin.auditing.reading.angles import PI, Angle, angle_in, angle_of, is_number
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Named, Product
from rttrr_pin.auditing.reading.vocabulary import FUNCTIONS, Vocabulary

MOST = 64
"""Readings of one product; more than that are no reading but a riddle."""

CIRCLE = Atom(r"\pi")
"""Pi, where it is no symbol of the text."""

Factors = tuple[Factor, ...]
Ways = list[tuple[Factors, str]]
"""Lists of factors, each with the note that says what was decided."""


def ways(factors: Factors, vocabulary: Vocabulary) -> list[tuple[Iterator[Factor], str]]:
    """Every way to read a product's factors, symbols by their names, the most literal first; with what was decided.

    Raises:
        UnreadableError: there are too many.
    """
    factors = _with_multiples(factors, vocabulary)
    readings: Ways = [(factors, "")]
    for i in range(len(factors)):
        for rule in RULES:
            readings = [
                (changed, joined(note, more))
                for kept, note in readings
                for changed, more in (rule(kept, i, vocabulary) if i < len(kept) else [(kept, "")])
            ]
        if len(readings) > MOST:
            raise too_many_ways(factors[0].start)
    return [(_named(kept, vocabulary), note) for kept, note in readings]


def too_many_ways(start: int) -> UnreadableError:
    """The error for a product of more than `MOST` readings."""
    return UnreadableError(f"this can be read in more than {MOST} ways; set it apart with brackets", start)


def joined(*notes: str) -> str:
    """Notes as one."""
    return "; ".join(note for note in notes if note)


def _power_or_prefix(factors: Factors, i: int, vocabulary: Vocabulary) -> Ways:
    r"""`\dot{q}_1^3 r_{C_{3y}}`: the 3 may be the power of the rate or stand before the r."""
    same: Ways = [(factors, "")]
    factor, following = factors[i], factors[i + 1] if i + 1 < len(factors) else None
    atom = following.atom if following is not None else None
    if following is None or atom is None or following.operator or following.prefix or (factor.exponent or 0) < 1:
        return same
    led = replace(atom, prefix=str(factor.exponent))
    if led not in vocabulary:
        return same
    moved = _put(factors, i, replace(factor, exponent=None), replace(following, prefix=led.prefix))
    power = f"the power {factor.exponent} of {_shown(factor)}"
    prefix = f"{led}, the {factor.exponent} standing before it"
    if isinstance(factor.body, Group):
        return same if atom in vocabulary else [(moved, f"read as {prefix}; printed as {power}")]
    return [(factors, f"read as {power}; it may be {prefix}"), (moved, f"read as {prefix}; it may be {power}")]


def _stray_prefix(factors: Factors, i: int, vocabulary: Vocabulary) -> Ways:
    r"""`c q_5 \cdot {}^4 \dot{q}_4`: a rate has no frame, so the 4 is nothing, or the power of what stands before."""
    factor = factors[i]
    if not factor.prefix or not _cannot_have_one(factors, i, vocabulary):
        return [(factors, "")]
    bare = _put(factors, i, replace(factor, prefix=""))
    ignored = f"the superscript {factor.prefix} before {_shown(bare[i])} ignored"
    j = i - 2 if i > 1 and _takes_argument(factors, i - 2, vocabulary) else i - 1
    before = "".join(_shown(earlier) for earlier in factors[j:i]) if i else ""
    number = factor.prefix.isdecimal() and int(factor.prefix) > 0
    if not i or not number or any(f.exponent is not None or isinstance(f.body, Group) for f in factors[j:i]):
        return [(bare, ignored)]
    power = f"the power {factor.prefix} of {before}"
    raised = _put(bare, j, replace(factors[j], exponent=int(factor.prefix)))
    return [
        (bare, f"{ignored}; it may be {power}"),
        (raised, f"the superscript before {_shown(bare[i])} read as {power}; it may be nothing"),
    ]


def _cannot_have_one(factors: Factors, i: int, vocabulary: Vocabulary) -> bool:
    atom = factors[i].atom
    if atom is None:
        return True
    bare = replace(atom, prefix="")
    if atom in vocabulary:
        return False
    return bare in vocabulary or vocabulary.indexed_angle(bare) is not None or _takes_argument(factors, i, vocabulary)


def _symbol_or_function(factors: Factors, i: int, vocabulary: Vocabulary) -> Ways:
    """`c q_4` where c is a symbol of the text as well."""
    atom = factors[i].atom
    if atom is None or atom not in vocabulary or not _takes_argument(factors, i, vocabulary):
        return [(factors, "")]
    symbol = _put(factors, i, replace(factors[i], symbol=True))
    if isinstance(factors[i + 1].body, Group):
        return [(symbol, "")]
    angle = _shown(factors[i + 1])
    return [
        (symbol, f"{atom} read as a symbol; it may be the function of {angle}"),
        (factors, f"{atom} read as the function of {angle}; it may be a symbol"),
    ]


def _long_index(factors: Factors, i: int, vocabulary: Vocabulary) -> Ways:
    r"""`c_12` is set as c_1 2, and may be meant as `c_{12}`."""
    same: Ways = [(factors, "")]
    factor, following = factors[i], factors[i + 1] if i + 1 < len(factors) else None
    atom = factor.atom
    if following is None or atom is None or following.operator or factor.exponent is not None or following.prefix:
        return same
    digits = following.body
    if not isinstance(digits, Fraction) or digits.denominator != 1 or not atom.subscript.isdecimal():
        return same
    long = replace(atom, subscript=f"{atom.subscript}{digits}")
    if len(atom.subscript) > 1 or (long not in vocabulary and vocabulary.indexed_angle(long) is None):
        return same
    joined_ = (*factors[:i], replace(factor, body=long, exponent=following.exponent), *factors[i + 2 :])
    return [
        (factors, f"{atom} {digits} read as a product, as it is set; it may be {long}"),
        (joined_, f"{atom}{digits} read as {long}; as it is set it is a product"),
    ]


RULES: tuple[Callable[[Factors, int, Vocabulary], Ways], ...] = (
    _symbol_or_function,
    _power_or_prefix,
    _stray_prefix,
    _long_index,
)
"""What may be open at one factor; a new kind of doubt is one more function."""


def _takes_argument(factors: Factors, i: int, vocabulary: Vocabulary) -> bool:
    r"""Whether a factor is a cosine or sine whose angle follows: `c q_4`, `c(q_1 + q_2)`, `\cos q_4`."""
    factor, following = factors[i], factors[i + 1] if i + 1 < len(factors) else None
    atom = factor.body
    if not isinstance(atom, Atom) or factor.symbol or atom != Atom(atom.letters) or atom.letters not in FUNCTIONS:
        return False
    if following is None or following.operator:
        return False
    if isinstance(following.body, Group):
        angle = _angle(following.body, vocabulary) or {}
        return atom.letters.startswith("\\") or any(k > 0 for k in angle)
    return isinstance(following.body, Atom) and vocabulary.coordinate(following.body) is not None


def _with_multiples(factors: Factors, vocabulary: Vocabulary) -> Factors:
    r"""`\cos 2 q_1` as `\cos(2 q_1)`."""
    result: list[Factor] = []
    left = list(factors)
    while left:
        named = isinstance(left[0].body, Atom) and left[0].body.letters in (r"\cos", r"\sin")
        if named and len(left) > 2 and not left[1].operator and not left[2].operator and left[1].exponent is None:
            number, angle = left[1], left[2]
            if _is_number(number, vocabulary) and angle.atom is not None and vocabulary.coordinate(angle.atom):
                inside = Product((), (number, replace(angle, exponent=None)), number.start, angle.start)
                group = Factor(Group((inside,), number.start, angle.start), number.start, angle.exponent)
                result += [left[0], group]
                left = left[3:]
                continue
        result.append(left.pop(0))
    return tuple(result)


def _is_number(factor: Factor, vocabulary: Vocabulary) -> bool:
    """Whether it is a number, or a quotient of numbers."""
    if not isinstance(factor.body, Group):
        return isinstance(factor.body, Fraction)
    return bool(factor.body.divisor) and is_number(_angle(factor.body, vocabulary) or {PI: Fraction(1)})


def _angle(group: Group, vocabulary: Vocabulary) -> Angle | None:
    """The angle that a bracket or a quotient is; None where it is none."""

    def coordinate(factor: Factor) -> int | None:
        atom = factor.atom
        if atom == CIRCLE and atom not in vocabulary:
            return PI
        return None if atom is None else vocabulary.coordinate(atom)

    return angle_in((Product((), (Factor(group, group.start),), group.start, group.end),), coordinate)


def _named(factors: Factors, vocabulary: Vocabulary) -> Iterator[Factor]:
    """The factors with symbols by name; a sine or cosine and its angle are one."""
    positions = iter(range(len(factors)))
    for i in positions:
        factor = factors[i]
        if _takes_argument(factors, i, vocabulary):
            yield _function(factor, factors[next(positions)], vocabulary)
        elif (atom := factor.atom) is not None:
            yield replace(factor, body=_symbol(atom, factor.start, vocabulary))
        else:
            yield factor


def _symbol(atom: Atom, start: int, vocabulary: Vocabulary) -> Named:
    angle = vocabulary.indexed_angle(atom)
    if angle is not None:
        return angle
    if atom.letters.startswith(("\\cos", "\\sin")):
        raise UnreadableError("a sine or cosine is wanted with a coordinate or a sum of coordinates", start)
    return Named(vocabulary.identifier(atom), "" if atom in vocabulary else str(atom))


def _function(function: Factor, argument: Factor, vocabulary: Vocabulary) -> Factor:
    note = ""
    multiples: Angle | None = None
    if isinstance(argument.body, Group):
        multiples = _angle(argument.body, vocabulary)
    elif isinstance(argument.body, Atom) and (index := vocabulary.coordinate(argument.body)) is not None:
        multiples = {index: Fraction(1)}
        if argument.exponent is not None:
            note = f"the power {argument.exponent} behind {argument.body} read as that of its sine or cosine"
    letters = function.body.letters if isinstance(function.body, Atom) else ""
    angle = angle_of(FUNCTIONS[letters], multiples, argument.start)
    if isinstance(angle, Named):
        angle = replace(angle, note=joined(note, angle.note))
    return replace(function, body=angle, exponent=function.power * argument.power)


def signs(lines: Sequence[Sequence[int]]) -> list[tuple[int, str]]:
    """Every way to read the signs before a term, 1 or -1 on each line that has some, the most literal first.

    A sign is repeated where a sum is broken over lines.
    """
    if not lines:
        return [(1, "")]
    values = [prod(line) for line in lines]
    if any(before != after for before, after in pairwise(values)):
        shown = " and ".join("+" if value > 0 else "-" for value in values)
        last = values[-1]
        return [
            (last, f"the signs {shown} around the line break disagree: read as the new line's; it may be the other"),
            (-last, f"the signs {shown} around the line break disagree: read as the old line's; it may be the other"),
        ]
    doubled = [line for line in lines if -prod(line) in line]
    if not doubled:
        return [(values[0], "")]
    shown = " ".join("+" if sign > 0 else "-" for sign in doubled[0])
    return [
        (values[0], f"the signs {shown} read as their product; one may be an error"),
        (-values[0], f"of the signs {shown} one read as an error; it may be their product"),
    ]


def _put(factors: Factors, i: int, *new: Factor) -> Factors:
    return (*factors[:i], *new, *factors[i + len(new) :])


def _shown(factor: Factor) -> str:
    if isinstance(factor.body, Group):
        return "the bracket"
    return str(factor.atom if factor.atom is not None else factor.body)
