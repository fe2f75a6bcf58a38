"""A program as LLVM assembly: straight lines over vectors of states.

The text has functions `void segment_k(ptr in, ptr out, ptr between, i64 m)`, each a loop over m states, `LANES` at a
time, and `void body(...)`, which calls them in turn. Column j of an array of the block starts at j * BLOCK.

No operation is reordered, and NaN and infinities are respected. `contract` alone lets a product and the sum that takes
it become one fused multiply-add.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

from rttrr_pin.kernel.expression import Op
from rttrr_pin.kernel.program import Program
from rttrr_pin.kernel.sincos import COSINE, LARGEST, PIO2, ROUND, SINE, TWO_OVER_PI

SEGMENT = 700
"""Operations in one loop: its code stays in the instruction cache, and the compiler's time linear."""

BINARY = {Op.ADD: "fadd", Op.SUB: "fsub", Op.MUL: "fmul"}


def literal(x: float) -> str:
    """A float64 as LLVM writes it: its bits."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', x))[0]:016X}"


@dataclass
class Lines:
    """Lines of one function, with fresh names, for vectors of so many lanes."""

    lanes: int
    text: list[str] = field(default_factory=list)
    count: int = 0

    @property
    def vector(self) -> str:
        """The type of a vector of float64."""
        return f"<{self.lanes} x double>"

    @property
    def integers(self) -> str:
        """The type of a vector of int64."""
        return f"<{self.lanes} x i64>"

    def splat(self, x: float) -> str:
        """A constant in every lane."""
        return f"<{', '.join([f'double {literal(x)}'] * self.lanes)}>"

    def whole(self, x: int) -> str:
        """An integer in every lane."""
        return f"<{', '.join([f'i64 {x}'] * self.lanes)}>"

    def __call__(self, line: str) -> str:
        """One instruction; returns the name of its result."""
        self.count += 1
        name = f"%t{self.count}"
        self.text.append(f"  {name} = {line}")
        return name

    def do(self, line: str) -> None:
        """One instruction without a result."""
        self.text.append(f"  {line}")

    def op(self, what: str, x: str, y: str) -> str:
        """A binary operation on vectors of float64, exactly as written."""
        return self(f"{what} {self.vector} {x}, {y}")

    def fma(self, x: str, y: str, z: str) -> str:
        """The sum x y + z, rounded once."""
        v = self.vector
        return self(f"call {v} @llvm.fma.v{self.lanes}f64({v} {x}, {v} {y}, {v} {z})")

    def bits(self, what: str, x: str, y: str) -> str:
        """A binary operation on vectors of int64."""
        return self(f"{what} {self.integers} {x}, {y}")

    def as_bits(self, x: str) -> str:
        """The bits of a vector of float64."""
        return self(f"bitcast {self.vector} {x} to {self.integers}")

    def as_floats(self, x: str) -> str:
        """The float64 that have these bits."""
        return self(f"bitcast {self.integers} {x} to {self.vector}")

    def at(self, base: str, offset: int) -> str:
        """The address of column offset, at the present states."""
        return self(f"getelementptr double, ptr {base}, i64 {offset}")


@dataclass(frozen=True, slots=True)
class Layout:
    """How a block of states lies in memory, and on which machine.

    Attributes:
        lanes: states computed at once.
        block: states in a block.
        pitch: the distance of two columns, in float64.
    """

    lanes: int
    block: int
    pitch: int


def body(program: Program, layout: Layout) -> tuple[str, int]:
    """The program's functions, and how many columns they need to pass values from one to the next."""
    parts = _segments(program)
    passed = _passed(program, parts)
    texts = [_segment(program, layout, k, part, passed) for k, part in enumerate(parts)]
    arguments = "ptr %in, ptr %out, ptr %between, i64 %m"
    calls = "\n".join(f"  call void @segment_{k}({arguments})" for k in range(len(parts)))
    whole = f"define void @body({arguments}) noinline {{\n{calls}\n  ret void\n}}\n"
    return "\n".join([*declarations(layout.lanes), *texts, whole, *_fill(program, layout)]), len(passed)


