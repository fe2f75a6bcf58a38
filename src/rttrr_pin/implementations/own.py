"""The two programs of this package: the compiled kernel, and the reference recursion that it is made from."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES, RESULTS
from rttrr_pin.errors import NumberError
from rttrr_pin.implementations.allowance import of_bounds
from rttrr_pin.implementations.protocol import Batch, Evaluation, kernel_of, shape_of
from rttrr_pin.version import __version__


class Recursion:
    """The reference recursion on floats, each operation with its running error bound."""

    name = "recursion"
    version: str = __version__
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        self.model = model

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n as the readable lines compute them."""
        values, bounds = batch.recursion
        return Evaluation(dict(values.items()), of_bounds(bounds), values.tau_joint)


class CompiledKernel:
    """What `Robot.inverse_dynamics` runs; its allowance is its own running error bound.

    The recursion's bound would not do, since sums in another order round otherwise. Robots that are too large to
    compile the kernel's get the default allowance.
    """

    name = "kernel"
    version: str = __version__
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        self.model = model
        self.kernel = kernel_of(model, RESULTS)

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n of the compiled program; what overflows is infinite or no number."""
        result = {name: np.full((len(batch), *shape_of(self.model, name)), np.nan) for name in RESULTS}
        with suppress(NumberError):  # of a number that overflows; the results stand in the arrays all the same
            self.kernel(batch.q, batch.v, batch.a, payload=list(batch.loads) or None, out=result)
        values = {name: result[name] for name in QUANTITIES}
        own = batch.kernel_bounds
        return Evaluation(values, None if own is None else of_bounds(own), result["tau_joint"])
