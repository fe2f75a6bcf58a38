"""The reference recursion's rounding bound, compiled where that is cheap: the same for a state alone and in a batch."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES, LinkWrenches
from rttrr_pin.errors import NumberError

RESULTS = (*QUANTITIES, "tau_joint")

LARGEST = 16
"""Links up to which a program with bounds compiles in two seconds or less; it is kept on disk from then on."""


@lru_cache(maxsize=8)
def kernel_of(model: Model, outputs: tuple[str, ...]) -> Kernel[dict[str, Array]]:
    """The last few compiled programs."""
    return Kernel(model, outputs)


def compiled_bounds(model: Model, q: Array, v: Array, a: Array, loads: Sequence[Load] = ()) -> LinkWrenches | None:
    """A running error bound on each number; None for robots that are too large, or where a number overflows."""
    if len(model.links) > LARGEST or not len(q):
        return None
    names = tuple(f"{name}_bound" for name in RESULTS)
    try:
        bounds = kernel_of(model, names)(q, v, a, payload=list(loads) or None)
    except NumberError:  # the numbers that overflow are shown state by state
        return None
    parts = {name: bounds[f"{name}_bound"] for name in RESULTS}
    return LinkWrenches.of(parts, model.link_names, model.v_names)
