"""Numba: the program as Python source, loops over blocks of states that LLVM turns into vector code.

The source has functions `segment_k(c)`, each a loop over the 64 states of a block: c are columns of the inputs, then
the outputs, then what passes from one function to another, and column j starts at j * PITCH. All in one array, so that
LLVM sees from the distances alone that no column overlaps another. `STEPS` says in which order they run, and where in
between sines and cosines are due: these are one function for all programs, so that no program compiles them anew.

A block is always full, states that are missing repeat the last one, and 64 is the number of turns of every loop: there
is no remainder that would go through other instructions than the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba import cfunc, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from rttrr_pin.compile.emit import Array, Task
from rttrr_pin.compile.expression import Op
from rttrr_pin.compile.program import Field, Program
from rttrr_pin.compile.sincos import COSINE, LARGEST, PIO2, ROUND, SINE, TWO_OVER_PI

BLOCK = 64
"""States in a block."""

PITCH = BLOCK + 8
"""The distance of two columns, in float64: not a power of two, so that they spread over the cache."""

SEGMENT = 500
"""Operations in one function: few enough for the instruction cache and for compilers whose time grows faster."""

FORM = {
    Op.ADD: "{} + {}",
    Op.SUB: "{} - {}",
    Op.MUL: "{} * {}",
    Op.NEG: "-{}",
    Op.SIGN: "sign({})",
    Op.ABS: "abs({})",
    Op.FMA: "fma({}, {}, {})",
    Op.FMS: "fma({}, {}, -{})",
    Op.FNMA: "fma(-{}, {}, {})",
}
"""Each operation in Python; sine and cosine are steps of their own."""

PIO2_0, PIO2_1, PIO2_2 = PIO2

Columns = NDArray[np.float64]

F = TypeVar("F", bound=Callable[..., Any])


# ---- what Python has no word for


def _pointer(kind: ir.Type) -> Callable[[ir.IRBuilder, ir.Value], ir.Value]:
    return lambda builder, address: builder.inttoptr(address, kind.as_pointer())


def _fma(_: Any, x: Any, y: Any, z: Any) -> Any:
    """The sum x y + z, rounded once."""
    return types.float64(*[types.float64] * 3), lambda context, builder, sig, args: builder.fma(*args)


def _bits(_: Any, x: Any) -> Any:
    """The bits of a float64."""
    return types.int64(types.float64), lambda context, builder, sig, args: builder.bitcast(args[0], ir.IntType(64))


def _float64_at(_: Any, address: Any) -> Any:
    """The float64 at an address."""
    pointer = _pointer(ir.DoubleType())
    return types.float64(types.int64), lambda context, builder, sig, args: builder.load(pointer(builder, *args))


def _float32_at(_: Any, address: Any) -> Any:
    """The float32 at an address."""
    pointer = _pointer(ir.FloatType())
    return types.float32(types.int64), lambda context, builder, sig, args: builder.load(pointer(builder, *args))


def _put(_: Any, address: Any, x: Any) -> Any:
    """Write a float64 to an address."""
    pointer = _pointer(ir.DoubleType())

    def write(context: Any, builder: ir.IRBuilder, sig: Any, args: Any) -> ir.Value:
        builder.store(args[1], pointer(builder, args[0]))
        return context.get_dummy_value()

    return types.void(types.int64, types.float64), write


def _call(_: Any, address: Any, columns: Any) -> Any:
    """Call the segment at an address."""
    double, segment = ir.DoubleType(), ir.FunctionType(ir.VoidType(), [ir.DoubleType().as_pointer()])

    def write(context: Any, builder: ir.IRBuilder, sig: Any, args: Any) -> ir.Value:
        builder.call(_pointer(segment)(builder, args[0]), [_pointer(double)(builder, args[1])])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), write


fma, bits, float64_at, float32_at, put, call = map(intrinsic, (_fma, _bits, _float64_at, _float32_at, _put, _call))


# ---- the functions that all programs share; without contraction, so that the range reduction stays as it is written


def compiled(function: F) -> F:
    """The function by Numba, compiled when it is first called, and run without the interpreter's lock."""
    made: F = njit(nogil=True)(function)
    return made


@compiled
def sign(x: float) -> float:
    """-1, 0, 1, or NaN of NaN."""
    return 1.0 if x > 0.0 else -1.0 if x < 0.0 else x


@compiled
def horner(z: float, c0: float, c1: float, c2: float, c3: float, c4: float, c5: float) -> float:
    """The polynomial c0 + c1 z + ... + c5 z^5."""
    value: float = fma(fma(fma(fma(fma(c5, z, c4), z, c3), z, c2), z, c1), z, c0)
    return value


