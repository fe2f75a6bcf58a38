"""Plain NumPy, for where nothing can be compiled: the program as Python source, on blocks that stay in the cache."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit import Array, Task
from rttrr_pin.compile.expression import LEAVES, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.float_type import FloatType
from rttrr_pin.compile.program import Program
from rttrr_pin.core.arrays import norm

BLOCK = 512
"""States computed at a time."""

FORM = {
    Op.ADD: "{} + {}",
    Op.SUB: "{} - {}",
    Op.MUL: "{} * {}",
    Op.NEG: "-{}",
    Op.SIN: "sin({})",
    Op.COS: "cos({})",
    Op.SIGN: "sign({})",
    Op.ABS: "abs({})",
    Op.NORM: "norm({}, {}, {})",
}
"""Each operation in Python."""

Columns = list[NDArray[Any]]


class NumpyEmitter:
    """Writes Python."""

    name = "numpy"
    identity = "numpy"
    calls = True
    fuses = False

    def emit(self, program: Program | CallProgram) -> bytes:
        """Python source of a function from columns of inputs to columns of outputs."""
        own = program.float_type
        lines = _of_calls(program) if isinstance(program, CallProgram) else _straight("program", program, own)
        return "\n".join(lines).encode()

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> NumpyExecutable:
        """Make the function."""
        space: dict[str, Any] = {
            "sin": np.sin,
            "cos": np.cos,
            "sign": np.sign,
            "norm": _norm,
            "inf": np.inf,
            "nan": np.nan,
            "float64": float,
            "float32": np.float32,
        }
        exec(compile(code, "<program>", "exec"), space)
        return NumpyExecutable(space["program"])


def _norm(*parts: Any) -> NDArray[np.float64]:
    return norm(np.stack(np.broadcast_arrays(*parts), axis=-1))


def _straight(function: str, program: Program, float_type: FloatType) -> Iterator[str]:
    """A function of a program's operations; numbers of Python's beside arrays take the type of these."""
    op, args, value = program.graph.op, program.graph.args, program.graph.value

    def name(x: int) -> str:
        if op[x] is Op.CONSTANT:
            return repr(float_type.rounded(value[x]))
        return f"x[{args[x][0]}]" if op[x] is Op.INPUT else f"t{x}"

    computed = [x for x in program.order if op[x] not in LEAVES]
    last = {y: x for x in computed for y in args[x]}
    ends: dict[int, list[int]] = {}
    for y, x in last.items():
        if op[y] not in LEAVES and y not in program.results:
            ends.setdefault(x, []).append(y)
    yield f"def {function}(x):"
    for x in computed:
        yield f"    t{x} = {FORM[op[x]].format(*(name(y) for y in args[x]))}"
        if x in ends:
            yield f"    del {', '.join(f't{y}' for y in ends[x])}"  # its memory serves the next
    yield f"    return [{', '.join(name(x) for x in program.results)}]"


def _of_calls(call_program: CallProgram) -> Iterator[str]:
    """A function for each step, the calls as data, and a function that goes through them."""
    for k, step in enumerate(call_program.steps):
        yield from _straight(f"step_{k}", step.program, call_program.float_type)
    layouts = [(step.columns, step.numbers) for step in call_program.steps]
    first, last = call_program.width_in, call_program.width_in + call_program.width_out
    yield f"steps = [{', '.join(f'step_{k}' for k in range(len(layouts)))}]"
    yield f"layouts = {layouts!r}"
    yield f"calls = {[(call.step, call.columns, call.numbers, call.results) for call in call_program.calls]!r}"
    yield "def program(x):"
    yield f"    memory = x + [None] * {call_program.columns - first}"
    yield "    for k, columns, numbers, results in calls:"
    yield f"        inputs = dict(zip(layouts[k][1], map({call_program.float_type.name}, numbers)))"
    yield "        inputs.update((place, memory[column]) for place, column in zip(layouts[k][0], columns))"
    yield "        for column, result in zip(results, steps[k](inputs)):"
    yield "            memory[column] = result"
    yield f"    return memory[{first}:{last}]"


class NumpyExecutable:
    """A Python function over columns."""

    one = None

    def __init__(self, program: Callable[[Columns], Columns]) -> None:
        self._program = program

    def bind(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> Task:
        """Blocks of the arrays, one after the other."""

        def task(start: int, stop: int) -> bool:
            unsound = False
            for first in range(start, stop, BLOCK):
                part = slice(first, min(first + BLOCK, stop))
                with np.errstate(over="ignore", invalid="ignore"):
                    columns = [np.array(column, dtype=outputs[0].dtype) for x in inputs for column in x[part].T]
                    results = iter(self._program(columns))
                    unsound |= not all(np.isfinite(column).all() for column in columns)
                for out in outputs:
                    for column in out[part].T:
                        column[:] = next(results)
                    unsound |= not np.isfinite(out[part]).all()
            return bool(unsound)

        return task


def emitter() -> NumpyEmitter:
    """The one there is."""
    return NumpyEmitter()
