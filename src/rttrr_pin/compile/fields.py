"""The arrays that a program reads and writes: so many numbers for each state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rttrr_pin.compile.quantities import QUANTITIES
from rttrr_pin.core.model import Model


@dataclass(frozen=True, slots=True)
class Field:
    """An array that goes in or comes out: so many numbers for each state.

    Attributes:
        name: such as "q" or "tau".
        shape: of what belongs to one state, such as (6, 3).
    """

    name: str
    shape: tuple[int, ...]

    @property
    def width(self) -> int:
        """The count of numbers for each state."""
        return math.prod(self.shape)


class Widths:
    """What has input and output arrays."""

    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]

    @property
    def width_in(self) -> int:
        """The count of numbers that one state brings."""
        return sum(field.width for field in self.inputs)

    @property
    def width_out(self) -> int:
        """The count of numbers that one state yields."""
        return sum(field.width for field in self.outputs)


@dataclass(frozen=True, slots=True)
class PayloadSlot:
    """Where a payload acts, and in whose axes; its numbers come with each state.

    Attributes:
        link: index of the link.
        in_base: whether in base axes; else in the link's.
    """

    link: int
    in_base: bool = False


def outputs_of(model: Model, outputs: Sequence[str]) -> tuple[Field, ...]:
    """The arrays that a program writes."""
    return tuple(Field(name, QUANTITIES[name].shape(model)) for name in outputs)


def inputs_read(model: Model, outputs: Sequence[str], payloads: Sequence[PayloadSlot] = ()) -> tuple[Field, ...]:
    """The arrays that a program reads: what its outputs depend on, then force and moment of each payload."""
    sizes = {"q": model.nq, "v": model.nv, "a": model.nv}
    needed = [name for name in sizes if any(name in QUANTITIES[output].inputs for output in outputs)]
    slots = [Field(f"payload_{k}_{name}", (3,)) for k in range(len(payloads)) for name in "fn"]
    return (*(Field(name, (sizes[name],)) for name in needed), *slots)
