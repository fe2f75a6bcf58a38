"""The compiled kernel in float32, judged by its own bound."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES, RESULTS
from rttrr_pin.errors import NumberError
from rttrr_pin.implementations.allowance import SINGLE, default_allowance
from rttrr_pin.implementations.protocol import LARGEST, Batch, Evaluation, shape_of
from rttrr_pin.version import __version__


class Kernel32:
    """What `Robot.compile(dtype="float32")` runs.

    Its allowance is its running error bound at the state that it reads, and how far the recursion's results move as the
    state is rounded to float32. Robots that are too large for the bound to be compiled get the default allowance.
    """

    name = "kernel32"
    version: str = __version__
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        self.model = model
        self._bounded = len(model.links) <= LARGEST
        bounds = tuple(f"{name}_bound" for name in QUANTITIES) if self._bounded else ()
        self._kernel: Kernel[dict[str, NDArray[Any]]] = Kernel(model, (*RESULTS, *bounds), dtype="float32")

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n; what overflows is infinite or no number."""
        shapes = {name: shape_of(self.model, name.removesuffix("_bound")) for name in self._kernel.outputs}
        out = {name: np.full((len(batch), *shape), np.nan, np.float32) for name, shape in shapes.items()}
        loads = list(batch.loads)
        with suppress(NumberError):  # of a number that overflows; the results stand in the arrays all the same
            self._kernel(batch.q, batch.v, batch.a, payload=loads or None, out=out)
        results = {name: x.astype(float) for name, x in out.items()}
        if self._bounded:
            allowance = {key: _size(key, results[f"{key}_bound"]) for key in QUANTITIES}
        else:
            allowance = default_allowance(batch, SINGLE)
        moved = _moved(batch)
        total = {key: allowance[key] + moved[key] for key in QUANTITIES}
        return Evaluation({key: results[key] for key in QUANTITIES}, total, results["tau_joint"])


def _moved(batch: Batch) -> dict[str, Array]:
    """How far the true results move as the state is rounded: as those of the recursion do, and rounding of both."""
    loads = tuple(Load(x.link, _read(x.f), _read(x.n), x.in_base) for x in batch.loads)
    read = replace(batch, q=_read(batch.q), v=_read(batch.v), a=_read(batch.a), loads=loads)
    if all(map(np.array_equal, _numbers(batch), _numbers(read))):
        return dict.fromkeys(QUANTITIES, np.zeros(()))
    (values, bounds), (others, other_bounds) = batch.recursion, read.recursion
    return {
        key: _size(key, np.abs(x - getattr(others, key)) + getattr(bounds, key) + getattr(other_bounds, key))
        for key, x in values.items()
    }


def _numbers(batch: Batch) -> list[Array]:
    return [batch.q, batch.v, batch.a, *(x for load in batch.loads for x in (load.f, load.n))]


def _read(x: Array) -> Array:
    """The numbers as float32 holds them."""
    with np.errstate(over="ignore"):
        return x.astype(np.float32).astype(float)


def _size(key: str, x: Array) -> Array:
    """Of each vector its norm; of driving forces each by itself."""
    return x if key == "tau" else norm(x)
