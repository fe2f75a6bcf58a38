"""CUDA C++ of a program: one kernel, one thread a state, for nvcc and NVRTC alike.

    __global__ void NAME(long long states, const double *q, long long q_row, long long q_column, ...,
                         double *tau, long long tau_row, long long tau_column, unsigned long long *first_bad)

Distances from state to state and from column to column are counted in numbers. `first_bad` becomes the first state of
which a result, or an input that no result depends on, is not finite.

Every operation is an intrinsic function that rounds to nearest, which no compiler fuses or reorders: the results have
the bits of the program on any other machine with fused operations. So have sines and cosines of angles up to `LARGEST`
(`compile.sincos`); beyond it CUDA's own serve. The CUDA C++ Programming Guide states at most 2 units in the last place
for these, in the table of its section on mathematical functions; bounds count with 4 (`SINE_ULPS`).

A block of threads gathers the numbers of its states in shared memory, so that neighbouring threads read neighbouring
addresses in rows as in columns, and writes results back in the same way. Where the numbers of 32 states are too many
for that, each thread reads and writes its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.compile.emit.c_text import Dialect, comment, function_name, operations, results
from rttrr_pin.compile.expression import Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.float_type import FloatType
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import sincos_in

SHARED = 48 * 1024
"""Bytes of shared memory that a block has on every card."""

BLOCKS = (128, 64, 32)
"""Threads of a block: as many of these as fit."""

NAME = "program"
"""Of the function, where none is asked for."""

REMARKS = (
    "One thread computes one state; launch {0} threads a block, as many blocks as you like. Distances from state to "
    "state (_row) and from column to column (_column) are counted in numbers. first_bad, set to 2^64 - 1 before, "
    "becomes the first state of which a result is not finite. Outputs may lie over inputs of the same states. Compile "
    "as C++17 by nvcc or NVRTC, without --use_fast_math."
)


def _intrinsics(d: str, f: str, suffix: str) -> dict[Op, str]:
    """Each operation as an intrinsic function; the sign of what is not finite is NaN, which must not go unseen."""
    fused = f"__fma{f}_rn"
    one, zero = f"1.0{suffix}", f"0.0{suffix}"
    return {
        Op.ADD: f"__{d}add_rn({{0}}, {{1}})",
        Op.SUB: f"__{d}sub_rn({{0}}, {{1}})",
        Op.MUL: f"__{d}mul_rn({{0}}, {{1}})",
        Op.NEG: "-({0})",
        Op.SIGN: f"__{d}add_rn({{0}} > {zero} ? {one} : {{0}} < {zero} ? -{one} : {zero}, __{d}mul_rn({{0}}, {zero}))",
        Op.ABS: f"fabs{f}({{0}})",
        Op.FMA: f"{fused}({{0}}, {{1}}, {{2}})",
        Op.FMS: f"{fused}({{0}}, {{1}}, -({{2}}))",
        Op.FNMA: f"{fused}(-({{0}}), {{1}}, {{2}})",
    }


def _double(x: float) -> str:
    """A float64 in CUDA C++, to the last bit."""
    if math.isfinite(x):
        return float(x).hex()
    return f"__longlong_as_double(0x{'7ff8' if math.isnan(x) else '7ff0' if x > 0 else 'fff0'}000000000000)"


def _float(x: float) -> str:
    """The float32 nearest to a number in CUDA C++."""
    if math.isfinite(x):
        return f"{float(np.float32(x)).hex()}f"
    return f"__int_as_float(0x{'7fc0' if math.isnan(x) else '7f80' if x > 0 else 'ff80'}0000)"


DIALECTS = {
    "float64": Dialect("double", _intrinsics("d", "", ""), _double, "sincos_of"),
    "float32": Dialect("float", _intrinsics("f", "f", "f"), _float, "sincos_of"),
}
"""How operations are written, by the type of the numbers."""


@dataclass(frozen=True)
class Shape:
    """How a kernel goes through the states.

    Attributes:
        threads: of a block.
        pitch: numbers of shared memory for each thread; 0 for none.
        staged: the arrays that pass through it.
    """

    threads: int
    pitch: int
    staged: tuple[Field, ...]

    def column(self, field: Field) -> int:
        """Where an array begins among the numbers of a thread."""
        return sum(other.width for other in self.staged[: self.staged.index(field)])


def shape(inputs: Sequence[Field], outputs: Sequence[Field], float_type: FloatType) -> Shape:
    """What fits into shared memory: all arrays, or what is read, or what is written, or none."""
    for staged in ((*inputs, *outputs), tuple(inputs), tuple(outputs)):
        pitch = sum(field.width for field in staged) | 1  # odd, so that no two threads of 32 meet in a bank
        for threads in BLOCKS:
            if pitch * float_type.size * threads <= SHARED:
                return Shape(threads, pitch, staged)
    return Shape(BLOCKS[0], 0, ())


def source(program: Program, robot: str | None = None, labels: Mapping[str, Sequence[str]] | None = None) -> str:
    """The text of a program, with a comment for readers where a robot is named.

    Args:
        program: in straight lines.
        robot: its name.
        labels: names of the entries of q, v, a.
    """
    name = NAME if robot is None else function_name(program, robot)
    own = shape(program.inputs, program.outputs, program.float_type)
    signature = _signature(program, name)
    remarks = REMARKS.format(own.threads)
    head = [] if robot is None else [*comment(program, robot, labels or {}, signature, remarks)]
    return "\n".join([*head, *_functions(program, own), *_kernel(program, signature, own), ""])


def _signature(program: Program, name: str) -> str:
    real = program.float_type.c_name
    arrays = [(f"const {real} *", field) for field in program.inputs]
    arrays += [(f"{real} *", field) for field in program.outputs]
    each = (f"{pointer}{x.name}, long long {x.name}_row, long long {x.name}_column" for pointer, x in arrays)
    return f"void {name}({', '.join(('long long states', *each, 'unsigned long long *first_bad'))})"


def _kernel(program: Program, signature: str, own: Shape) -> Iterator[str]:
    """The kernel: each block takes as many states as it has threads, and goes on by as many as there are threads."""
    inputs, outputs, real = program.inputs, program.outputs, program.float_type.c_name
    yield "#ifdef __cplusplus"
    yield 'extern "C"'
    yield "#endif"
    yield f"__global__ void __launch_bounds__({own.threads})"
    yield f"{signature[5:]} {{"
    if own.pitch:
        yield f"    __shared__ {real} tile[{own.threads * own.pitch}];"
        yield f"    {real} *const own = tile + threadIdx.x * {own.pitch};"
    step = f"{own.threads}LL"
    yield f"    for (long long first = blockIdx.x * {step}; first < states; first += gridDim.x * {step}) {{"
    yield f"        const int count = states - first < {own.threads} ? (int)(states - first) : {own.threads};"
    yield "        const long long state = first + threadIdx.x;"
    yield from _moves("gather", inputs, own)
    yield "        if (threadIdx.x < count) {"
    yield from (f"            {line}" for line in _state(program, own))
    yield "        }"
    if own.pitch:
        yield "        __syncthreads();"
    yield from _moves("scatter", outputs, own)
    yield "    }"
    yield "}"


def _moves(what: str, fields: Sequence[Field], own: Shape) -> Iterator[str]:
    """Arrays into shared memory, or out of it."""
    staged = [field for field in fields if field in own.staged and field.width]
    for field in staged:
        name = field.name
        array = f"{name} + first * {name}_row, {name}_row, {name}_column"
        yield f"        {what}({array}, count, {field.width}, tile + {own.column(field)});"
    if staged:
        yield "        __syncthreads();"


def _state(program: Program, own: Shape) -> Iterator[str]:
    """The operations of one state, and whether all is finite: 0 times what is not is NaN."""
    inputs, outputs, dialect = program.inputs, program.outputs, DIALECTS[program.float_type.name]

    def place(field: Field, k: int) -> str:
        if field in own.staged:
            return f"own[{own.column(field) + k}]"
        return f"{field.name}_own[{k} * {field.name}_column]"

    fused, zero = dialect.form[Op.FMA], dialect.number(0.0)
    entries = [(field, k) for field in inputs for k in range(field.width)]
    for field in (*inputs, *outputs):
        if field not in own.staged:
            constant = "const " if field in inputs else ""
            yield f"{constant}{dialect.real} *const {field.name}_own = {field.name} + state * {field.name}_row;"
    yield f"{dialect.real} check = {zero};"
    for index in program.unread:
        yield f"check = {fused.format(place(*entries[index]), zero, 'check')};"
    yield from operations(program, dialect, place, early=True)
    for result in results(program, dialect):
        yield f"check = {fused.format(result, zero, 'check')};"
    yield f"if (!(check == {zero})) atomicMin(first_bad, (unsigned long long)state);"


def _functions(program: Program, own: Shape) -> Iterator[str]:
    """What the kernel calls: sines and cosines, and moves between arrays and shared memory."""
    if program.operations.sincos:
        yield _sincos(program.float_type)
    real = program.float_type.c_name
    if any(field in own.staged for field in program.inputs):
        yield _move("gather", f"const {real} *from", f"{real} *to", "to[{0}] = from[{1}]", own)
    if any(field in own.staged for field in program.outputs):
        yield _move("scatter", f"{real} *to", f"const {real} *from", "to[{1}] = from[{0}]", own)


def _move(name: str, array: str, tile: str, assign: str, own: Shape) -> str:
    """A move of the states of a block: along the rows where these are what is contiguous, else along the columns."""
    pitch = own.pitch
    by_rows = assign.format(f"e / width * {pitch} + e % width", "e / width * row + e % width")
    by_columns = assign.format(f"threadIdx.x * {pitch} + e", "threadIdx.x * row + e * column")
    return f"""static __device__ __forceinline__ void {name}(
    {array}, long long row, long long column, int count, int width, {tile}) {{
    if (column == 1) {{
        for (int e = threadIdx.x; e < count * width; e += {own.threads}) {by_rows};
    }} else if (threadIdx.x < count) {{
        for (int e = 0; e < width; ++e) {by_columns};
    }}
}}
"""


def _sincos(own: FloatType) -> str:
    """Sine and cosine, operation by operation as `emit.llvm_vectors.polynomials` has them."""
    dialect, numbers = DIALECTS[own.name], sincos_in(own)
    real, number, form = dialect.real, dialect.number, dialect.form

    def add(x: str, y: str) -> str:
        return form[Op.ADD].format(x, y)

    def sub(x: str, y: str) -> str:
        return form[Op.SUB].format(x, y)

    def mul(x: str, y: str) -> str:
        return form[Op.MUL].format(x, y)

    def fma(x: str, y: str, z: str) -> str:
        return form[Op.FMA].format(x, y, z)

    def horner(terms: Sequence[float]) -> str:
        value = number(terms[-1])
        for term in reversed(terms[:-1]):
            value = fma(value, "z", number(term))
        return value

    pio2 = [number(x) for x in numbers.pio2]
    steps = {
        "shifted": fma("q", number(numbers.two_over_pi), number(numbers.round)),
        "k": sub(number(numbers.round), "shifted"),
        "t": fma("k", pio2[0], "q"),
        "second": mul("k", pio2[1]),
        "r": add("t", "second"),
        "lost": sub("second", sub("r", "t")),
        "low": add("lost", fma("k", pio2[2], fma("k", pio2[1], "-second"))),
        "z": mul("r", "r"),
        "sine": horner(numbers.sine),
        "cosine": horner(numbers.cosine),
        "x": add("r", fma(mul("r", "z"), "sine", "low")),
        "half": mul("z", number(0.5)),
        "w": sub(number(1.0), "half"),
        "over": sub(sub(number(1.0), "w"), "half"),
        "y": add("w", fma("-r", "low", fma(mul("z", "z"), "cosine", "over"))),
    }
    lines = "\n".join(f"    const {real} {name} = {value};" for name, value in steps.items())
    return f"""static __device__ __noinline__ void sincos_far({real} q, {real} *s, {real} *c) {{
    *s = ({real})sin((double)q);
    *c = ({real})cos((double)q);
}}

static __device__ __forceinline__ void sincos_of({real} q, {real} *s, {real} *c) {{
    if (!({form[Op.ABS].format("q")} <= {number(numbers.largest)})) {{
        sincos_far(q, s, c);
        return;
    }}
{lines}
    const int quadrant = (int){"__double_as_longlong" if own.bits == 64 else "__float_as_int"}(shifted);
    const {real} u = quadrant & 1 ? y : x, m = quadrant & 1 ? x : y;
    *s = quadrant & 2 ? -u : u;
    *c = (quadrant + 1) & 2 ? -m : m;
}}
"""
