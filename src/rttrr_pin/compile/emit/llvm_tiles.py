"""Tiles of rows: a few numbers of LANES states at a time, exchanged in registers between rows and columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from llvmlite import ir

from rttrr_pin.compile.emit.llvm_vectors import Layout
from rttrr_pin.compile.emit.llvm_writer import I32, SCALAR, Writer, number

UNROLLED, GROUP = 32, 16
"""Columns up to which all tiles of a row stand one behind the other; beyond, so many columns in a turn of a loop."""

SUMS = 4
"""In which what is not finite is looked for: one would wait for itself."""


class Columns:
    """Columns of a block of states in memory, as one function sees them."""

    def __init__(self, w: Writer, layout: Layout, base: ir.Value) -> None:
        self.w, self.base, self.lanes, self.size = w, base, layout.lanes, layout.float_type.size
        self.scalar = SCALAR[layout.float_type.bits]
        self.vector = ir.VectorType(self.scalar, layout.lanes)
        self._pitch = layout.pitch * self.size

    def at(self, column: ir.Value, state: ir.Value) -> ir.Value:
        """Where a column has the number of a state."""
        base = self.w.offset(self.base, self.w.times(state, self.size))
        return self.w.offset(base, self.w.times(column, self._pitch))

    def get(self, column: ir.Value, state: ir.Value) -> ir.Value:
        """The vector of a column from a state on."""
        return self.w.load(self.vector, self.at(column, state), self.size)

    def put(self, value: ir.Value, column: ir.Value, state: ir.Value) -> None:
        """Write it, from numbers of either type."""
        b = self.w.builder
        if value.type.element is not self.scalar:
            value = (b.fptrunc if self.size == 4 else b.fpext)(value, self.vector)
        self.w.store(value, self.at(column, state), self.size)


class Sound:
    """Whether all numbers seen are finite: a sum of 0 x is 0 then, and else NaN.

    Looked at once, in the end: a branch in each loop would cost more than the products.
    """

    def __init__(self, w: Writer, ir_type: ir.Type) -> None:
        self._w, self._type, self._seen = w, ir_type, 0
        self._zero = ir.Constant(ir_type, [0.0] * ir_type.count if isinstance(ir_type, ir.VectorType) else 0.0)
        self._sums = [w.memory(ir_type) for _ in range(SUMS)]
        for own in self._sums:
            w.store(self._zero, own)

    def seen(self, x: ir.Value) -> ir.Value:
        """The same number or vector."""
        w, b = self._w, self._w.builder
        own = self._sums[self._seen % SUMS]
        self._seen += 1
        product = b.fmul(x, self._zero, flags=("contract",))
        w.store(b.fadd(w.load(self._type, own), product, flags=("contract",)), own)
        return x

    def all(self) -> ir.Value:
        """Whether all were finite."""
        b, total = self._w.builder, self._zero
        for own in self._sums:
            total = b.fadd(total, self._w.load(self._type, own))
        finite = b.fcmp_ordered("ord", total, total)
        if not isinstance(self._type, ir.VectorType):
            return finite
        bits = ir.IntType(self._type.count)
        return b.icmp_unsigned("==", b.bitcast(finite, bits), ir.Constant(bits, -1))


def rows_in(columns: Columns, bits: int, width: int, rows: Sequence[ir.Value], state: ir.Value) -> None:
    """Gather LANES rows whose numbers lie side by side."""
    w, b, size = columns.w, columns.w.builder, bits // 8
    for j, count in _tiles(w, columns.lanes, width):
        chunks = [w.load(vector(bits, count), w.offset(x, w.times(j, size)), size) for x in rows]
        # Vector k has the chunks of rows k, k + count, k + 2 count, ...: as many squares side by side.
        squares = [_joined(b, chunks[k::count]) for k in range(count)]
        for k, value in enumerate(_transposed(b, squares)):
            columns.put(value, w.plus(j, k), state)


def rows_out(columns: Columns, width: int, rows: Sequence[ir.Value], state: ir.Value, sound: Sound) -> None:
    """Scatter LANES rows whose numbers lie side by side."""
    w, b, size = columns.w, columns.w.builder, columns.size
    for j, count in _tiles(w, columns.lanes, width):
        vectors = [sound.seen(columns.get(w.plus(j, k), state)) for k in range(count)]
        vectors = _transposed(b, vectors)
        for k, y in enumerate(rows):
            chunk = _part(b, vectors[k % count], k // count * count, count)
            w.store(chunk, w.offset(y, w.times(j, size)), size)


def vector(bits: int, count: int) -> ir.Type:
    """So many numbers of so many bits."""
    return ir.VectorType(SCALAR[bits], count)


def _tiles(w: Writer, lanes: int, width: int) -> Iterator[tuple[ir.Value, int]]:
    """The first column of each tile of rows, and how many: half a vector, and smaller powers of two in the end."""
    most = max(2, lanes // 2)
    at = width // GROUP * GROUP if width > UNROLLED else 0
    if at:
        with w.loop(number(at), GROUP) as first:
            for k in range(0, GROUP, most):
                yield w.plus(first, k), most
    while at < width:
        count = min(most, 1 << (width - at).bit_length() - 1)
        yield number(at), count
        at += count


def _joined(b: ir.IRBuilder, vectors: Sequence[ir.Value]) -> ir.Value:
    """Vectors one behind the other as one."""
    while len(vectors) > 1:
        both = ir.Constant(ir.VectorType(I32, 2 * vectors[0].type.count), list(range(2 * vectors[0].type.count)))
        vectors = [b.shuffle_vector(x, y, both) for x, y in zip(vectors[::2], vectors[1::2], strict=True)]
    return vectors[0]


def _part(b: ir.IRBuilder, vector: ir.Value, first: int, count: int) -> ir.Value:
    """So many numbers of a vector."""
    lanes = ir.Constant(ir.VectorType(I32, count), list(range(first, first + count)))
    return b.shuffle_vector(vector, vector, lanes)


def _transposed(b: ir.IRBuilder, vectors: list[ir.Value]) -> list[ir.Value]:
    """Vectors of squares side by side, each square transposed: halves exchanged, then quarters, and so on."""
    N, W = len(vectors), vectors[0].type.count
    vectors = list(vectors)
    step = N // 2
    while step:
        for i in (i for i in range(N) if not i & step):
            x, y = vectors[i], vectors[i + step]
            low = [k if not k & step else W + k - step for k in range(W)]
            high = [k + step if not k & step else W + k for k in range(W)]
            vectors[i], vectors[i + step] = (
                b.shuffle_vector(x, y, ir.Constant(ir.VectorType(I32, W), mask)) for mask in (low, high)
            )
        step //= 2
    return vectors
