"""The specification from one list of scalars to another."""

from __future__ import annotations

from collections.abc import Sequence

from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.core.wrench import LINK_QUANTITIES

Slots = tuple[tuple[int, bool], ...]
"""Of each payload the link, and whether it is given in base axes."""


def results_of(
    model: Model, arithmetic: Arithmetic, inputs: Sequence[Scalar], slots: Slots, links: Sequence[Body]
) -> list[Scalar]:
    """tau, then F, N, f, n link by link, of one state: q, v, a, then f and n of each payload."""
    at, given = 0, []
    for size in (model.nq, model.nv, model.nv, *(3 for _ in slots for _ in "fn")):
        given.append(inputs[at : at + size])
        at += size
    q, v, a, *loads = given
    payloads = [
        Payload(link, Vector(*f), Vector(*n), in_base)
        for (link, in_base), f, n in zip(slots, loads[::2], loads[1::2], strict=True)
    ]
    result = dynamics(model, arithmetic, q, v, a, payloads, links=links)
    return [*result.tau, *(x for key in LINK_QUANTITIES for vector in getattr(result, key) for x in vector)]