@compiled
def polynomials(q: Columns, sine: Columns, cosine: Columns) -> bool:
    """Sine and cosine of a block; tells whether an angle lies beyond `LARGEST`. See `rttrr_pin.compile.sincos`."""
    far = False
    for i in range(BLOCK):
        shifted = fma(q[i], TWO_OVER_PI, ROUND)
        k = ROUND - shifted  # minus the multiple of pi/2
        t = fma(k, PIO2_0, q[i])
        second = k * PIO2_1
        r = t + second
        lost = second - (r - t)
        low = lost + fma(k, PIO2_2, fma(k, PIO2_1, -second))
        z = r * r
        s = r + fma(r * z, horner(z, *SINE), low)
        half = z * 0.5
        w = 1.0 - half
        c = w + fma(-r, low, fma(z * z, horner(z, *COSINE), (1.0 - w) - half))
        quadrant = bits(shifted)
        odd = (quadrant & 1) != 0
        up, across = (c, s) if odd else (s, c)
        sine[i] = -up if (quadrant & 2) != 0 else up
        cosine[i] = -across if ((quadrant + 1) & 2) != 0 else across
        far |= not abs(q[i]) <= LARGEST  # also NaN
    return far


@compiled
def column(columns: Columns, j: int) -> Columns:
    """One of them."""
    return columns[j * PITCH : j * PITCH + BLOCK]


@compiled
def sincos(columns: Columns, angle: int, s: int, c: int) -> None:
    """Sine and cosine of a column, in place; angles beyond `LARGEST` are done over by the C library."""
    q, sine, cosine = column(columns, angle), column(columns, s), column(columns, c)
    if polynomials(q, sine, cosine):
        for i in range(BLOCK):
            if not abs(q[i]) <= LARGEST:
                sine[i], cosine[i] = math.sin(q[i]), math.cos(q[i])


@compiled
def gather(array: NDArray[np.int64], first: int, m: int, columns: Columns) -> None:
    """Some states of an array into columns; the last one is repeated until the block is full."""
    address, row, apart, width, single, at = array
    for j in range(width):
        here, to = address + first * row + j * apart, column(columns, at + j)
        if single != 0:
            for i in range(m):
                to[i] = float32_at(here + i * row)
        else:
            for i in range(m):
                to[i] = float64_at(here + i * row)
        for i in range(m, BLOCK):
            to[i] = to[m - 1]


@compiled
def scatter(array: NDArray[np.int64], first: int, m: int, columns: Columns) -> None:
    """Some states from columns into an array."""
    address, row, apart, width, _, at = array
    for j in range(width):
        here, source = address + first * row + j * apart, column(columns, at + j)
        for i in range(m):
            put(here + i * row, source[i])


@compiled
def unsound(columns: Columns, width: int) -> bool:
    """Whether a number in the first columns is not finite: 0 x is 0 but for those, whose sum is NaN."""
    total = np.zeros(BLOCK)
    for j in range(width):
        for i in range(BLOCK):
            total[i] += columns[j * PITCH + i] * 0.0
    return math.isnan(total.sum())


@compiled
def run(
    inputs: NDArray[np.int64],
    outputs: NDArray[np.int64],
    steps: NDArray[np.int64],
    between: int,
    start: int,
    stop: int,
) -> bool:
    """Some states of a batch, block by block; tells whether a number is not finite."""
    constants = inputs[:, 3].sum() + outputs[:, 3].sum()
    c = np.empty((constants + between) * PITCH)
    bad = False
    for first in range(start, stop, BLOCK):
        m = min(BLOCK, stop - first)
        for k in range(len(inputs)):
            gather(inputs[k], first, m, c)
        for k in range(len(steps)):
            address, angle, sine, cosine = steps[k]
            if address != 0:
                call(address, c.ctypes.data)
            else:
                sincos(c, angle, sine, cosine)
        bad |= unsound(c, constants)
        for k in range(len(outputs)):
            scatter(outputs[k], first, m, c)
    return bad


# ---- the program's own functions


@dataclass(frozen=True)
class Plan:
    """A program, cut into loops with sines and cosines between them.

    Attributes:
        parts: the operations of each function, in order.
        angles: for each function the nodes whose sines and cosines are due after it.
        column: of each input, and of each value that passes from one function to another.
    """

    parts: list[list[int]]
    angles: list[list[int]]
    column: dict[int, int]

    @classmethod
    def of(cls, program: Program) -> Plan:
        """Operations on sines come behind the sines, and no function has more than `SEGMENT` operations."""
        op, args = program.graph.op, program.graph.args
        depth: dict[int, int] = {}
        for x in program.order:
            inner = () if op[x] is Op.INPUT else args[x]
            depth[x] = max((depth[y] for y in inner), default=0) + (op[x] in (Op.SIN, Op.COS))
        parts: list[list[int]] = []
        angles: list[list[int]] = []
        for level in range(max(depth.values(), default=0) + 1):
            mine = [x for x in program.order if depth[x] == level and op[x] in FORM]
            pieces = [mine[k : k + SEGMENT] for k in range(0, len(mine), SEGMENT)] or [[]]
            due = {args[x][0]: 0 for x in program.order if depth[x] == level + 1 and op[x] in (Op.SIN, Op.COS)}
            parts += pieces
            angles += [[] for _ in pieces[1:]] + [list(due)]
        return cls(parts, angles, _columns(program, parts))


