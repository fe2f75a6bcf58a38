"""A program as a sequence of calls of few steps: what a robot too large for straight lines is made of.

A step is a program of its own, such as the step outwards over a revolute joint. Its inputs are columns (a number for
each state) and numbers of the robot (the same for all states). A call says where the columns lie and which numbers
these are, so that a robot of any size is a table, and the code stays as long as its different steps are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from rttrr_pin.compile.fields import Field, Widths
from rttrr_pin.compile.float_type import FLOAT64, FloatType
from rttrr_pin.compile.program import Program, inputs_of


@dataclass(frozen=True, eq=False)
class Step:
    """What many calls share.

    Attributes:
        program: from inputs to results.
        columns: places of its inputs that are columns.
        numbers: places of its inputs that are numbers of the robot.
    """

    program: Program
    columns: tuple[int, ...]
    numbers: tuple[int, ...]

    @cached_property
    def reads(self) -> tuple[tuple[int, ...], ...]:
        """For each result the places of inputs that it depends on."""
        return tuple(inputs_of(self.program.graph, (x,)) for x in self.program.results)


@dataclass(frozen=True, slots=True)
class Call:
    """One step, somewhere.

    Attributes:
        step: its index.
        columns: which columns it reads.
        numbers: what stands for the numbers.
        results: which columns it writes; one that it reads may be among them.
    """

    step: int
    columns: tuple[int, ...]
    numbers: tuple[float, ...]
    results: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class CallProgram(Widths):
    """A robot's program as calls.

    Attributes:
        steps: the programs that are called.
        calls: in order.
        inputs: the arrays it reads: the first columns.
        outputs: the arrays it writes: the columns behind those.
        between: the count of further columns, which hold what is passed on.
        unread: places of inputs that no output depends on.
        float_type: of all numbers.
    """

    steps: tuple[Step, ...]
    calls: tuple[Call, ...]
    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    between: int
    unread: tuple[int, ...]
    float_type: FloatType = FLOAT64

    @property
    def columns(self) -> int:
        """The count of all columns."""
        return self.width_in + self.width_out + self.between

    @property
    def operations(self) -> int:
        """What one state costs, sines and cosines left out."""
        each = [step.program.operations.total for step in self.steps]
        return sum(each[call.step] for call in self.calls)
