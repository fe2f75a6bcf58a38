"""The angle of a sine or cosine: coordinates, their multiples and halves, and quarter turns, which are exact.

The name of an angle is made of parts: 1_1_m2 is 2 q_1 - q_2, 1d2_2 is q_1 / 2 + q_2. Names begin with a positive one.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, MutableMapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Factor, Group, Named, Product

LARGEST_MULTIPLE = 12
"""Of all coordinates in one angle."""

DIVISORS = (2, 4, 8)
"""Of a coordinate: with half an angle that of the whole is a polynomial."""

PI, ONE = 0, -1
"""In an angle, what stands for pi and for 1 among the indices of coordinates, which begin with 1."""

Angle = Mapping[int, Fraction]
"""A sum: what multiplies each coordinate, by its index, and pi; none of it 0."""

PART = re.compile(r"m?\d+(?:d[248])?")
"""What the name of an angle is made of."""

QUARTERS = {
    "s": (("s", 1), ("c", 1), ("s", -1), ("c", -1)),
    "c": (("c", 1), ("s", -1), ("c", -1), ("s", 1)),
}
"""Sine and cosine of an angle and 0, 1, 2, 3 quarter turns: which function of the angle alone, and its sign."""

MOST_DECIMALS = 16
"""Of a number that stands for quarter turns: as many as code prints."""


def angle_of(function: str, angle: Angle | None, start: int) -> Named | Fraction:
    """The cosine ("c") or sine ("s") of an angle that stands at `start`; a number where no coordinate is in it.

    Raises:
        UnreadableError: it is no sum of coordinates, whole multiples and halves of them, and quarter turns.
    """
    angle, note = _with_turns(angle) if angle is not None else ({ONE: Fraction(1)}, "")
    own = {k: x for k, x in sorted(angle.items()) if k > 0}
    turns = 2 * angle.get(PI, Fraction(0))
    divided = all(x.denominator in (1, *DIVISORS) for x in own.values())
    if (
        ONE in angle
        or turns.denominator > 1
        or not divided
        or sum(abs(x.numerator) for x in own.values()) > LARGEST_MULTIPLE
    ):
        message = "the angle is wanted as a coordinate, or a sum or multiple of coordinates, halves and quarter turns"
        raise UnreadableError(message, start)
    turn = -1 if own and next(iter(own.values())) < 0 else 1
    other, sign = QUARTERS[function][int(turns * turn) % 4]
    sign *= turn if function == "s" else 1
    parts = [part for k, x in own.items() for part in [_part(k, x * turn)] * abs(x.numerator)]
    if not parts:
        return Fraction(sign if other == "c" else 0)
    return Named("_".join([other, *parts]), note=note, sign=sign)


def _part(k: int, multiple: Fraction) -> str:
    return f"{'m' if multiple < 0 else ''}{k}{f'd{multiple.denominator}' if multiple.denominator > 1 else ''}"


def _with_turns(angle: Angle) -> tuple[Angle, str]:
    """An angle in which a number such as 1.5708 is pi/2, with a note: it is pi/2 rounded to the digits that it has."""
    number = angle.get(ONE, Fraction(0))
    decimals = next((n for n in range(2, MOST_DECIMALS + 1) if (number * 10**n).denominator == 1), None)
    quarters = round(number / Fraction(math.pi) * 2)
    if not number or decimals is None or not quarters:
        return angle, ""
    off = abs(number - quarters * Fraction(math.pi) / 2)
    if off > Fraction(1, 2 * 10**decimals) + Fraction(abs(quarters), 10**MOST_DECIMALS):
        return angle, ""
    turned = {k: x for k, x in angle.items() if k != ONE} | {PI: angle.get(PI, Fraction(0)) + Fraction(quarters, 2)}
    return turned, f"the number {float(number):.17g} read as {Fraction(quarters, 2)} pi"


def angle_in(products: Sequence[Product], coordinate: Callable[[Factor], int | None]) -> Angle | None:
    """The angle that a sum is; None where it is none. `coordinate` gives the index of a factor that is one, or `PI`."""
    total: Counter[int] = Counter()
    for product in products:
        form: Angle = {ONE: Fraction(prod(product.signs[-1]) if product.signs else 1)}
        for factor in product.factors:
            own = _of_factor(factor, coordinate)
            if own is None:
                return None
            if factor.operator == "/":
                own = _inverse(own)
            if own is None or not (is_number(own) or is_number(form)):
                return None
            form = _times(form, own[ONE]) if is_number(own) and own else _times(own, form.get(ONE, Fraction(0)))
        for k, x in form.items():
            total[k] += x  # type: ignore[assignment]
    return {k: Fraction(x) for k, x in total.items() if x}


def is_number(angle: Angle) -> bool:
    """Whether neither a coordinate nor pi is in it."""
    return angle.keys() <= {ONE}


def _of_factor(factor: Factor, coordinate: Callable[[Factor], int | None]) -> Angle | None:
    if factor.power != 1:
        return None
    if isinstance(factor.body, Fraction):
        return {ONE: factor.body}
    if not isinstance(factor.body, Group):
        index = coordinate(factor)
        return None if index is None else {index: Fraction(1)}
    above = angle_in(factor.body.products, coordinate)
    below = _inverse(angle_in(factor.body.divisor, coordinate)) if factor.body.divisor else {ONE: Fraction(1)}
    return None if above is None or below is None else _times(above, below[ONE])


def _inverse(angle: Angle | None) -> Angle | None:
    return {ONE: 1 / angle[ONE]} if angle and is_number(angle) and angle[ONE] else None


def _times(angle: Angle, number: Fraction) -> Angle:
    return {k: x * number for k, x in angle.items()}


def coordinate_of(part: str) -> str:
    """The index of the coordinate that a part of an angle is of."""
    return part.removeprefix("m").partition("d")[0]


def multiple_of(part: str) -> Fraction:
    """What multiplies it: -1/2 for m1d2."""
    return Fraction(-1 if part.startswith("m") else 1, int(part.partition("d")[2] or 1))


def is_angle(name: str) -> bool:
    """Whether a name is that of a sine or cosine of coordinates."""
    function, *parts = name.split("_")
    return function in QUARTERS and bool(parts) and all(map(PART.fullmatch, parts))


def doubled(angle: str) -> str:
    """Twice an angle of halves, by its name; empty where it has other parts."""
    parts = [part.partition("d") for part in angle.split("_")]
    if not all(d for _, _, d in parts):
        return ""
    return "_".join(k if d == "2" else f"{k}d{int(d) // 2}" for k, _, d in parts)


def doubles(angles: Iterable[str]) -> list[str]:
    """Twice, four times, ... the angles of halves."""
    found, left = list[str](), list(angles)
    while left:
        if (twice := doubled(left.pop())) and twice not in found:
            found.append(twice)
            left.append(twice)
    return found


def add_doubles(values: MutableMapping[str, Any]) -> None:
    """Put the sine and cosine of each coordinate and of its parts in terms of its finest part, any kind of scalar."""
    finest: dict[str, int] = {}
    for name in values:
        k, _, divisor = name[2:].partition("d")
        if divisor and is_angle(name) and "_" not in name[2:]:
            finest[k] = max(finest.get(k, 1), int(divisor))
    for k, d in finest.items():
        s, c = values[f"s_{k}d{d}"], values[f"c_{k}d{d}"]
        while d > 1:
            d //= 2
            s, c = 2 * s * c, c * c - s * s
            part = f"{k}d{d}" if d > 1 else k
            values[f"s_{part}"], values[f"c_{part}"] = s, c
