"""Numbers as a file writes them: the text, the exact rational behind it, and how far rounding can have moved it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property

from rttrr_pin.errors import shortened

NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
"""A decimal number as XML Schema writes it, in ASCII; no unit, comma, hexadecimal digits, `nan` or `inf`."""

LONGEST = 2000
"""Characters of a number; exact arithmetic takes time with their square."""

FINEST = -400
"""Power of ten below which a zero is just zero: 0e-999999999 is a valid text, and 10**999999999 fits nowhere."""


def beyond_doubles(word: str) -> str:
    """What is wrong with a decimal number that no double stands for; empty where one does."""
    if len(word) > LONGEST:
        return f"{shortened(word)} has more than {LONGEST:,} characters, and the longest float64 has 1,077: round it"
    value = float(word)
    if not math.isfinite(value):
        return f"{shortened(word)} is larger than float64 can hold: check the exponent"
    if value == 0.0 and re.search(r"[1-9]", re.split("[eE]", word)[0]):
        return f"{shortened(word)} is smaller than float64 can hold: write 0, or check the exponent"
    return ""


@dataclass(frozen=True)
class Number:
    """A decimal number of a file, converted when it is asked for.

    Attributes:
        text: the characters in the file, blanks around them included.
    """

    text: str

    def __float__(self) -> float:
        return float(self.text)

    @cached_property
    def exact(self) -> Fraction:
        """The number that the digits denote, with no rounding."""
        decimal, exponent = self._parts
        return Fraction(decimal) if decimal or FINEST <= exponent < 0 else Fraction(0)

    @cached_property
    def half(self) -> Fraction:
        """Half a unit of the last digit written; a longer number that was rounded to this text lies no farther away.

        0 for a zero without a point, which is taken as meant.
        """
        decimal, exponent = self._parts
        return Fraction(10) ** exponent / 2 if decimal or FINEST <= exponent < 0 else Fraction(0)

    @property
    def _parts(self) -> tuple[Decimal, int]:
        decimal = Decimal(self.text.strip())
        return decimal, int(decimal.as_tuple().exponent)


@dataclass(frozen=True)
class NumberList:
    """Several numbers in one attribute, such as `xyz`.

    Attributes:
        text: the attribute as it stands.
    """

    text: str

    @cached_property
    def each(self) -> tuple[Number, ...]:
        """The numbers one by one."""
        return tuple(map(Number, self.text.split()))

    @cached_property
    def floats(self) -> tuple[float, ...]:
        """The double nearest to each."""
        return tuple(map(float, self.each))


def text_of(value: Fraction) -> str:
    """All digits of a fraction whose denominator divides a power of ten."""
    places = 0
    while (value * 10**places).denominator != 1:
        places += 1
    digits = tuple(int(digit) for digit in str(abs((value * 10**places).numerator)))
    return str(Decimal((int(value < 0), digits, -places)))
