"""The two programs of this package: the compiled kernel, and the reference recursion that it is made from."""

from __future__ import annotations

from importlib import metadata

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import NumberError
from rttrr_pin.implementations.allowance import of_bounds
from rttrr_pin.implementations.bounds import RESULTS, kernel_of
from rttrr_pin.implementations.protocol import Batch, Evaluation


class Recursion:
    """The reference recursion on floats, each operation with its running error bound."""

    name = "recursion"
    version: str = metadata.version("rttrr-pin")
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        self.model = model

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n as the readable lines compute them."""
        values, bounds = batch.recursion
        return Evaluation(dict(values.items()), of_bounds(bounds), values.tau_joint)


class CompiledKernel:
    """What `Robot.inverse_dynamics` runs; its allowance is the running error bound of the same formulas."""

    name = "kernel"
    version: str = metadata.version("rttrr-pin")
    quantities = QUANTITIES

    def __init__(self, model: Model) -> None:
        self.model = model
        self.kernel = kernel_of(model, RESULTS)

    def evaluate(self, batch: Batch) -> Evaluation:
        """tau, F, N, f, n of the compiled program; what overflows is infinite or no number."""
        result = {}
        try:
            result = self.kernel(batch.q, batch.v, batch.a, payload=list(batch.loads) or None)
        except NumberError:  # found by its results, which stand in the arrays all the same
            links, rows = len(self.model.links), len(batch)
            shapes = {name: (rows, self.model.nv) if name.startswith("tau") else (rows, links, 3) for name in RESULTS}
            result = {name: np.empty(shape) for name, shape in shapes.items()}
            for k in range(rows):
                self._one(batch, k, {name: x[k] for name, x in result.items()})
        values = {name: result[name] for name in QUANTITIES}
        return Evaluation(values, of_bounds(batch.bounds), result["tau_joint"])

    def _one(self, batch: Batch, k: int, out: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]) -> None:
        """One state of a batch in which some overflow."""
        loads = [load.block(slice(k, k + 1)) for load in batch.loads]
        try:
            result = self.kernel(batch.q[k : k + 1], batch.v[k : k + 1], batch.a[k : k + 1], payload=loads or None)
        except NumberError:
            for x in out.values():
                x[...] = np.nan
            return
        for name, x in out.items():
            x[...] = result[name][0]
