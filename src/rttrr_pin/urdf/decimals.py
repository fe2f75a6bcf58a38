"""Numbers as a file writes them: the exact rational behind a decimal text, and how far rounding can have moved it."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

FINEST = -400
"""Power of ten below which a zero is just zero: 0e-999999999 is a valid text, and 10**999999999 fits nowhere."""


@dataclass(frozen=True, slots=True)
class Number:
    """A decimal number of a file.

    Attributes:
        text: the characters in the file.
        exact: the number they denote, with no rounding.
        half: half a unit of the last digit written; a longer number that was rounded to this text lies no farther
            away. 0 for a zero without a point, which is taken as meant.
    """

    text: str
    exact: Fraction
    half: Fraction

    @classmethod
    def of(cls, text: str) -> Number:
        """Read a decimal number.

        Args:
            text: digits that the strict reader has let pass.
        """
        written = Decimal(text.strip())
        exponent = int(written.as_tuple().exponent)
        if not written and not FINEST <= exponent < 0:
            return cls(text, Fraction(0), Fraction(0))
        return cls(text, Fraction(written), Fraction(10) ** exponent / 2)

    def __float__(self) -> float:
        return float(self.exact)


def text_of(value: Fraction) -> str:
    """All digits of a fraction whose denominator divides a power of ten."""
    places = 0
    while (value * 10**places).denominator != 1:
        places += 1
    digits = tuple(int(digit) for digit in str(abs((value * 10**places).numerator)))
    return str(Decimal((int(value < 0), digits, -places)))
