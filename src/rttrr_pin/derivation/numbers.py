"""Numbers as texts of equations and expressions write them: exact, and no longer than a quantity can be."""

from __future__ import annotations

from decimal import Decimal, InvalidOperation
from fractions import Fraction

LARGEST_EXPONENT = 400
"""10^400 is past every quantity."""

MOST_DIGITS = 40
"""Of one number in a text."""

MOST_BITS = 8192
"""Of a numerator or denominator that numbers are multiplied to; Python prints no more than 4,300 digits."""


def exact_number(text: str) -> Fraction:
    """The number that a decimal text denotes: 0.1 is a tenth.

    Raises:
        ValueError: it is no decimal number, or none that can be meant.
    """
    try:
        number = Decimal(text)
    except InvalidOperation as error:
        raise ValueError(f"{text!r} is no number") from error
    if not number.is_finite() or len(number.as_tuple().digits) > MOST_DIGITS:
        raise ValueError(f"a number of more than {MOST_DIGITS} digits")
    if abs(number.adjusted()) > LARGEST_EXPONENT:
        raise ValueError(f"a number past 10^{LARGEST_EXPONENT}")
    return Fraction(number)


def fits(number: Fraction) -> bool:
    """Whether a product or sum of numbers is short enough to go on with."""
    return max(number.numerator.bit_length(), number.denominator.bit_length()) <= MOST_BITS
