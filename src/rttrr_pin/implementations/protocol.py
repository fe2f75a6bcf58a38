"""What computes inverse dynamics, whoever wrote it: states in, values and their rounding out."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Protocol, runtime_checkable

import numpy as np

from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LINK_QUANTITIES, RESULTS, LinkWrenches
from rttrr_pin.errors import ImplementationError, NumberError, RefusalError, RttrrError, because, told

LARGEST = 64
"""Links up to which a program with bounds compiles in some seconds; it is kept on disk from then on."""


@lru_cache(maxsize=8)
def kernel_of(model: Model, outputs: tuple[str, ...]) -> Kernel[dict[str, Array]]:
    """The last few compiled programs."""
    return Kernel(model, outputs)


@dataclass(frozen=True, eq=False)
class Batch:
    """States of one robot.

    Attributes:
        model: the robot.
        q: coordinates, (N, nq) [rad or m].
        v: rates, (N, nv).
        a: accelerations, (N, nv).
        loads: payloads.
        first: index of the first state, for messages.
        compiled: whether bounds are to be compiled, since the kernel takes part.
    """

    model: Model
    q: Array
    v: Array
    a: Array
    loads: tuple[Load, ...] = ()
    first: int = 0
    compiled: bool = False

    def __len__(self) -> int:
        return len(self.q)

    @cached_property
    def recursion(self) -> tuple[LinkWrenches, LinkWrenches]:
        """The reference recursion in floats, and a running error bound on each of its numbers."""
        from rttrr_pin.exact.rounding import bounded_dynamics

        with np.errstate(over="ignore", invalid="ignore"):
            return bounded_dynamics(self.model, self.q, self.v, self.a, self.loads)

    @cached_property
    def bounds(self) -> LinkWrenches:
        """A running error bound for the formulas of the recursion, the same for a state alone and in a batch.

        That of the kernel where that is wanted and cheap, else from `recursion`.
        """
        own = self.kernel_bounds if self.compiled else None
        return self.recursion[1] if own is None else own

    @cached_property
    def kernel_bounds(self) -> LinkWrenches | None:
        """The running error bound of the kernel, whose sums are in another order than the recursion's.

        None where the robot is too large to compile it, or a number overflows.
        """
        if not len(self) or len(self.model.links) > LARGEST:
            return None
        kernel = kernel_of(self.model, tuple(f"{name}_bound" for name in RESULTS))
        with suppress(NumberError):
            bounds = kernel(self.q, self.v, self.a, payload=list(self.loads) or None)
            parts = {name: bounds[f"{name}_bound"] for name in RESULTS}
            return LinkWrenches.of(parts, self.model.link_names, self.model.v_names)
        return None


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What an implementation says of a batch.

    Attributes:
        values: by quantity, in the frames and signs of docs/notation.md: tau (N, nv); F, N, f, n (N, links, 3). What is
            not finite is a deviation like any other.
        allowance: by quantity, at most how far rounding takes the Euclidean norm of each vector from the true one, tau
            (N, nv), others (N, links); None where the author knows no bound, which takes `default_allowance`.
        tau_joint: the part of tau that the joints take themselves (N, nv); None where it is not known apart.
    """

    values: Mapping[str, Array]
    allowance: Mapping[str, Array] | None = None
    tau_joint: Array | None = None


def shape_of(model: Model, quantity: str) -> tuple[int, ...]:
    """The shape of a quantity in one state: (nv,) for driving forces, (links, 3) for F, N, f, n."""
    return (len(model.links), 3) if quantity in LINK_QUANTITIES else (model.nv,)


@runtime_checkable
class Implementation(Protocol):
    """A program that computes inverse dynamics.

    Attributes:
        name: what it is called in reports.
        version: of the program or library; empty where it has none.
        quantities: which of tau, F, N, f, n it gives, in this order.

    One that also has `notes`, a tuple of sentences, has them shown beside its verdict.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def version(self) -> str: ...  # noqa: D102
    @property
    def quantities(self) -> tuple[str, ...]: ...  # noqa: D102

    def evaluate(self, batch: Batch) -> Evaluation:
        """The quantities that it gives, at each state of a batch."""
        ...


def evaluated(program: Implementation, batch: Batch) -> Evaluation:
    """What an implementation says of a batch: whoever wrote it, arrays of the shapes that are expected.

    Raises:
        RefusalError: it raised NotImplementedError: it does not offer what these states ask for.
        ImplementationError: it raised another exception, or says something else.
    """
    try:
        result = program.evaluate(batch)
    except (RttrrError, MemoryError):
        raise
    except NotImplementedError as error:
        raise RefusalError(f"{program.name} does not offer this{because(error)}") from error
    except (Exception, SystemExit) as error:  # a user's own code may run here
        raise ImplementationError(f"{program.name} raised {told(error, f' at states from {batch.first}')}") from error
    if not isinstance(result, Evaluation):
        raise ImplementationError(f"{program.name} returned a {type(result).__name__}: expected an Evaluation")
    shapes = {key: (len(batch), *shape_of(batch.model, key)) for key in program.quantities}
    values = {key: _array(program, "values", result.values, key, shape) for key, shape in shapes.items()}
    if result.allowance is None:
        return replace(result, values=values)
    shapes = {key: shape[:2] for key, shape in shapes.items()}
    allowance = {key: _array(program, "allowance", result.allowance, key, shape) for key, shape in shapes.items()}
    for key, x in allowance.items():
        if (x < 0.0).any():
            raise ImplementationError(f"{program.name} has an allowance for {key} that is negative: it is a size")
    return replace(result, values=values, allowance=allowance)


def _array(program: Implementation, what: str, arrays: Mapping[str, Array], key: str, shape: tuple[int, ...]) -> Array:
    """An array of numbers of an evaluation."""
    try:
        array = np.asarray(arrays[key])
    except (KeyError, TypeError, ValueError):
        raise ImplementationError(f"{program.name} has no {key} in its {what}: expected shape {shape}") from None
    if array.dtype.kind not in "iuf" or array.shape != shape:
        got = f"{key} of shape {array.shape} and type {array.dtype}"
        raise ImplementationError(f"{program.name} has {got} in its {what}: expected real numbers of shape {shape}")
    return array.astype(np.float64, copy=False)


def label(implementation: Implementation) -> str:
    """Name and version, as reports have them."""
    return f"{implementation.name} {implementation.version}".rstrip()
