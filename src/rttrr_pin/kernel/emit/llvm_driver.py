"""The compiled code around a program: blocks of states in and out, and the call from Python for a single state.

    int64 run(int64 *arrays, int64 start, int64 stop)    some states of a batch; 1 where a result is not finite
    PyObject *one(PyObject *self, PyObject *const *args, Py_ssize_t count)    one state, called by CPython

`arrays` has `RECORD` numbers for each input, then each output: address, distance in bytes from state to state and from
column to column, count of columns, 1 for float32. States are gathered into columns, so that whatever the layout, every
state goes through the same instructions: its bits do not depend on its neighbours, on the block or on the thread.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from llvmlite import ir

from rttrr_pin.kernel.emit.layout import ALIGNED, C_CONTIGUOUS, NDARRAY, WRITEABLE
from rttrr_pin.kernel.emit.llvm_body import Layout
from rttrr_pin.kernel.emit.llvm_columns import (
    F32,
    F64,
    I32,
    I64,
    PTR,
    Writer,
    function,
    number,
    pack,
    unpack,
    unsound,
    untyped,
)
from rttrr_pin.kernel.expression import Op
from rttrr_pin.kernel.program import Field, Program

RECORD = 5
"""Numbers that describe an array."""

CONTEXT = ("ndarray", "float64", "none", "true")
"""Python objects whose addresses are set after loading."""


def driver(program: Program, layout: Layout, between: int) -> str:
    """The functions around the program's body, as LLVM assembly.

    Args:
        program: the program, for the widths of its arrays.
        layout: how blocks lie in memory.
        between: columns that its parts pass on.

    Returns:
        The text of a module that calls `body`.
    """
    module = ir.Module(name="driver")
    block = _Block(
        program=program,
        layout=layout,
        between=between,
        body=ir.Function(module, ir.FunctionType(ir.VoidType(), [PTR, PTR, PTR, I64]), "body"),
        pack={kind: pack(module, layout, kind) for kind in (F64, F32)},
        unpack=unpack(module, layout),
        unsound=unsound(module, layout),
    )
    _run(module, block)
    _one(module, block)
    return str(module)


@dataclass(frozen=True, slots=True)
class Array:
    """An array as compiled code sees it.

    Attributes:
        base: address of the first of the states.
        row: bytes from state to state.
        column: bytes from column to column.
        single: not 0 for float32; None where it cannot be.
    """

    base: ir.Value
    row: ir.Value
    column: ir.Value
    single: ir.Value | None = None


@dataclass(frozen=True)
class _Block:
    """Writes what is done with one block of states.

    Attributes:
        program: the program.
        layout: how the block lies in memory.
        between: columns that the program's parts pass on.
        body: the program.
        pack: gathers states into columns, by the kind of number that the array has.
        unpack: the reverse.
        unsound: tells whether there is NaN or infinity in columns.
    """

    program: Program
    layout: Layout
    between: int
    body: ir.Function
    pack: dict[ir.Type, ir.Function]
    unpack: ir.Function
    unsound: ir.Function

    def scratch(self, w: Writer) -> list[ir.Value]:
        """Memory for columns: of the inputs, the outputs, and what is passed between parts."""
        widths = (_columns(self.program.inputs), _columns(self.program.outputs), self.between)
        return [w.memory(F64, max(1, width) * self.layout.pitch) for width in widths]

    def write(self, w: Writer, arrays: Sequence[Array], m: ir.Value, scratch: Sequence[ir.Value]) -> ir.Value:
        """Gather m states, run the body, scatter the results; returns whether a result is not finite."""
        b, (inputs, outputs, between) = w.builder, scratch
        count = len(self.program.inputs)
        for array, field, at in self._placed(w, arrays[:count], self.program.inputs, inputs):
            self._gather(w, array, [array.base, array.row, array.column, number(field.width), at, m])
        padded = b.and_(b.add(m, number(self.layout.lanes - 1)), number(-self.layout.lanes))
        b.call(self.body, [inputs, outputs, between, padded])
        bad = b.call(self.unsound, [outputs, number(_columns(self.program.outputs)), padded])
        for place in _unread(self.program):
            column = w.offset(inputs, place * self.layout.pitch * 8)
            bad = b.or_(bad, b.call(self.unsound, [column, number(1), padded]))
        for array, field, at in self._placed(w, arrays[count:], self.program.outputs, outputs):
            b.call(self.unpack, [array.base, array.row, array.column, number(field.width), at, m])
        return bad

    def _gather(self, w: Writer, array: Array, arguments: list[ir.Value]) -> None:
        if array.single is None:
            w.builder.call(self.pack[F64], arguments)
            return
        with w.builder.if_else(w.builder.icmp_signed("!=", array.single, number(0))) as (single, double):
            with single:
                w.builder.call(self.pack[F32], arguments)
            with double:
                w.builder.call(self.pack[F64], arguments)

    def _placed(
        self, w: Writer, arrays: Sequence[Array], fields: Sequence[Field], base: ir.Value
    ) -> Iterator[tuple[Array, Field, ir.Value]]:
        """Each array with the address of its columns."""
        before = 0
        for array, field in zip(arrays, fields, strict=True):
            yield array, field, w.offset(base, before * self.layout.pitch * 8)
            before += field.width


def _columns(fields: Sequence[Field]) -> int:
    return sum(field.width for field in fields)


def _unread(program: Program) -> list[int]:
    """Places of inputs that no output depends on; what is not finite there would go unseen."""
    graph = program.graph
    read = {graph.args[x][0] for x in program.order if graph.op[x] is Op.INPUT}
    return [place for place in range(program.width_in) if place not in read]


def _run(module: ir.Module, block: _Block) -> None:
    """The function int64 run(int64 *arrays, int64 start, int64 stop)."""
    _, w = function(module, "run", I64, [PTR, I64, I64], internal=False)
    b = w.builder
    records, start, stop = b.function.args
    scratch = block.scratch(w)
    bad = w.memory(I64)
    w.store(number(0), bad)
    described = [
        [w.load(I64, w.offset(records, 8 * (RECORD * k + entry))) for entry in (0, 1, 2, 4)]
        for k in range(len(block.program.inputs + block.program.outputs))
    ]
    with w.loop(stop, block.layout.block, start) as first:
        m = w.least(number(block.layout.block), b.sub(stop, first))
        arrays = [
            Array(b.inttoptr(b.add(address, b.mul(first, row)), PTR), row, column, single)
            for address, row, column, single in described
        ]
        w.store(b.or_(w.load(I64, bad), b.zext(block.write(w, arrays, m, scratch), I64)), bad)
    b.ret(w.load(I64, bad))


def _one(module: ir.Module, block: _Block) -> None:
    """The function one: computes a state and returns True, or declines what it was given and returns None."""
    context = ir.GlobalVariable(module, ir.ArrayType(PTR, len(CONTEXT)), "context")
    context.initializer = ir.Constant(context.value_type, None)
    untyped(context)
    _set_context(module, context)
    incref = ir.Function(module, ir.FunctionType(ir.VoidType(), [PTR]), "Py_IncRef")
    _, w = function(module, "one", PTR, [PTR, PTR, I64], internal=False)
    b = w.builder
    _, args, count = b.function.args
    ndarray, float64, none, true = (w.load(PTR, w.offset(context, 8 * k)) for k in range(len(CONTEXT)))
    refuse = b.append_basic_block("refuse")
    fields = block.program.inputs + block.program.outputs
    _require(b, b.icmp_signed("==", count, number(len(fields))), refuse)
    arrays = []
    for k, field in enumerate(fields):
        item = w.load(PTR, w.offset(args, 8 * k))
        _require(b, b.icmp_unsigned("==", w.load(PTR, w.offset(item, NDARRAY["type"])), ndarray), refuse)
        _require(b, b.icmp_unsigned("==", w.load(PTR, w.offset(item, NDARRAY["descr"])), float64), refuse)
        output = k >= len(block.program.inputs)
        _require_shape(w, item, field, ALIGNED | (C_CONTIGUOUS | WRITEABLE if output else 0), refuse)
        column = number(8) if output else w.load(I64, w.load(PTR, w.offset(item, NDARRAY["strides"])))
        arrays.append(Array(w.load(PTR, w.offset(item, NDARRAY["data"])), number(0), column))
    _require(b, b.not_(block.write(w, arrays, number(1), block.scratch(w))), refuse)
    b.call(incref, [true])
    b.ret(true)
    b.position_at_end(refuse)
    b.call(incref, [none])
    b.ret(none)


def _require_shape(w: Writer, item: ir.Value, field: Field, flags: int, refuse: ir.Block) -> None:
    """One state's array: as many axes, each of its length, and the flags."""
    b = w.builder
    ndim = w.load(I32, w.offset(item, NDARRAY["ndim"]))
    _require(b, b.icmp_signed("==", ndim, ir.Constant(I32, len(field.shape))), refuse)
    shape = w.load(PTR, w.offset(item, NDARRAY["shape"]))
    for axis, length in enumerate(field.shape):
        _require(b, b.icmp_signed("==", w.load(I64, w.offset(shape, 8 * axis)), number(length)), refuse)
    wanted = ir.Constant(I32, flags)
    has = b.and_(w.load(I32, w.offset(item, NDARRAY["flags"])), wanted)
    _require(b, b.icmp_signed("==", has, wanted), refuse)


def _require(b: ir.IRBuilder, condition: ir.Value, otherwise: ir.Block) -> None:
    """Go on where the condition holds."""
    on = b.append_basic_block("on")
    b.cbranch(condition, on, otherwise)
    b.position_at_end(on)


def _set_context(module: ir.Module, context: ir.GlobalVariable) -> None:
    """The function void set_context(int64 place, void *object)."""
    _, w = function(module, "set_context", ir.VoidType(), [I64, PTR], internal=False)
    place, item = w.builder.function.args
    w.store(item, w.offset(context, w.builder.mul(place, number(8))))
    w.builder.ret_void()