def _fill(program: Program, layout: Layout) -> Iterator[str]:
    """The function `void fill(ptr out, i64 m)`: what no state changes, written once for all blocks."""
    graph = program.graph
    still = [(place, x) for place, x in enumerate(program.results) if graph.op[x] is Op.CONSTANT]
    parts = [still[start : start + SEGMENT] for start in range(0, len(still), SEGMENT)]
    for k, part in enumerate(parts):
        lines = Lines(layout.lanes)
        for place, x in part:
            value = lines.splat(graph.value[x])
            lines.do(f"store {lines.vector} {value}, ptr {lines.at('%o', place * layout.pitch)}")
        yield _loop(f"fill_{k}", lines, "loop")
    calls = "\n".join(f"  call void @fill_{k}(ptr %out, ptr %out, ptr %out, i64 %m)" for k in range(len(parts)))
    yield f"define void @fill(ptr %out, i64 %m) noinline {{\n{calls}\n  ret void\n}}\n"


def declarations(lanes: int) -> Iterator[str]:
    """Of the functions that operations on vectors call."""
    v = f"<{lanes} x double>"
    yield f"declare {v} @llvm.fma.v{lanes}f64({v}, {v}, {v})"
    yield f"declare {v} @llvm.fabs.v{lanes}f64({v})"
    yield "declare double @sin(double)"
    yield "declare double @cos(double)"


