"""Operations on vectors of states as LLVM assembly: what straight lines and the steps of a schedule are written in.

No operation is reordered or fused with another, and NaN and infinities are respected: what is written is what is done.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

from rttrr_pin.compile.emit.llvm_angles import beyond, library, polynomials, some
from rttrr_pin.compile.expression import FUSED, Op
from rttrr_pin.compile.float_type import FLOAT64, FloatType
from rttrr_pin.compile.program import Program

FAR = 2.0**-500
"""Below it, and above its inverse, squares may leave the normal numbers of float64."""

SHRINK = 2.0**-600
"""What vectors of large numbers are multiplied by before they are squared; those of small ones are divided by it."""

LINE = 64
"""Bytes in a line of the cache."""

BINARY = {Op.ADD: "fadd", Op.SUB: "fsub", Op.MUL: "fmul"}


def literal(x: float) -> str:
    """A number as LLVM writes it: its bits as a float64, also of a float32."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', x))[0]:016X}"


@dataclass
class Lines:
    """Lines of one function, with fresh names, for vectors of so many lanes."""

    lanes: int
    float_type: FloatType = FLOAT64
    text: list[str] = field(default_factory=list)
    count: int = 0

    @property
    def vector(self) -> str:
        """The type of a vector of numbers."""
        return f"<{self.lanes} x {self.float_type.c_name}>"

    @property
    def integers(self) -> str:
        """The type of a vector of integers, as long as the numbers."""
        return f"<{self.lanes} x i{self.float_type.bits}>"

    @property
    def suffix(self) -> str:
        """What the names of LLVM's functions on such vectors end with."""
        return f"v{self.lanes}f{self.float_type.bits}"

    def splat(self, x: float) -> str:
        """A constant in every lane."""
        number = f"{self.float_type.c_name} {literal(self.float_type.rounded(x))}"
        return f"<{', '.join([number] * self.lanes)}>"

    def whole(self, x: int) -> str:
        """An integer in every lane."""
        return f"<{', '.join([f'i{self.float_type.bits} {x}'] * self.lanes)}>"

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
        """A binary operation on vectors of numbers, exactly as written."""
        return self(f"{what} {self.vector} {x}, {y}")

    def fma(self, x: str, y: str, z: str) -> str:
        """The sum x y + z, rounded once."""
        v = self.vector
        return self(f"call {v} @llvm.fma.{self.suffix}({v} {x}, {v} {y}, {v} {z})")

    def function(self, name: str, x: str) -> str:
        """A function that the processor has."""
        return self(f"call {self.vector} @llvm.{name}.{self.suffix}({self.vector} {x})")

    def select(self, where: str, x: str, y: str) -> str:
        """One of two vectors, lane by lane."""
        return self(f"select <{self.lanes} x i1> {where}, {self.vector} {x}, {self.vector} {y}")

    def negated(self, x: str) -> str:
        """The opposite."""
        return self(f"fneg {self.vector} {x}")

    def bits(self, what: str, x: str, y: str) -> str:
        """A binary operation on vectors of integers."""
        return self(f"{what} {self.integers} {x}, {y}")

    def at(self, base: str, offset: int) -> str:
        """The address of column offset, at the present states."""
        return self(f"getelementptr {self.float_type.c_name}, ptr {base}, i64 {offset}")


@dataclass(frozen=True, slots=True)
class Layout:
    """How a block of states lies in memory, and on which machine.

    Attributes:
        lanes: states computed at once.
        block: states in a block.
        pitch: the distance of two columns, in numbers.
        float_type: of the numbers.
        short: whether a column of a block is one line of the cache: then all is done for a vector before the next.
    """

    lanes: int
    block: int
    pitch: int
    float_type: FloatType = FLOAT64
    short: bool = False

    def lines(self) -> Lines:
        """For a function on its columns."""
        return Lines(self.lanes, self.float_type)


def declarations(layout: Layout) -> Iterator[str]:
    """Of the functions that operations on vectors call."""
    lines = layout.lines()
    v = lines.vector
    yield f"declare {v} @llvm.fma.{lines.suffix}({v}, {v}, {v})"
    yield f"declare {v} @llvm.fabs.{lines.suffix}({v})"
    yield f"declare {v} @llvm.sqrt.{lines.suffix}({v})"
    yield "declare double @sin(double)"
    yield "declare double @cos(double)"


