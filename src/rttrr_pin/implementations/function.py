"""A user's own function f(q, v, a) as an implementation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, RefusalError, RttrrError, ShapeError, because, told
from rttrr_pin.implementations.allowance import SINGLE, Precision, default_allowance
from rttrr_pin.implementations.protocol import Batch, Evaluation, shape_of
from rttrr_pin.implementations.text_results import quantities_of, trial_states

TRIED = 3
"""States that are handed over at once to see whether the function takes batches."""


class Function:
    """f(q, v, a) of one state, (nq,), (nv,), (nv,), or of a batch, (N, nq), (N, nv), (N, nv).

    It returns tau, or a dict of tau, F, N, f, n or some of them. Which of the two it takes is found out by calling it:
    if it is given three states and returns three results, the same as one by one (unless it takes no single state), it
    takes batches.

    A function that returns float32 computes in it: the default allowance then has the eps of that.

    Attributes:
        name: the function's own.
        quantities: what it returned when it was tried.
        notes: that it is judged as float32, where it is.
    """

    version = ""

    def __init__(self, function: Callable[..., Any], model: Model, name: str = "") -> None:
        """Try the function on states at rest and in motion.

        Args:
            function: f(q, v, a).
            model: the robot.
            name: what it is called; without it, its own name.

        Raises:
            RefusalError: it raised NotImplementedError.
            ImplementationError: it raised another exception, or returned nothing of use.
            ShapeError: what it returned has not one number for each joint, or three for each link.
        """
        self.name = name or name_of(function)
        self.function = function
        self.model = model
        self.quantities: tuple[str, ...] = ()
        trial = Batch(model, *trial_states(model, TRIED))
        outcomes: list[Mapping[str, Array] | RttrrError] = []
        types = []
        for self.takes_batches in (False, True):
            self.type = np.dtype(np.float64)
            try:
                outcomes.append(self.evaluate(trial).values)
            except RttrrError as error:
                outcomes.append(error)
            types.append(self.type)
        alone, together = outcomes
        if isinstance(together, RttrrError) and isinstance(alone, RttrrError):
            raise alone
        self.takes_batches = not isinstance(together, RttrrError) and (
            isinstance(alone, RttrrError) or _same(together, alone)
        )
        results, self.type = (together if self.takes_batches else alone), types[self.takes_batches]
        assert not isinstance(results, RttrrError)
        self.quantities = tuple(key for key in QUANTITIES if key in results)
        self.notes: tuple[str, ...] = (
            (f"{self.name} is judged as {self.type}, which it returns",) if self.type != np.float64 else ()
        )

    def evaluate(self, batch: Batch) -> Evaluation:
        """What the function returns, state by state or at once."""
        if batch.loads:
            raise RefusalError(
                f"{self.name} takes q, v, a and no payload: pass payload=None, or write an Implementation",
                options={"pass payload=None": "leave --payload out"},
            )
        if self.takes_batches:
            together = self._checked(self._call(batch.first, batch.q, batch.v, batch.a), (len(batch),))
            return Evaluation(together, self._allowance(batch))
        results: list[dict[str, Array]] = []
        for k, state in enumerate(zip(batch.q, batch.v, batch.a, strict=True)):
            results.append(self._checked(self._call(batch.first + k, *state), (), results[0] if results else ()))
        stacked = {key: np.stack([result[key] for result in results]) for key in results[0]}
        return Evaluation(stacked, self._allowance(batch))

    def _allowance(self, batch: Batch) -> dict[str, Array] | None:
        """The default, for numbers of the type that is returned."""
        if self.type == np.float64:
            return None
        return default_allowance(batch, SINGLE if self.type == np.float32 else Precision.of(self.type))

    def _call(self, state: int, q: Array, v: Array, a: Array) -> Any:
        try:
            with np.errstate():  # whatever it sets
                return self.function(q.copy(), v.copy(), a.copy())
        except NotImplementedError as error:
            raise RefusalError(f"{self.name} does not offer this{because(error)}") from error
        except (Exception, SystemExit) as error:  # the user's own code runs here
            raise ImplementationError(f"{self.name} raised {told(error, f' at state {state}')}") from error

    def _checked(self, result: Any, batch: tuple[int, ...], before: Iterable[str] = ()) -> dict[str, Array]:
        """What was returned, as arrays of the right shapes; the quantities are those of the trial, or as before."""
        parts, wanted = quantities_of(result, self.name), self.quantities or tuple(before)
        if wanted and set(parts) != set(wanted):
            raise ImplementationError(
                f"{self.name} returned {', '.join(parts)}, and {', '.join(wanted)} when it was tried: "
                "return the same quantities for each state"
            )
        return {key: self._array(key, x, (*batch, *shape_of(self.model, key))) for key, x in parts.items()}

    def _array(self, key: str, x: Any, wanted: tuple[int, ...]) -> Array:
        try:
            own = np.asarray(x if x is not None else "None")  # NumPy takes None for NaN
            if own.dtype.kind not in "iufO":
                raise TypeError
            array = np.array(own, dtype=np.float64)  # a copy: a function may return the same array each time
        except (TypeError, ValueError):
            kind = x.dtype.name if isinstance(x, np.ndarray) else type(x).__name__
            raise ImplementationError(f"{self.name} returned {key} as {kind}, expected real numbers") from None
        trying = not self.quantities  # later states are judged as it was said
        if trying and own.dtype.kind == "f" and own.dtype.itemsize < self.type.itemsize:
            self.type = own.dtype
        if array.squeeze().shape != tuple(n for n in wanted if n != 1):  # axes of length 1 may be there or not
            raise ShapeError(
                f"{self.name} returned {key} of shape {array.shape}, expected {wanted}",
                name=key,
                got=array.shape,
                wanted=str(wanted),
            )
        return array.reshape(wanted)


def name_of(function: object) -> str:
    """What a function is called."""
    return str(getattr(function, "__name__", type(function).__name__)).replace("<lambda>", "function")


def _same(together: Mapping[str, Array], alone: Mapping[str, Array]) -> bool:
    """Whether states at once and one by one give the same results."""
    return together.keys() == alone.keys() and all(
        np.allclose(x, alone[key], rtol=1e-6, atol=0.0, equal_nan=True) for key, x in together.items()
    )