def _segments(program: Program) -> list[list[int]]:
    """The operations in order, cut into loops of about equal length."""
    op = program.graph.op
    todo = [x for x in program.order if op[x] not in (Op.CONSTANT, Op.INPUT)]
    count = max(1, -(-len(todo) // SEGMENT))
    size = -(-len(todo) // count) or 1
    parts = [todo[start : start + size] for start in range(0, len(todo), size)] or [[]]
    return _angles_together(program, parts)


def _angles_together(program: Program, parts: list[list[int]]) -> list[list[int]]:
    """Sine and cosine of one angle are computed at once: both stand where the first of them stands."""
    op, args = program.graph.op, program.graph.args
    first: dict[int, int] = {}
    moved: list[list[int]] = [[] for _ in parts]
    for k, part in enumerate(parts):
        for x in part:
            home = first.setdefault(args[x][0], k) if op[x] in (Op.SIN, Op.COS) else k
            moved[home].append(x)
    return moved


def _passed(program: Program, parts: list[list[int]]) -> dict[int, int]:
    """Values that a later segment needs, and the column that each is passed in."""
    home = {x: k for k, part in enumerate(parts) for x in part}
    last = {x: home[x] for part in parts for x in part}
    for k, part in enumerate(parts):
        for x in part:
            for y in program.graph.args[x]:
                if y in home:
                    last[y] = max(last[y], k)
    needed = sorted(x for x in home if last[x] > home[x])
    return {x: column for column, x in enumerate(needed)}


def _segment(program: Program, layout: Layout, k: int, part: list[int], passed: dict[int, int]) -> str:
    """One loop."""
    lines = Lines(layout.lanes)
    writer = VectorCode(program, layout, lines, passed)
    for x in part:
        writer.compute(x)
        if x in passed:
            lines.do(f"store {lines.vector} {writer.value[x]}, ptr {lines.at('%b', passed[x] * layout.pitch)}")
    results = list(enumerate(program.results))
    inside = set(part)
    first = k == 0
    for place, x in results:
        if x in inside or (first and program.graph.op[x] is Op.INPUT):
            lines.do(f"store {lines.vector} {writer.get(x)}, ptr {lines.at('%o', place * layout.pitch)}")
    return _loop(f"segment_{k}", lines, writer.label)


def _loop(name: str, lines: Lines, last: str) -> str:
    """A function that does the lines for m states; %q, %o and %b are where these have their columns."""
    lines.text[:0] = [f"  %{at} = getelementptr double, ptr %{base}, i64 %i" for at, base in COLUMNS]
    return loop(name, "ptr noalias %in, ptr noalias %out, ptr noalias %between", lines, last)


COLUMNS = (("q", "in"), ("o", "out"), ("b", "between"))
"""Addresses at the present states, and of what."""


def loop(name: str, arguments: str, lines: Lines, last: str) -> str:
    """A function that does lines for m states, LANES at a time.

    Args:
        name: of the function.
        arguments: all but the last, m.
        lines: what is done for the states from %i on.
        last: the label of their last basic block.
    """
    text = "\n".join(lines.text)
    return f"""define internal void @{name}({arguments}, i64 %m) noinline {{
start:
  br label %loop
loop:
  %i = phi i64 [ 0, %start ], [ %next, %{last} ]
{text}
  %next = add i64 %i, {lines.lanes}
  %more = icmp ult i64 %next, %m
  br i1 %more, label %loop, label %done
done:
  ret void
}}
"""


@dataclass
class VectorCode:
    """Writes operations on vectors.

    Attributes:
        program: whose operations they are.
        layout: how the block lies in memory.
        lines: of the function that is written.
        passed: columns of values that other parts of the program compute.
        value: the vector of each node so far.
        angles: sine and cosine of each angle so far.
        label: of the present basic block.
    """

    program: Program
    layout: Layout
    lines: Lines
    passed: dict[int, int] = field(default_factory=dict)
    value: dict[int, str] = field(default_factory=dict)
    angles: dict[int, tuple[str, str]] = field(default_factory=dict)
    label: str = "loop"

    def get(self, x: int) -> str:
        """The vector of a node; read from memory where this segment does not compute it."""
        known = self.value.get(x)
        if known is not None:
            return known
        graph = self.program.graph
        if graph.op[x] is Op.CONSTANT:
            return self.lines.splat(graph.value[x])
        self.value[x] = self.read(graph.args[x][0]) if graph.op[x] is Op.INPUT else self.column("%b", self.passed[x])
        return self.value[x]

    def read(self, place: int) -> str:
        """The vector of an input."""
        return self.column("%q", place)

    def column(self, base: str, column: int) -> str:
        """The vector at the present states of a column."""
        lines = self.lines
        return lines(f"load {lines.vector}, ptr {lines.at(base, column * self.layout.pitch)}")

    def compute(self, x: int) -> None:
        """The operation of a node."""
        graph, lines = self.program.graph, self.lines
        op, args = graph.op[x], graph.args[x]
        if op in BINARY:
            name = lines(f"{BINARY[op]} contract {lines.vector} {self.get(args[0])}, {self.get(args[1])}")
        elif op is Op.NEG:
            name = lines(f"fneg {lines.vector} {self.get(args[0])}")
        elif op is Op.SIGN:
            name = self._sign(self.get(args[0]))
        else:
            if args[0] not in self.angles:
                self.angles[args[0]] = self._sincos(self.get(args[0]))
            name = self.angles[args[0]][0 if op is Op.SIN else 1]
        self.value[x] = name

    def _sign(self, x: str) -> str:
        """-1, 0 or 1; NaN of what is not finite, which must not go unseen."""
        lines = self.lines
        v, mask = lines.vector, f"<{lines.lanes} x i1>"
        above = lines(f"fcmp ogt {v} {x}, {lines.splat(0.0)}")
        below = lines(f"fcmp olt {v} {x}, {lines.splat(0.0)}")
        negative = lines(f"select {mask} {below}, {v} {lines.splat(-1.0)}, {v} {lines.splat(0.0)}")
        sign = lines(f"select {mask} {above}, {v} {lines.splat(1.0)}, {v} {negative}")
        return lines.op("fadd", sign, lines.op("fmul", x, lines.splat(0.0)))

    def _sincos(self, q: str) -> tuple[str, str]:
        """Sine and cosine, by the polynomials; angles beyond their range are done over by the C library."""
        lines = self.lines
        s, c = polynomials(lines, q)
        size = lines(f"call {lines.vector} @llvm.fabs.v{lines.lanes}f64({lines.vector} {q})")
        beyond = lines(f"fcmp ugt {lines.vector} {size}, {lines.splat(LARGEST)}")  # also NaN
        some = lines(f"bitcast <{lines.lanes} x i1> {beyond} to i{lines.lanes}")
        any_ = lines(f"icmp ne i{lines.lanes} {some}, 0")
        n, before = lines.count, self.label
        lines.do(f"br i1 {any_}, label %far{n}, label %near{n}")
        lines.text.append(f"far{n}:")
        exact = [self._library(q, beyond, old, name) for name, old in (("sin", s), ("cos", c))]
        lines.do(f"br label %near{n}")
        lines.text.append(f"near{n}:")
        self.label = f"near{n}"
        v = lines.vector
        merged = [
            lines(f"phi {v} [ {old}, %{before} ], [ {new}, %far{n} ]") for old, new in zip((s, c), exact, strict=True)
        ]
        return merged[0], merged[1]

    def _library(self, q: str, beyond: str, old: str, name: str) -> str:
        """The C library's function in the lanes that lie beyond."""
        lines, v = self.lines, self.lines.vector
        new = old
        for lane in range(lines.lanes):
            x = lines(f"extractelement {v} {q}, i32 {lane}")
            y = lines(f"call double @{name}(double {x})")
            new = lines(f"insertelement {v} {new}, double {y}, i32 {lane}")
        return lines(f"select <{lines.lanes} x i1> {beyond}, {v} {new}, {v} {old}")


def polynomials(lines: Lines, q: str) -> tuple[str, str]:
    """Sine and cosine for |q| up to LARGEST; see `rttrr_pin.kernel.sincos`."""
    splat, fma, op, bits = lines.splat, lines.fma, lines.op, lines.bits
    shifted = fma(q, splat(TWO_OVER_PI), splat(ROUND))
    k = op("fsub", splat(ROUND), shifted)  # minus the multiple of pi/2
    t = fma(k, splat(PIO2[0]), q)
    second = op("fmul", k, splat(PIO2[1]))
    r = op("fadd", t, second)
    lost = op("fsub", second, op("fsub", r, t))
    rest = fma(k, splat(PIO2[2]), fma(k, splat(PIO2[1]), lines(f"fneg {lines.vector} {second}")))
    low = op("fadd", lost, rest)
    z = op("fmul", r, r)
    sine, cosine = (_horner(lines, z, terms) for terms in (SINE, COSINE))
    s = op("fadd", r, fma(op("fmul", r, z), sine, low))
    half = op("fmul", z, splat(0.5))
    w = op("fsub", splat(1.0), half)
    over = op("fsub", op("fsub", splat(1.0), w), half)
    tail = fma(op("fmul", z, z), cosine, over)
    c = op("fadd", w, fma(lines(f"fneg {lines.vector} {r}"), low, tail))
    quadrant = lines.as_bits(shifted)
    odd = lines(f"icmp slt {lines.integers} {bits('shl', quadrant, lines.whole(63))}, {lines.whole(0)}")
    mask, v = f"<{lines.lanes} x i1>", lines.vector
    flips = [
        bits("shl", bits("lshr", n, lines.whole(1)), lines.whole(63))
        for n in (quadrant, bits("add", quadrant, lines.whole(1)))
    ]
    pair = (f"{v} {c}, {v} {s}", f"{v} {s}, {v} {c}")
    chosen = [lines(f"select {mask} {odd}, {both}") for both in pair]
    s, c = (lines.as_floats(bits("xor", lines.as_bits(x), flip)) for x, flip in zip(chosen, flips, strict=True))
    return s, c


def _horner(lines: Lines, z: str, terms: tuple[float, ...]) -> str:
    value = lines.splat(terms[-1])
    for term in reversed(terms[:-1]):
        value = lines.fma(value, z, lines.splat(term))
    return value
