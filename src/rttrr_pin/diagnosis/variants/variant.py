"""A program as a hypothesis has it: the reference recursion with other numbers, other input, other output, an error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import split_columns
from rttrr_pin.core.dynamics import Result, bodies
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Call
from rttrr_pin.core.payload import payloads_of
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.variants.mutations import Mutation, mutated
from rttrr_pin.implementations.protocol import Batch

Values = dict[str, Array]
"""By quantity: tau (N, nv); F, N, f, n (N, links, 3)."""

Input = Callable[[Batch], Batch]
"""What a program makes of the states it is given; as many states, of the same model."""

Output = Callable[[Batch, Values], Values]
"""What it makes of its results, beside the states that it was given."""


@dataclass(frozen=True, slots=True, eq=False)
class Variant:
    """The reference recursion, altered.

    Attributes:
        model: its numbers; joints and links are as many, and move in the same way, as those of the robot.
        inputs: what happens to the states, the first one first.
        outputs: what happens to the results, the first one first.
        mutations: errors in the recursion itself.
    """

    model: Model
    inputs: tuple[Input, ...] = ()
    outputs: tuple[Output, ...] = ()
    mutations: tuple[Mutation, ...] = ()

    def with_input(self, own: Input) -> Variant:
        """The same, whose states are changed once more."""
        return replace(self, inputs=(*self.inputs, own))

    def with_output(self, own: Output) -> Variant:
        """The same, whose results are changed once more."""
        return replace(self, outputs=(*self.outputs, own))

    def with_mutation(self, own: Mutation) -> Variant:
        """The same with one more error."""
        return replace(self, mutations=(*self.mutations, own))

    def evaluate(self, batch: Batch) -> Values:
        """What it computes at states of the robot."""
        return self.shown(batch, run(self.model, self.given(batch), self.mutations))

    def given(self, batch: Batch) -> Batch:
        """The states that the recursion gets."""
        for own in self.inputs:
            batch = own(batch)
        return batch

    def shown(self, batch: Batch, values: Values) -> Values:
        """What it makes of the recursion's results, beside the states that it was given."""
        for own in self.outputs:
            values = own(batch, values)
        return values


def run(
    model: Model,
    batch: Batch,
    mutations: Sequence[Mutation] = (),
    call: Call = FLOAT.call,
    links: Sequence[Body] | None = None,
    gravity: Vector | None = None,
) -> Values:
    """The recursion on a batch, of one state or many; what overflows is not finite.

    `links` and `gravity`, if not the model's own, may have columns for numbers, one for each state.
    """
    links, arithmetic = links or bodies(model, FLOAT), replace(FLOAT, call=call)
    q, v, a = (columns(x) for x in (batch.q, batch.v, batch.a))
    with np.errstate(all="ignore"):
        loads = payloads_of(batch.loads, FLOAT)
        result: Result = mutated(mutations)(model, arithmetic, q, v, a, loads, links, gravity)
        numbers: list[Any] = result.scalars()
        table = np.empty((len(batch), len(numbers)))
        for column, x in zip(table.T, numbers, strict=True):
            column[:] = x
    return split_columns(model, table, QUANTITIES)
