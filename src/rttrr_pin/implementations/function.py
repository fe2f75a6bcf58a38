"""A user's own function f(q, v, a) as an implementation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, RttrrError, ShapeError
from rttrr_pin.implementations.protocol import Batch, Evaluation
from rttrr_pin.implementations.text_results import quantities_of, trial_states

TRIED = 3
"""States that are handed over at once to see whether the function takes batches."""


class Function:
    """f(q, v, a) of one state, (nq,), (nv,), (nv,), or of a batch, (N, nq), (N, nv), (N, nv).

    It returns tau, or a dict of tau, F, N, f, n or some of them. Which of the two it takes is found out by calling it:
    if it is given three states and returns three results, the same as one by one (unless it takes no single state), it
    takes batches.

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
        self.quantities: tuple[str, ...] = ()
        q, v, a = trial_states(model, TRIED)
        together = self._tried(lambda: [self._checked(self._call(0, q, v, a), (TRIED,))])
        alone = self._tried(lambda: [self._checked(self._call(k, q[k], v[k], a[k]), ()) for k in range(TRIED)])
        if isinstance(alone, RttrrError) and isinstance(together, RttrrError):
            raise alone
        self.takes_batches = not isinstance(together, RttrrError) and (
            isinstance(alone, RttrrError) or _same(together[0], alone)
        )
        first = together if self.takes_batches else alone
        self.quantities = tuple(key for key in QUANTITIES if key in first[0])  # type: ignore[index]

    def evaluate(self, batch: Batch) -> Evaluation:
        """What the function returns, state by state or at once."""
        if batch.loads:
            raise ImplementationError(
                f"{self.name} takes q, v, a and no payload: pass payload=None, or write an Implementation"
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
        parts = quantities_of(result, self.name)
        if self.quantities and set(parts) != set(self.quantities):
            raise ImplementationError(
                f"{self.name} returned {', '.join(parts)}, and {', '.join(self.quantities)} when it was tried: "
                "return the same quantities for each state"
            )
        return {key: self._array(key, parts[key], batch) for key in parts}

    def _array(self, key: str, x: Any, batch: tuple[int, ...]) -> Array:
        wanted = (*batch, self.model.nv) if key == "tau" else (*batch, len(self.model.links), 3)
        try:
            array = np.asarray(x if x is not None else "None", dtype=np.float64)  # NumPy takes None for NaN
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

    @staticmethod
    def _tried(trial: Callable[[], list[dict[str, Array]]]) -> list[dict[str, Array]] | RttrrError:
        """What a trial yields, or why it fails."""
        try:
            return trial()
        except RttrrError as error:
            return error


def _same(together: dict[str, Array], alone: list[dict[str, Array]]) -> bool:
    """Whether three states at once give the three results."""
    return set(together) == set(alone[0]) and all(
        np.allclose(together[key][k], result[key], rtol=1e-6, atol=0.0, equal_nan=True)
        for key in together
        for k, result in enumerate(alone)
    )
