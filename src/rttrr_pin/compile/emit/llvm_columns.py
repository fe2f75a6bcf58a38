"""Compiled code that moves states between arrays of any layout and the columns that a program works on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from llvmlite import ir

from rttrr_pin.compile.emit.llvm_vectors import Layout

I64, F64, F32, PTR, I1 = ir.IntType(64), ir.DoubleType(), ir.FloatType(), ir.PointerType(), ir.IntType(1)
I32 = ir.IntType(32)

LINE = 64
"""Bytes in a line of the cache."""

SCALAR = {64: F64, 32: F32}
"""The type of numbers of so many bits."""


def number(x: int) -> ir.Constant:
    """An int64."""
    return ir.Constant(I64, x)


def untyped(address: ir.NamedValue) -> ir.NamedValue:
    """The address as LLVM sees it, of nothing in particular."""
    address.type = PTR
    return address


@dataclass
class Writer:
    """Writes one function."""

    builder: ir.IRBuilder

    def offset(self, base: ir.Value, bytes_: ir.Value | int) -> ir.Value:
        """The address so many bytes further."""
        by = number(bytes_) if isinstance(bytes_, int) else bytes_
        return self.builder.gep(base, [by], source_etype=ir.IntType(8))

    def load(self, ir_type: ir.Type, address: ir.Value, align: int | None = None) -> ir.Value:
        """What stands at an address."""
        return self.builder.load(address, typ=ir_type, align=align)

    def store(self, value: ir.Value, address: ir.Value, align: int | None = None) -> None:
        """Write to an address."""
        self.builder.store(value, address, align=align)

    @contextmanager
    def loop(self, stop: ir.Value, step: int = 1, start: ir.Value | None = None) -> Iterator[ir.Value]:
        """From start (0) to stop by step."""
        b = self.builder
        first, body_, after = (b.append_basic_block(name) for name in ("head", "body", "after"))
        before = b.block
        b.branch(first)
        b.position_at_end(first)
        i = b.phi(I64)
        i.add_incoming(start or number(0), before)
        b.cbranch(b.icmp_signed("<", i, stop), body_, after)
        b.position_at_end(body_)
        yield i
        i.add_incoming(b.add(i, number(step)), b.block)
        b.branch(first)
        b.position_at_end(after)

    def memory(self, ir_type: ir.Type, count: int = 1) -> ir.Value:
        """Memory of this function's own, on a cache line."""
        memory = self.builder.alloca(ir_type, count)
        memory.align = LINE
        return untyped(memory)

    def aligned(self, address: ir.Value) -> ir.Value:
        """The next address on a cache line."""
        b = self.builder
        return b.inttoptr(b.and_(b.add(b.ptrtoint(address, I64), number(LINE - 1)), number(-LINE)), PTR)

    def require(self, condition: ir.Value, otherwise: ir.Block) -> None:
        """Go on where the condition holds."""
        on = self.builder.append_basic_block("on")
        self.builder.cbranch(condition, on, otherwise)
        self.builder.position_at_end(on)

    def least(self, x: ir.Value, y: ir.Value) -> ir.Value:
        """The smaller of two."""
        return self.builder.select(self.builder.icmp_signed("<", x, y), x, y)


def function(
    module: ir.Module, name: str, result: ir.Type, arguments: Sequence[ir.Type], internal: bool = True
) -> tuple[ir.Function, Writer]:
    """A new function and what writes it; an internal one keeps its code to itself, and is not copied into others."""
    function = ir.Function(module, ir.FunctionType(result, arguments), name)
    if internal:
        function.linkage = "internal"
        function.attributes.add("noinline")
    return function, Writer(ir.IRBuilder(function.append_basic_block("start")))


def pack(module: ir.Module, layout: Layout, bits: int) -> ir.Function:
    """Gather m states of an array of numbers of so many bits into columns; lanes beyond m repeat the last state."""
    routine, w = function(module, f"pack_f{bits}", ir.VoidType(), [PTR, I64, I64, I64, PTR, I64])
    source, row, column, count, target, m = routine.args
    b, W, pitch, size = w.builder, layout.lanes, number(layout.pitch * layout.float_type.size), layout.float_type.size
    same = bits == layout.float_type.bits
    if same:
        _copy_columns(w, layout, (source, column), (target, pitch), (row, count, m))
    last = b.sub(m, number(1))
    with w.loop(m, W) as i:
        # Beyond the last state the last one is repeated: whole vectors need no code of their own for the rest, and a
        # state that is there raises no NaN that is not its own.
        rows = [w.offset(source, b.mul(w.least(b.add(i, number(k)), last), row)) for k in range(W)]
        to = w.offset(target, _bytes(b, layout, i))
        squares = _squares(b, layout, column, count) if same else number(0)
        with w.loop(squares, W) as j:
            at = _bytes(b, layout, j)
            for k, x in enumerate(_transposed(b, [w.load(_vector(layout), w.offset(x, at), size) for x in rows])):
                w.store(x, w.offset(to, b.mul(b.add(j, number(k)), pitch)), size)
        with w.loop(count, 1, squares) as j:
            at = b.mul(j, column)
            value: ir.Value = ir.Constant(_vector(layout), ir.Undefined)
            for k, x in enumerate(rows):
                item = _converted(b, layout, w.load(SCALAR[bits], w.offset(x, at), 1))
                value = b.insert_element(value, item, ir.Constant(I32, k))
            w.store(value, w.offset(to, b.mul(j, pitch)), size)
    b.ret_void()
    return routine


