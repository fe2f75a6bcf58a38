"""A user's own function f(q, v, a) as an implementation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, ShapeError
from rttrr_pin.implementations.protocol import Batch, Evaluation

TRIED = 3
"""States that are handed over at once to see whether the function takes batches."""


class Function:
    """f(q, v, a) of one state, (nq,), (nv,), (nv,), or of a batch, (N, nq), (N, nv), (N, nv).

    It returns tau, or a dict of tau, F, N, f, n or some of them. Which of the two it takes is found out by calling it:
    if it is given three states and returns three results, the same as one by one, it takes batches.

    Attributes:
        name: the function's own.
        version: empty.
        quantities: what it returned when it was tried.
    """

    version = ""

    def __init__(self, function: Callable[..., Any], model: Model) -> None:
        """Try the function on states at rest and in motion.

        Raises:
            ImplementationError: it raised an exception, or returned nothing of use.
            ShapeError: what it returned has not one number for each joint, or three for each link.
        """
        self.name: str = getattr(function, "__name__", type(function).__name__).replace("<lambda>", "function")
        self.function = function
        self.model = model
        q, v, a = _trial_states(model)
        alone = [self._checked(self._call(k, q[k], v[k], a[k]), ()) for k in range(TRIED)]
        self.quantities = tuple(key for key in QUANTITIES if key in alone[0])
        self.takes_batches = self._takes_batches((q, v, a), alone)

    def evaluate(self, batch: Batch) -> Evaluation:
        """What the function returns, state by state or at once."""
        if batch.loads:
            raise ImplementationError(
                f"{self.name} takes q, v, a and no payload: leave the payload out, or write an Implementation"
            )
        if self.takes_batches:
            return Evaluation(self._checked(self._call(batch.first, batch.q, batch.v, batch.a), (len(batch),)))
        rows = zip(batch.q, batch.v, batch.a, strict=True)
        results = [self._checked(self._call(batch.first + k, *row), ()) for k, row in enumerate(rows)]
        return Evaluation({key: np.stack([result[key] for result in results]) for key in self.quantities})

    def _call(self, state: int, q: Array, v: Array, a: Array) -> Any:
        try:
            return self.function(q.copy(), v.copy(), a.copy())
        except Exception as error:  # the user's own code runs here
            raise ImplementationError(f"{self.name} raised {type(error).__name__} at state {state}: {error}") from error

    def _checked(self, result: Any, batch: tuple[int, ...]) -> dict[str, Array]:
        """What was returned, as arrays of the right shapes."""
        parts = dict(result) if isinstance(result, Mapping) else {"tau": result}
        unknown = [key for key in parts if key not in QUANTITIES]
        if unknown or not parts:
            raise ImplementationError(
                f"{self.name} returned {', '.join(map(repr, unknown)) or 'nothing'}: expected tau, or a dict of "
                f"{', '.join(QUANTITIES)}"
            )
        return {key: self._array(key, parts[key], batch) for key in parts}

    def _array(self, key: str, x: Any, batch: tuple[int, ...]) -> Array:
        wanted = (*batch, self.model.nv) if key == "tau" else (*batch, len(self.model.links), 3)
        try:
            array = np.asarray(x, dtype=np.float64)
        except (TypeError, ValueError):
            raise ImplementationError(f"{self.name} returned {key} as {type(x).__name__}, expected numbers") from None
        if (
            array.shape != wanted
            and array.size == np.prod(wanted, dtype=int)
            and array.squeeze().shape == tuple(n for n in wanted if n != 1)
        ):
            array = array.reshape(wanted)
        if array.shape != wanted:
            raise ShapeError(
                f"{self.name} returned {key} of shape {array.shape}, expected {wanted}",
                name=key,
                got=array.shape,
                wanted=str(wanted),
            )
        return array

    def _takes_batches(self, states: tuple[Array, Array, Array], alone: list[dict[str, Array]]) -> bool:
        """Whether three states at once give the three results."""
        try:
            together = self._checked(self._call(0, *states), (TRIED,))
        except (ImplementationError, ShapeError):
            return False
        return set(together) == set(alone[0]) and all(
            np.allclose(together[key][k], alone[k][key], rtol=1e-6, atol=0.0, equal_nan=True)
            for key in together
            for k in range(TRIED)
        )


def _trial_states(model: Model) -> tuple[Array, Array, Array]:
    """Three states that differ in every coordinate; quaternions are those of no rotation."""
    q = np.concatenate(
        [
            np.tile([0.0] * (joint.nq - 1) + [1.0], (TRIED, 1))
            if joint.nq != joint.nv
            else np.linspace(0.1, 0.3, TRIED)[:, None] * np.arange(1, joint.nq + 1)
            for joint in model.moving
        ]
        or [np.zeros((TRIED, 0))],
        axis=1,
    )
    v = np.linspace(0.0, 0.2, TRIED)[:, None] * np.ones(model.nv)
    a = np.linspace(0.3, 0.1, TRIED)[:, None] * np.ones(model.nv)
    return q, v, a
