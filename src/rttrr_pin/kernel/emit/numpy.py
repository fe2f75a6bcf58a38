"""Plain NumPy, for where nothing can be compiled: the program as Python source, on blocks that stay in the cache."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.kernel.emit import Array, Task
from rttrr_pin.kernel.expression import Op
from rttrr_pin.kernel.program import Field, Program

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
}
"""Each operation in Python."""

Columns = list[NDArray[np.float64]]


class NumpyEmitter:
    """Writes Python."""

    name = "numpy"
    identity = "numpy"

    def emit(self, program: Program) -> bytes:
        """Python source of a function from columns of inputs to columns of outputs."""
        op, args, value = program.graph.op, program.graph.args, program.graph.value

        def name(x: int) -> str:
            if op[x] is Op.CONSTANT:
                return repr(value[x])
            return f"x[{args[x][0]}]" if op[x] is Op.INPUT else f"t{x}"

        computed = [x for x in program.order if op[x] not in (Op.CONSTANT, Op.INPUT)]
        last = {y: x for x in computed for y in args[x]}
        ends: dict[int, list[int]] = {}
        for y, x in last.items():
            if op[y] not in (Op.CONSTANT, Op.INPUT) and y not in program.results:
                ends.setdefault(x, []).append(y)
        lines = ["def program(x):"]
        for x in computed:
            lines.append(f"    t{x} = {FORM[op[x]].format(*(name(y) for y in args[x]))}")
            if x in ends:
                lines.append(f"    del {', '.join(f't{y}' for y in ends[x])}")  # its memory serves the next
        lines.append(f"    return [{', '.join(name(x) for x in program.results)}]")
        return "\n".join(lines).encode()

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> NumpyExecutable:
        """Make the function."""
        space: dict[str, Any] = {"sin": np.sin, "cos": np.cos, "sign": np.sign, "inf": np.inf, "nan": np.nan}
        exec(compile(code, "<program>", "exec"), space)
        return NumpyExecutable(space["program"])


class NumpyExecutable:
    """A Python function over columns."""

    one = None

    def __init__(self, program: Callable[[Columns], Columns]) -> None:
        self._program = program

    def bind(self, inputs: Sequence[Array], outputs: Sequence[NDArray[np.float64]]) -> Task:
        """Blocks of the arrays, one after the other."""

        def task(start: int, stop: int) -> bool:
            unsound = False
            for first in range(start, stop, BLOCK):
                part = slice(first, min(first + BLOCK, stop))
                columns = [np.array(column, dtype=np.float64) for x in inputs for column in x[part].T]
                with np.errstate(over="ignore", invalid="ignore"):
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