def unpack(module: ir.Module, layout: Layout) -> ir.Function:
    """Scatter m states from columns into an array."""
    routine, w = function(module, "unpack", ir.VoidType(), [PTR, I64, I64, I64, PTR, I64])
    target, row, column, count, source, m = routine.args
    b, W, pitch, size = w.builder, layout.lanes, number(layout.pitch * layout.float_type.size), layout.float_type.size
    _copy_columns(w, layout, (source, pitch), (target, column), (row, count, m))
    full = b.and_(m, number(-W))  # the array has no room for repeated states: what fills no vector goes one by one
    squares = _squares(b, layout, column, count)
    with w.loop(full, W) as i:
        rows = [w.offset(target, b.mul(b.add(i, number(k)), row)) for k in range(W)]
        origin = w.offset(source, _bytes(b, layout, i))
        with w.loop(squares, W) as j:
            columns = [w.offset(origin, b.mul(b.add(j, number(k)), pitch)) for k in range(W)]
            at = _bytes(b, layout, j)
            for y, x in zip(rows, _transposed(b, [w.load(_vector(layout), x, size) for x in columns]), strict=True):
                w.store(x, w.offset(y, at), size)
        with w.loop(count, 1, squares) as j:
            at = b.mul(j, column)
            value = w.load(_vector(layout), w.offset(origin, b.mul(j, pitch)), size)
            for k, y in enumerate(rows):
                w.store(b.extract_element(value, ir.Constant(I32, k)), w.offset(y, at), 1)
    with w.loop(m, 1, full) as i:
        to, origin = w.offset(target, b.mul(i, row)), w.offset(source, _bytes(b, layout, i))
        with w.loop(count) as j:
            w.store(w.load(_scalar(layout), w.offset(origin, b.mul(j, pitch))), w.offset(to, b.mul(j, column)), 1)
    b.ret_void()
    return routine


def _scalar(layout: Layout) -> ir.Type:
    """The type of the numbers in columns."""
    return SCALAR[layout.float_type.bits]


def _vector(layout: Layout) -> ir.Type:
    """As many of them as the processor computes at once."""
    return ir.VectorType(_scalar(layout), layout.lanes)


def _bytes(b: ir.IRBuilder, layout: Layout, count: ir.Value) -> ir.Value:
    """How many bytes so many of them take."""
    return b.shl(count, number(layout.float_type.size.bit_length() - 1))


def _converted(b: ir.IRBuilder, layout: Layout, x: ir.Value) -> ir.Value:
    """A number of an array as one of the columns."""
    if x.type is _scalar(layout):
        return x
    return b.fptrunc(x, F32) if x.type is F64 else b.fpext(x, F64)


def _copy_columns(
    w: Writer,
    layout: Layout,
    source: tuple[ir.Value, ir.Value],
    target: tuple[ir.Value, ir.Value],
    sizes: tuple[ir.Value, ir.Value, ir.Value],
) -> None:
    """Where the array itself lies in columns, and m fills vectors: copy them, and return from the function."""
    b, (row, count, m), size = w.builder, sizes, layout.float_type.size
    fills = b.icmp_signed("==", b.and_(m, number(layout.lanes - 1)), number(0))
    with b.if_then(b.and_(b.icmp_signed("==", row, number(size)), fills)):
        with w.loop(count) as j:
            x, y = (w.offset(base, b.mul(j, distance)) for base, distance in (source, target))
            with w.loop(m, layout.lanes) as i:
                at = _bytes(b, layout, i)
                w.store(w.load(_vector(layout), w.offset(x, at), size), w.offset(y, at), size)
        b.ret_void()


def _squares(b: ir.IRBuilder, layout: Layout, column: ir.Value, count: ir.Value) -> ir.Value:
    """Columns that are moved in squares of LANES by LANES: those that lie side by side in memory."""
    adjacent = b.icmp_signed("==", column, number(layout.float_type.size))
    return b.select(adjacent, b.and_(count, number(-layout.lanes)), number(0))


def _transposed(b: ir.IRBuilder, rows: list[ir.Value]) -> list[ir.Value]:
    """The columns of a square whose rows are vectors: halves exchanged, then quarters, and so on."""
    W = len(rows)
    step = W // 2
    while step:
        for i in (i for i in range(W) if not i & step):
            x, y = rows[i], rows[i + step]
            low = [k if not k & step else W + k - step for k in range(W)]
            high = [k + step if not k & step else W + k for k in range(W)]
            rows[i], rows[i + step] = (
                b.shuffle_vector(x, y, ir.Constant(ir.VectorType(I32, W), mask)) for mask in (low, high)
            )
        step //= 2
    return rows


def unsound(module: ir.Module, layout: Layout) -> ir.Function:
    """Whether m states have a number that is not finite: 0 x is 0 but for those, where it is NaN."""
    routine, w = function(module, "unsound", I1, [PTR, I64, I64])
    source, count, m = routine.args
    b, W, size = w.builder, layout.lanes, layout.float_type.size
    zero = ir.Constant(_vector(layout), [0.0] * W)
    integers = ir.VectorType(ir.IntType(layout.float_type.bits), W)
    unsound_lanes = w.memory(integers)
    w.store(ir.Constant(integers, [0] * W), unsound_lanes)
    with w.loop(count) as j:
        column = w.offset(source, b.mul(j, number(layout.pitch * size)))
        with w.loop(m, W) as i:
            product = b.fmul(w.load(_vector(layout), w.offset(column, _bytes(b, layout, i)), size), zero)
            bad = b.sext(b.fcmp_unordered("uno", product, zero), integers)
            w.store(b.or_(w.load(integers, unsound_lanes), bad), unsound_lanes)
    # Looked at once, behind the loops: a branch in each would cost more than the products.
    none = b.icmp_signed("==", w.load(integers, unsound_lanes), ir.Constant(integers, [0] * W))
    b.ret(b.icmp_unsigned("!=", b.bitcast(none, ir.IntType(W)), ir.Constant(ir.IntType(W), -1)))
    return routine
