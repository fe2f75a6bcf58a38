"""The reference recursion from one list of scalars to another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import Arithmetic

LoadFrames = tuple[tuple[int, bool], ...]
"""Of each payload the link, and whether it is expressed in base axes."""


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
