"""Interval arithmetic by python-flint's `arb`, whose intervals are a midpoint and a radius (a ball).

Every operation encloses the exact result, so a result of the recursion encloses the true value. That is a proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq

from rttrr_pin.core.scalars import Arithmetic


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Compute intervals with midpoints of so many bits."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def interval(value: float | Fraction) -> arb:
    """The interval of a float or a fraction: exact, or rounded outwards to the precision in force."""
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    return arb(float(value))


def _sincos(x: Any) -> tuple[arb, arb]:
    sine, cosine = arb(x).sin_cos()
    return sine, cosine


def _sign(x: Any) -> arb:
    return arb(x).sgn()


INTERVAL = Arithmetic(
    number=lambda value, error: interval(value), column=lambda x: interval(float(x)), sincos=_sincos, sign=_sign
)
"""Intervals as scalars; the model's numbers are the doubles that it holds."""