def _columns(program: Program, parts: list[list[int]]) -> dict[int, int]:
    """Where inputs, sines, cosines, angles, and what a later function needs, stand."""
    op, args = program.graph.op, program.graph.args
    home = {x: k for k, part in enumerate(parts) for x in part}
    column = {x: args[x][0] for x in program.order if op[x] is Op.INPUT}
    needed = {y for k, part in enumerate(parts) for x in part for y in args[x] if home.get(y, k) < k}
    for x in program.order:
        if op[x] in (Op.SIN, Op.COS):
            needed |= {x, args[x][0]}
    passed = sorted(x for x in needed if x not in column)
    first = program.width_in + len(program.results)
    return column | {x: first + k for k, x in enumerate(passed)}


class NumbaEmitter:
    """Writes Python for Numba."""

    name = "numba"
    identity = "numba"
    calls = False
    fuses = True

    def emit(self, program: Program) -> bytes:
        """Python source; what Numba makes of it is not kept on disk."""
        plan = Plan.of(program)
        lines = [line for k in range(len(plan.parts)) for line in _segment(program, plan, k)]
        steps: list[tuple[int, ...]] = []
        constants = program.width_in + len(program.results)
        spare = max((constants, *plan.column.values())) + 1  # takes the sine where the cosine alone is needed
        where = {(program.graph.op[x], program.graph.args[x]): at for x, at in plan.column.items()}
        for k, angles in enumerate(plan.angles):
            steps.append((k,))
            for x in angles:
                s, c = (where.get((op, (x,)), spare) for op in (Op.SIN, Op.COS))
                steps.append((plan.column[x], s, c))
        lines += [f"STEPS = {steps!r}", f"BETWEEN = {spare + 1 - constants}"]
        return "\n".join(lines).encode()

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> NumbaExecutable:
        """Compile the source."""
        space: dict[str, Any] = {"fma": fma, "sign": sign, "inf": math.inf, "nan": math.nan}
        exec(compile(code, "<program>", "exec"), space)
        compiler = cfunc(types.void(types.CPointer(types.float64)))
        segments = [compiler(space[f"segment_{step[0]}"]) for step in space["STEPS"] if len(step) == 1]
        steps = [(segments[step[0]].address, 0, 0, 0) if len(step) == 1 else (0, *step) for step in space["STEPS"]]
        return NumbaExecutable(segments, np.array(steps, dtype=np.int64), space["BETWEEN"])


def _segment(program: Program, plan: Plan, k: int) -> Iterator[str]:
    """One function."""
    graph, part = program.graph, plan.parts[k]
    inside = set(part)
    read: set[int] = set()

    def name(x: int) -> str:
        if graph.op[x] is Op.CONSTANT:
            return repr(graph.value[x])
        if x not in inside:
            read.add(x)
        return f"t{x}"

    lines = [f"t{x} = {FORM[graph.op[x]].format(*(name(y) for y in graph.args[x]))}" for x in part]
    lines += [f"c[i + {plan.column[x] * PITCH}] = t{x}" for x in part if x in plan.column]
    last = k == len(plan.parts) - 1
    computed = {x for other in plan.parts for x in other}
    for place, x in enumerate(program.results, program.width_in):
        if x in inside or (last and x not in computed):
            lines.append(f"c[i + {place * PITCH}] = {name(x)}")
    yield f"def segment_{k}(c):"
    yield f"    for i in range({BLOCK}):"
    yield from (f"        t{x} = c[i + {plan.column[x] * PITCH}]" for x in sorted(read))
    yield from (f"        {line}" for line in lines or ["pass"])


class NumbaExecutable:
    """Compiled functions, and the order in which they run."""

    one = None

    def __init__(self, segments: Sequence[Any], steps: NDArray[np.int64], between: int) -> None:
        self._segments = segments  # their code lives as long as they
        self._steps = steps
        self._between = between

    def bind(self, inputs: Sequence[Array], outputs: Sequence[NDArray[np.float64]]) -> Task:
        """Describe the arrays once, for any number of calls from any thread."""
        read, write = np.split(_records((*inputs, *outputs)), [len(inputs)])

        def task(start: int, stop: int, alive: object = (self, inputs, outputs)) -> bool:
            return bool(run(read, write, self._steps, self._between, start, stop))

        return task


def _records(arrays: Sequence[Array]) -> NDArray[np.int64]:
    """Address, bytes from state to state and from column to column, width, whether float32, first column."""
    records = np.zeros((len(arrays), 6), dtype=np.int64)
    at = 0
    for record, x in zip(records, arrays, strict=True):
        record[:] = (x.__array_interface__["data"][0], *x.strides, x.shape[1], x.dtype.itemsize == 4, at)
        at += x.shape[1]
    return records


@cache
def emitter() -> NumbaEmitter:
    """The one of this process."""
    return NumbaEmitter()
