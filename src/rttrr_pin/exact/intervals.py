"""Interval arithmetic by python-flint's `arb`, whose intervals are a midpoint and a radius (a ball).

Every operation encloses the exact result, so a result of the recursion encloses the true value. That is a proof.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from fractions import Fraction
from itertools import islice
from typing import Any

from flint import arb, ctx, fmpq

from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import Arithmetic


def precision(bits: int) -> AbstractContextManager[None]:
    """Compute intervals with midpoints of so many bits."""
    return ctx.workprec(bits)


def interval(value: float | Fraction) -> arb:
    """The interval of a float or a fraction: exact, or rounded outwards to the precision in force."""
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    return arb(float(value))


INTERVAL = Arithmetic(
    number=lambda value, error: interval(value),
    column=lambda x: interval(float(x)),
    sincos=lambda x: arb(x).sin_cos(),
    sign=lambda x: arb(x).sgn(),
)
"""Intervals as scalars; the model's numbers are the doubles that it holds."""

LoadFrames = tuple[tuple[int, bool], ...]
"""Of each payload the link, and whether it is expressed in base axes."""

Run = Callable[[Sequence[float]], list[arb]]
"""Evaluates a state: from q, v, a, then f and n of each payload, to intervals of all results."""


def flat_dynamics(
    model: Model, arithmetic: Arithmetic, inputs: Sequence[Scalar], frames: LoadFrames, links: Sequence[Body]
) -> list[Any]:
    """From q, v, a, then f and n of each payload, to tau, then F, N, f, n link by link, of one state."""
    values = iter(inputs)
    q, v, a = (list(islice(values, size)) for size in (model.nq, model.nv, model.nv))
    payloads = [
        Payload(link, Vector(*islice(values, 3)), Vector(*islice(values, 3)), in_base) for link, in_base in frames
    ]
    return dynamics(model, arithmetic, q, v, a, payloads, links=links).scalars()
