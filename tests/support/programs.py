"""Programs run operation by operation, on floats or arrays: slow, and the reference for what compiles them."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.expression import Op
from rttrr_pin.compile.program import Program
from rttrr_pin.core.arrays import Array

Columns = Sequence[Array | float] | Mapping[int, Array | float]

NUMERIC: dict[Op, Callable[..., Array]] = {
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
    Op.NEG: operator.neg,
    Op.SIN: np.sin,
    Op.COS: np.cos,
    Op.SIGN: np.sign,
    Op.ABS: abs,
    Op.FMA: lambda x, y, z: x * y + z,
    Op.FMS: lambda x, y, z: x * y - z,
    Op.FNMA: lambda x, y, z: z - x * y,
}
"""Each operation on numbers; NumPy has no fused ones, so these round twice."""


def evaluate(program: Program, columns: Columns) -> list[Array | float]:
    """The outputs for columns of inputs."""
    graph = program.graph
    values: dict[int, Array | float] = {}
    for x in program.order:
        op, args = graph.op[x], graph.args[x]
        if op is Op.CONSTANT:
            values[x] = graph.value[x]
        elif op is Op.INPUT:
            values[x] = columns[args[0]]
        else:
            values[x] = NUMERIC[op](*(values[y] for y in args))
    return [values[x] for x in program.results]


def evaluate_calls(program: CallProgram, columns: Sequence[Array | float]) -> list[Array | float]:
    """The same, call by call."""
    memory: list[Array | float] = [*columns, *[0.0] * (program.columns - program.width_in)]
    for call in program.calls:
        step = program.steps[call.step]
        inputs = dict(zip(step.columns, (memory[c] for c in call.columns), strict=True))
        inputs |= dict(zip(step.numbers, call.numbers, strict=True))
        for column, result in zip(call.results, evaluate(step.program, inputs), strict=True):
            memory[column] = result
    return memory[program.width_in : program.width_in + program.width_out]
