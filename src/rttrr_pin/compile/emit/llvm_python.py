"""Compiled code that CPython calls, and that reads NumPy's arrays where they lie: one state or few, without a detour.

    PyObject *one(PyObject *self, PyObject *const *args, Py_ssize_t count)    up to MOST states, called by CPython
    PyObject *call(PyObject *self, PyObject *args, PyObject *named)    the same as f(q, v, a, out=out)
    void set_context(int64 place, PyObject *object)    what both must know, see `CONTEXT`

`fastcall` makes Python functions of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations, product

from llvmlite import ir

from rttrr_pin.compile.emit.layout import ALIGNED, C_CONTIGUOUS, NDARRAY, TUPLE, WRITEABLE
from rttrr_pin.compile.emit.llvm_block import Array, Block, compute
from rttrr_pin.compile.emit.llvm_columns import I1, I32, I64, PTR, Writer, function, number, untyped
from rttrr_pin.compile.program import Field

MOST = 4096
"""States that `one` computes in one call; more are worth threads, and must not hold up Ctrl-C."""

CONTEXT = ("ndarray", "float64", "none", "true", "out", "general")
"""Python objects whose addresses are set after loading."""


def python_entries(module: ir.Module, block: Block) -> None:
    """The functions set_context, one and call, of a program whose blocks are computed so."""
    context = ir.GlobalVariable(module, ir.ArrayType(PTR, len(CONTEXT)), "context")
    context.initializer = ir.Constant(context.value_type, None)
    untyped(context)
    _set_context(module, context)
    incref = ir.Function(module, ir.FunctionType(ir.VoidType(), [PTR]), "Py_IncRef")
    one = _one(module, block, context, incref)
    _call(module, block, context, (one, incref))


def _one(module: ir.Module, block: Block, context: ir.GlobalVariable, incref: ir.Function) -> ir.Function:
    """The function one: computes a state or a small batch and returns True, or declines and returns None."""
    made, w = function(module, "one", PTR, [PTR, PTR, I64], internal=False)
    b = w.builder
    _, args, count = b.function.args
    kinds = [w.load(PTR, w.offset(context, 8 * k)) for k in range(2)]
    none, true = (w.load(PTR, w.offset(context, 8 * k)) for k in (2, 3))
    refuse = b.append_basic_block("refuse")
    fields = block.program.inputs + block.program.outputs
    w.require(b.icmp_signed("==", count, number(len(fields))), refuse)
    items = [w.load(PTR, w.offset(args, 8 * k)) for k in range(len(fields))]
    batched, m = number(0), number(1)
    arrays = []
    for k, (item, field) in enumerate(zip(items, fields, strict=True)):
        _require_float64(w, item, kinds, refuse)
        if k == 0:
            batched, m = _batch(w, item, field, refuse)
        arrays.append(_understood(w, item, field, (batched, m, k >= len(block.program.inputs)), refuse))
    _require_apart(w, block, arrays, m, refuse)
    w.require(b.icmp_signed("==", compute(w, block, arrays, (number(0), m), refuse), number(0)), refuse)
    b.call(incref, [true])
    b.ret(true)
    b.position_at_end(refuse)
    b.call(incref, [none])
    b.ret(none)
    return made


def _call(
    module: ir.Module, block: Block, context: ir.GlobalVariable, constants: tuple[ir.Function, ir.Function]
) -> None:
    """The function call: f(q, v, a, out=out) by `one`, everything else by the general Python function."""
    one, incref = constants
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
    w.require(b.icmp_signed("!=", b.ptrtoint(named, I64), number(0)), otherwise)
    w.require(b.icmp_signed("==", w.load(I64, w.offset(args, TUPLE["size"])), number(count)), otherwise)
    w.require(b.icmp_signed("==", b.call(size, [named]), number(1)), otherwise)
    out = b.call(find, [named, key])
    w.require(b.icmp_signed("!=", b.ptrtoint(out, I64), number(0)), otherwise)
    vector = w.memory(PTR, count + 1)
    for k in range(count):
        w.store(w.load(PTR, w.offset(args, TUPLE["items"] + 8 * k)), w.offset(vector, 8 * k))
    w.store(out, w.offset(vector, 8 * count))
    answer = b.call(one, [ir.Constant(PTR, None), vector, number(count + 1)])
    b.call(decref, [answer])
    w.require(b.icmp_unsigned("==", answer, true), otherwise)
    b.call(incref, [out])
    b.ret(out)
    b.position_at_end(otherwise)
    b.ret(b.call(general_call, [general, args, named]))


def _require_float64(w: Writer, item: ir.Value, kinds: Sequence[ir.Value], refuse: ir.Block) -> None:
    """An array, and of float64."""
    for key, kind in zip(("type", "descr"), kinds, strict=True):
        w.require(w.builder.icmp_unsigned("==", w.load(PTR, w.offset(item, NDARRAY[key])), kind), refuse)


def _batch(w: Writer, item: ir.Value, field: Field, refuse: ir.Block) -> tuple[ir.Value, ir.Value]:
    """Whether the first array has one axis more than a state, 0 or 1, and how many states there are."""
    b = w.builder
    axes = b.sub(w.load(I32, w.offset(item, NDARRAY["ndim"])), ir.Constant(I32, len(field.shape)))
    w.require(b.icmp_unsigned("<=", axes, ir.Constant(I32, 1)), refuse)
    batched = b.zext(axes, I64)
    several = b.icmp_signed("==", batched, number(1))
    m = b.select(several, w.load(I64, w.load(PTR, w.offset(item, NDARRAY["shape"]))), number(1))
    w.require(b.and_(b.icmp_signed(">=", m, number(1)), b.icmp_signed("<=", m, number(MOST))), refuse)
    return batched, m


def _understood(
    w: Writer, item: ir.Value, field: Field, of: tuple[ir.Value, ir.Value, bool], refuse: ir.Block
) -> Array:
    """One array, if it has the axes and the flags that it must have."""
    b, (batched, m, output) = w.builder, of
    several = b.icmp_signed("==", batched, number(1))
    axes = b.add(batched, number(len(field.shape)))
    ndim = b.sext(w.load(I32, w.offset(item, NDARRAY["ndim"])), I64)
    w.require(b.icmp_signed("==", ndim, axes), refuse)
    shape, strides = (w.load(PTR, w.offset(item, NDARRAY[key])) for key in ("shape", "strides"))
    w.require(b.icmp_signed("==", b.select(several, w.load(I64, shape), m), m), refuse)
    skipped = b.shl(batched, number(3))
    for axis, length in enumerate(field.shape):
        found = w.load(I64, w.offset(w.offset(shape, skipped), 8 * axis))
        w.require(b.icmp_signed("==", found, number(length)), refuse)
    dense = ir.Constant(I32, ALIGNED | C_CONTIGUOUS | (WRITEABLE if output else 0))
    wanted = dense if output else b.select(several, dense, ir.Constant(I32, ALIGNED))
    has = b.and_(w.load(I32, w.offset(item, NDARRAY["flags"])), wanted)
    w.require(b.icmp_signed("==", has, wanted), refuse)
    column = number(8) if output else w.load(I64, w.offset(strides, skipped))
    return Array(w.load(PTR, w.offset(item, NDARRAY["data"])), number(8 * field.width), column)


def _require_apart(w: Writer, block: Block, arrays: Sequence[Array], m: ir.Value, refuse: ir.Block) -> None:
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
    w.require(apart(combinations(outputs, 2)), refuse)
    in_one_block = b.icmp_signed("<=", m, number(block.layout.block))
    w.require(b.or_(in_one_block, apart(product(range(count), outputs))), refuse)


def _set_context(module: ir.Module, context: ir.GlobalVariable) -> None:
    """The function void set_context(int64 place, void *object)."""
    _, w = function(module, "set_context", ir.VoidType(), [I64, PTR], internal=False)
    place, item = w.builder.function.args
    w.store(item, w.offset(context, w.builder.mul(place, number(8))))
    w.builder.ret_void()