def loop(name: str, arguments: str, lines: Lines, last: str) -> str:
    """A function that does lines for m states, LANES at a time from %i on; `last` labels their last basic block."""
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
    """Writes operations of a program on vectors.

    Attributes:
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
        if x in self.value:
            return self.value[x]
        graph = self.program.graph
        if graph.op[x] is Op.CONSTANT:
            return self.lines.splat(graph.value[x])
        self.value[x] = self.read(graph.args[x][0]) if graph.op[x] is Op.INPUT else self.column("%b", self.passed[x])
        return self.value[x]

    def read(self, index: int) -> str:
        """The vector of an input."""
        return self.column("%q", index)

    def column(self, base: str, column: int) -> str:
        """The vector at the present states of a column."""
        lines = self.lines
        return lines(f"load {lines.vector}, ptr {lines.at(base, column * self.layout.pitch)}")

    def compute(self, x: int) -> None:
        """The operation of a node."""
        graph, lines = self.program.graph, self.lines
        op, args = graph.op[x], graph.args[x]
        if op in BINARY:
            name = lines.op(BINARY[op], self.get(args[0]), self.get(args[1]))
        elif op in FUSED:
            left, right, term = (self.get(y) for y in args)
            left = lines.negated(left) if op is Op.FNMA else left
            name = lines.fma(left, right, lines.negated(term) if op is Op.FMS else term)
        elif op is Op.NEG:
            name = lines.negated(self.get(args[0]))
        elif op is Op.SIGN:
            name = self._sign(self.get(args[0]))
        elif op is Op.ABS:
            name = lines.function("fabs", self.get(args[0]))
        elif op is Op.NORM:
            name = _norm(lines, [self.get(y) for y in args])
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

    def near(self, x: int) -> None:
        """A sine or cosine by the polynomials alone; see `llvm_angles.mend`."""
        angle = self.program.graph.args[x][0]
        if angle not in self.angles:
            self.angles[angle] = polynomials(self.lines, self.get(angle))
        self.value[x] = self.angles[angle][0 if self.program.graph.op[x] is Op.SIN else 1]

    def _sincos(self, q: str) -> tuple[str, str]:
        """Sine and cosine, by the polynomials; angles beyond their range are done over by the C library."""
        lines = self.lines
        s, c = polynomials(lines, q)
        far = beyond(lines, q)
        any_ = some(lines, far)
        # The polynomials are computed in any case; the calls are skipped where no lane needs them, as for the angles of
        # any robot. Values of both ways meet in a phi, which must name the blocks that they come from.
        n, before = lines.count, self.label
        lines.do(f"br i1 {any_}, label %far{n}, label %near{n}")
        lines.text.append(f"far{n}:")
        exact = [library(lines, name, q, far, old) for name, old in (("sin", s), ("cos", c))]
        lines.do(f"br label %near{n}")
        lines.text.append(f"near{n}:")
        self.label = f"near{n}"
        v = lines.vector
        merged = [
            lines(f"phi {v} [ {old}, %{before} ], [ {new}, %far{n} ]") for old, new in zip((s, c), exact, strict=True)
        ]
        return merged[0], merged[1]


def _norm(lines: Lines, parts: list[str]) -> str:
    """The root of the sum of squares, of float64; large and small vectors are scaled by a power of two meanwhile."""
    sizes = [lines.function("fabs", x) for x in parts]
    most = sizes[0]
    for size in sizes[1:]:
        most = lines.select(lines(f"fcmp ogt {lines.vector} {size}, {most}"), size, most)
    large = lines(f"fcmp ogt {lines.vector} {most}, {lines.splat(1 / FAR)}")
    small = lines(f"fcmp olt {lines.vector} {most}, {lines.splat(FAR)}")
    down, up = (
        lines.select(large, lines.splat(shrink), lines.select(small, lines.splat(1 / shrink), lines.splat(1.0)))
        for shrink in (SHRINK, 1 / SHRINK)
    )
    scaled = [lines.op("fmul", size, down) for size in sizes]
    squares = [lines.op("fmul", x, x) for x in scaled]
    total = lines.op("fadd", lines.op("fadd", squares[0], squares[1]), squares[2])
    return lines.op("fmul", lines.function("sqrt", total), up)
