"""The compiled code around a program: blocks of states in and out, and the call from Python for a single state.

    int64 run(int64 *arrays, int64 start, int64 stop)    1 where a result is not finite, -1 without memory
    PyObject *one(PyObject *self, PyObject *const *args, Py_ssize_t count)    up to MOST states, called by CPython
    PyObject *call(PyObject *self, PyObject *args, PyObject *named)    the same as f(q, v, a, out=out)

`arrays` has `RECORD` numbers for each input, then each output: address, distance in bytes from state to state and from
column to column, count of columns, 1 for float32. States are gathered into columns, so that whatever the layout, every
state goes through the same instructions: its bits do not depend on its neighbours, on the block or on the thread.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import combinations, groupby, product

from llvmlite import ir

from rttrr_pin.kernel.emit.layout import ALIGNED, C_CONTIGUOUS, NDARRAY, TUPLE, WRITEABLE
from rttrr_pin.kernel.emit.llvm_columns import (
    F32,
    F64,
    I1,
    I32,
    I64,
    LINE,
    PTR,
    Writer,
    function,
    number,
    pack,
    unpack,
    unsound,
    untyped,
)
from rttrr_pin.kernel.emit.llvm_vectors import Layout
from rttrr_pin.kernel.program import Field, Program
from rttrr_pin.kernel.schedule import Schedule

RECORD = 5
"""Numbers that describe an array."""

MOST = 4096
"""States that `one` computes in one call; more are worth threads, and must not hold up Ctrl-C."""

STACK = 128 * 1024
"""Bytes of a block that may lie on the stack, of which threads have little; larger ones are allocated."""

CONTEXT = ("ndarray", "float64", "none", "true", "out", "general")
"""Python objects whose addresses are set after loading."""


def driver(program: Program | Schedule, layout: Layout, between: int) -> str:
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
        fill=ir.Function(module, ir.FunctionType(ir.VoidType(), [PTR, I64]), "fill"),
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
        fill: writes the outputs that no state changes.
        pack: gathers states into columns, by the kind of number that the array has.
        unpack: the reverse.
        unsound: tells whether there is NaN or infinity in columns.
    """

    program: Program | Schedule
    layout: Layout
    between: int
    body: ir.Function
    fill: ir.Function
    pack: dict[ir.Type, ir.Function]
    unpack: ir.Function
    unsound: ir.Function

    @contextmanager
    def scratch(self, w: Writer, without: ir.Block) -> Iterator[list[ir.Value]]:
        """Memory for columns: of the inputs, the outputs, and what is passed between parts, one behind the other."""
        widths = (self.program.width_in, self.program.width_out, self.between)
        sizes = [width * self.layout.pitch * 8 for width in widths]
        total = max(sum(sizes), 8)
        held = None
        if total <= STACK:
            base = w.memory(F64, total // 8)
        else:
            held = w.builder.call(_library(w, "malloc", PTR, [I64]), [number(total + LINE)])
            _require(w.builder, w.builder.icmp_unsigned("!=", held, ir.Constant(PTR, None)), without)
            base = w.aligned(held)
        yield [w.offset(base, sum(sizes[:k])) for k in range(3)]
        if held is not None:
            w.builder.call(_library(w, "free", ir.VoidType(), [PTR]), [held])

    def write(self, w: Writer, arrays: Sequence[Array], m: ir.Value, scratch: Sequence[ir.Value]) -> ir.Value:
        """Gather m states, run the body, scatter the results; returns whether a result is not finite."""
        b, (inputs, outputs, between) = w.builder, scratch
        count = len(self.program.inputs)
        for array, field, at in self._placed(w, arrays[:count], self.program.inputs, inputs):
            self._gather(w, array, [array.base, array.row, array.column, number(field.width), at, m])
        padded = self.padded(b, m)
        b.call(self.body, [inputs, outputs, between, padded])
        bad = b.call(self.unsound, [outputs, number(self.program.width_out), padded])
        for place, following in _runs(self.program.unread):
            column = w.offset(inputs, place * self.layout.pitch * 8)
            bad = b.or_(bad, b.call(self.unsound, [column, number(following), padded]))
        for array, field, at in self._placed(w, arrays[count:], self.program.outputs, outputs):
            b.call(self.unpack, [array.base, array.row, array.column, number(field.width), at, m])
        return bad

    def padded(self, b: ir.IRBuilder, m: ir.Value) -> ir.Value:
        """So many states that vectors are full."""
        return b.and_(b.add(m, number(self.layout.lanes - 1)), number(-self.layout.lanes))

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


def _runs(places: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Places one behind the other, as the first and their count."""
    for _, run in groupby(enumerate(places), lambda pair: pair[1] - pair[0]):
        together = [place for _, place in run]
        yield together[0], len(together)


def _library(w: Writer, name: str, result: ir.Type, arguments: Sequence[ir.Type]) -> ir.Function:
    """A function of the C library."""
    module = w.builder.module
    return module.globals.get(name) or ir.Function(module, ir.FunctionType(result, arguments), name)


def _run(module: ir.Module, block: _Block) -> None:
    """The function int64 run(int64 *arrays, int64 start, int64 stop)."""
    _, w = function(module, "run", I64, [PTR, I64, I64], internal=False)
    records, start, stop = w.builder.function.args
    fields = block.program.inputs + block.program.outputs
    described = [
        [w.load(I64, w.offset(records, 8 * (RECORD * k + entry))) for entry in (0, 1, 2, 4)] for k in range(len(fields))
    ]
    arrays = [Array(w.builder.inttoptr(base, PTR), *rest) for base, *rest in described]
    without = w.builder.append_basic_block("without_memory")
    w.builder.ret(_blocks(w, block, arrays, (start, stop), without))
    w.builder.position_at_end(without)
    w.builder.ret(number(-1))


def _blocks(
    w: Writer, block: _Block, arrays: Sequence[Array], between: tuple[ir.Value, ir.Value], without: ir.Block
) -> ir.Value:
    """Compute the states between two, block by block; not 0 where a result is not finite."""
    b, (start, stop) = w.builder, between
    bad = w.memory(I64)
    w.store(number(0), bad)
    with block.scratch(w, without) as scratch:
        b.call(block.fill, [scratch[1], block.padded(b, w.least(number(block.layout.block), b.sub(stop, start)))])
        with w.loop(stop, block.layout.block, start) as first:
            m = w.least(number(block.layout.block), b.sub(stop, first))
            here = [replace(array, base=w.offset(array.base, b.mul(first, array.row))) for array in arrays]
            w.store(b.or_(w.load(I64, bad), b.zext(block.write(w, here, m, scratch), I64)), bad)
    return w.load(I64, bad)


def _one(module: ir.Module, block: _Block) -> None:
    """The function one: computes a state or a small batch and returns True, or declines and returns None."""
    context = ir.GlobalVariable(module, ir.ArrayType(PTR, len(CONTEXT)), "context")
    context.initializer = ir.Constant(context.value_type, None)
    untyped(context)
    _set_context(module, context)
    incref = ir.Function(module, ir.FunctionType(ir.VoidType(), [PTR]), "Py_IncRef")
    made, w = function(module, "one", PTR, [PTR, PTR, I64], internal=False)
    b = w.builder
    _, args, count = b.function.args
    kinds = [w.load(PTR, w.offset(context, 8 * k)) for k in range(2)]
    none, true = (w.load(PTR, w.offset(context, 8 * k)) for k in (2, 3))
    refuse = b.append_basic_block("refuse")
    fields = block.program.inputs + block.program.outputs
    _require(b, b.icmp_signed("==", count, number(len(fields))), refuse)
    items = [w.load(PTR, w.offset(args, 8 * k)) for k in range(len(fields))]
    batched, m = number(0), number(1)
    arrays = []
    for k, (item, field) in enumerate(zip(items, fields, strict=True)):
        _require_float64(w, item, kinds, refuse)
        if k == 0:
            batched, m = _batch(w, item, field, refuse)
        arrays.append(_understood(w, item, field, (batched, m, k >= len(block.program.inputs)), refuse))
    _require_apart(w, block, arrays, m, refuse)
    _require(b, b.icmp_signed("==", _blocks(w, block, arrays, (number(0), m), refuse), number(0)), refuse)
    b.call(incref, [true])
    b.ret(true)
    b.position_at_end(refuse)
    b.call(incref, [none])
    b.ret(none)
    _call(module, block, context, (made, incref))


def _call(module: ir.Module, block: _Block, context: ir.GlobalVariable, known: tuple[ir.Function, ir.Function]) -> None:
    """The function call: f(q, v, a, out=out) by `one`, everything else by the general Python function."""
    one, incref = known
    find, size, general_call, decref = (
        ir.Function(module, ir.FunctionType(result, arguments), name)
        for name, result, arguments in (
            ("PyDict_GetItem", PTR, [PTR, PTR]),
            ("PyDict_Size", I64, [PTR]),
            ("PyObject_Call", PTR, [PTR, PTR, PTR]),
            ("Py_DecRef", ir.VoidType(), [PTR]),
        )
    )
    _, w = function(module, "call", PTR, [PTR, PTR, PTR], internal=False)
    b, count = w.builder, len(block.program.inputs)
    _, args, named = b.function.args
    true, key, general = (
        w.load(PTR, w.offset(context, 8 * CONTEXT.index(name))) for name in ("true", "out", "general")
    )
    otherwise = b.append_basic_block("general")
    _require(b, b.icmp_signed("!=", b.ptrtoint(named, I64), number(0)), otherwise)
    _require(b, b.icmp_signed("==", w.load(I64, w.offset(args, TUPLE["size"])), number(count)), otherwise)
    _require(b, b.icmp_signed("==", b.call(size, [named]), number(1)), otherwise)
    out = b.call(find, [named, key])
    _require(b, b.icmp_signed("!=", b.ptrtoint(out, I64), number(0)), otherwise)
    vector = w.memory(PTR, count + 1)
    for k in range(count):
        w.store(w.load(PTR, w.offset(args, TUPLE["items"] + 8 * k)), w.offset(vector, 8 * k))
    w.store(out, w.offset(vector, 8 * count))
    answer = b.call(one, [ir.Constant(PTR, None), vector, number(count + 1)])
    b.call(decref, [answer])
    _require(b, b.icmp_unsigned("==", answer, true), otherwise)
    b.call(incref, [out])
    b.ret(out)
    b.position_at_end(otherwise)
    b.ret(b.call(general_call, [general, args, named]))


def _require_float64(w: Writer, item: ir.Value, kinds: Sequence[ir.Value], refuse: ir.Block) -> None:
    """An array, and of float64."""
    for key, kind in zip(("type", "descr"), kinds, strict=True):
        _require(w.builder, w.builder.icmp_unsigned("==", w.load(PTR, w.offset(item, NDARRAY[key])), kind), refuse)


def _batch(w: Writer, item: ir.Value, field: Field, refuse: ir.Block) -> tuple[ir.Value, ir.Value]:
    """Whether the first array has one axis more than a state, 0 or 1, and how many states there are."""
    b = w.builder
    axes = b.sub(w.load(I32, w.offset(item, NDARRAY["ndim"])), ir.Constant(I32, len(field.shape)))
    _require(b, b.icmp_unsigned("<=", axes, ir.Constant(I32, 1)), refuse)
    batched = b.zext(axes, I64)
    several = b.icmp_signed("==", batched, number(1))
    m = b.select(several, w.load(I64, w.load(PTR, w.offset(item, NDARRAY["shape"]))), number(1))
    _require(b, b.and_(b.icmp_signed(">=", m, number(1)), b.icmp_signed("<=", m, number(MOST))), refuse)
    return batched, m


def _understood(
    w: Writer, item: ir.Value, field: Field, of: tuple[ir.Value, ir.Value, bool], refuse: ir.Block
) -> Array:
    """One array, if it has the axes and the flags that it must have."""
    b, (batched, m, output) = w.builder, of
    several = b.icmp_signed("==", batched, number(1))
    axes = b.add(batched, number(len(field.shape)))
    ndim = b.sext(w.load(I32, w.offset(item, NDARRAY["ndim"])), I64)
    _require(b, b.icmp_signed("==", ndim, axes), refuse)
    shape, strides = (w.load(PTR, w.offset(item, NDARRAY[key])) for key in ("shape", "strides"))
    _require(b, b.icmp_signed("==", b.select(several, w.load(I64, shape), m), m), refuse)
    skipped = b.shl(batched, number(3))
    for axis, length in enumerate(field.shape):
        found = w.load(I64, w.offset(w.offset(shape, skipped), 8 * axis))
        _require(b, b.icmp_signed("==", found, number(length)), refuse)
    dense = ir.Constant(I32, ALIGNED | C_CONTIGUOUS | (WRITEABLE if output else 0))
    wanted = dense if output else b.select(several, dense, ir.Constant(I32, ALIGNED))
    has = b.and_(w.load(I32, w.offset(item, NDARRAY["flags"])), wanted)
    _require(b, b.icmp_signed("==", has, wanted), refuse)
    column = number(8) if output else w.load(I64, w.offset(strides, skipped))
    return Array(w.load(PTR, w.offset(item, NDARRAY["data"])), number(8 * field.width), column)


def _require_apart(w: Writer, block: _Block, arrays: Sequence[Array], m: ir.Value, refuse: ir.Block) -> None:
    """Outputs lie apart, and none over an input that a later block reads; within one block all is read before."""
    b, count = w.builder, len(block.program.inputs)
    ends = [b.ptrtoint(w.offset(array.base, b.mul(m, array.row)), I64) for array in arrays]
    starts = [b.ptrtoint(array.base, I64) for array in arrays]

    def apart(pairs: Iterable[tuple[int, int]]) -> ir.Value:
        clear: ir.Value = ir.Constant(I1, 1)
        for k, i in pairs:
            before, behind = (b.icmp_unsigned("<=", *pair) for pair in ((ends[k], starts[i]), (ends[i], starts[k])))
            clear = b.and_(clear, b.or_(before, behind))
        return clear

    outputs = range(count, len(arrays))
    _require(b, apart(combinations(outputs, 2)), refuse)
    in_one_block = b.icmp_signed("<=", m, number(block.layout.block))
    _require(b, b.or_(in_one_block, apart(product(range(count), outputs))), refuse)


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
