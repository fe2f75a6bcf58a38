"""Compiled code that CPython calls, for one state or few: arrays in, without a detour through ctypes.

    PyObject *one(PyObject *self, PyObject *const *args, Py_ssize_t count)    the last output, or None: declined
    void set_context(int64 place, PyObject *object)    what it must know, see `CONTEXT`

Only functions of CPython's stable C API are called (`FUNCTIONS`): arrays are read through the buffer protocol, whose
`Py_buffer` has a documented layout. `fastcall` makes a Python function of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from llvmlite import ir

from rttrr_pin.compile.emit import FEW
from rttrr_pin.compile.emit.llvm_block import Array, Block, compute
from rttrr_pin.compile.emit.llvm_columns import I1, I32, I64, PTR, Writer, function, number, untyped
from rttrr_pin.compile.program import Field

CONTEXT = ("ndarray", "none")
"""Python objects whose addresses are set after loading."""

VOID = ir.VoidType()

FUNCTIONS: dict[str, tuple[ir.Type, list[ir.Type]]] = {
    "PyObject_Type": (PTR, [PTR]),
    "PyObject_GetBuffer": (I32, [PTR, PTR, I32]),
    "PyBuffer_Release": (VOID, [PTR]),
    "PyErr_Clear": (VOID, []),
    "Py_IncRef": (VOID, [PTR]),
    "Py_DecRef": (VOID, [PTR]),
}
"""Functions of the stable C API that compiled code calls."""

VIEW = {"data": 0, "object": 8, "ndim": 36, "format": 40, "shape": 48, "strides": 56}
"""Offsets of a Py_buffer on machines of 64 bits."""

VIEW_SIZE = 80

READ, WRITE = 0x1C, 0x3D
"""What is asked of an input, PyBUF_RECORDS_RO; of an output, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE | PyBUF_FORMAT."""

FLOAT64 = int.from_bytes(b"d\0", "little")
"""The format of native, aligned float64: all else begins with another character, or with one more."""


@dataclass
class _One:
    """Writes the function `one`.

    Attributes:
        w: writes it.
        block: the program.
        api: the functions of the C API.
        decline: where it goes if it does not take what it was given.
    """

    w: Writer
    block: Block
    api: dict[str, ir.Function]
    decline: ir.Block

    def write(self, ndarray: ir.Value, none: ir.Value) -> None:
        """Compute a state or a small batch and return the last output, or release all and return None."""
        w, b = self.w, self.w.builder
        fields = self.block.program.inputs + self.block.program.outputs
        _, args, count = b.function.args
        answer = w.memory(PTR)
        w.store(none, answer)
        views = w.memory(I64, VIEW_SIZE // 8 * len(fields))
        at = [w.offset(views, VIEW_SIZE * k) for k in range(len(fields))]
        for view in at:  # to release what was never filled does nothing
            w.store(ir.Constant(PTR, None), w.offset(view, VIEW["object"]))
        w.require(b.icmp_signed("==", count, number(len(fields))), self.decline)
        items = [w.load(PTR, w.offset(args, 8 * k)) for k in range(len(fields))]
        batched, m = number(0), number(1)
        arrays = []
        for k, (item, view, field) in enumerate(zip(items, at, fields, strict=True)):
            output = k >= len(self.block.program.inputs)
            self._fill(item, view, ndarray, WRITE if output else READ)
            if k == 0:
                batched, m = self._batch(view, field)
            arrays.append(self._array(view, field, batched, m, output))
        self._require_apart(arrays, m)
        finite = b.icmp_signed("==", compute(w, self.block, arrays, (number(0), m), self.decline), number(0))
        w.require(finite, self.decline)
        w.store(items[-1], answer)
        b.branch(self.decline)
        b.position_at_end(self.decline)
        for view in at:
            b.call(self.api["PyBuffer_Release"], [view])
        b.call(self.api["Py_IncRef"], [w.load(PTR, answer)])
        b.ret(w.load(PTR, answer))

    def _fill(self, item: ir.Value, view: ir.Value, ndarray: ir.Value, flags: int) -> None:
        """The buffer of an array of float64; of a subclass, masked arrays among them, Python code decides."""
        w, b = self.w, self.w.builder
        kind = b.call(self.api["PyObject_Type"], [item])
        b.call(self.api["Py_DecRef"], [kind])
        w.require(b.icmp_unsigned("==", kind, ndarray), self.decline)
        filled = b.call(self.api["PyObject_GetBuffer"], [item, view, ir.Constant(I32, flags)])
        with b.if_then(b.icmp_signed("!=", filled, ir.Constant(I32, 0)), likely=False):
            b.call(self.api["PyErr_Clear"], [])
            b.branch(self.decline)
        form = w.load(ir.IntType(16), w.load(PTR, w.offset(view, VIEW["format"])), 1)
        w.require(b.icmp_unsigned("==", form, ir.Constant(ir.IntType(16), FLOAT64)), self.decline)

    def _batch(self, view: ir.Value, field: Field) -> tuple[ir.Value, ir.Value]:
        """Whether the first array has one axis more than a state, 0 or 1, and how many states there are."""
        w, b = self.w, self.w.builder
        axes = b.sub(w.load(I32, w.offset(view, VIEW["ndim"])), ir.Constant(I32, len(field.shape)))
        w.require(b.icmp_unsigned("<=", axes, ir.Constant(I32, 1)), self.decline)
        batched = b.zext(axes, I64)
        several = b.icmp_signed("==", batched, number(1))
        m = b.select(several, w.load(I64, w.load(PTR, w.offset(view, VIEW["shape"]))), number(1))
        w.require(b.and_(b.icmp_signed(">=", m, number(1)), b.icmp_signed("<=", m, number(FEW))), self.decline)
        return batched, m

    def _array(self, view: ir.Value, field: Field, batched: ir.Value, m: ir.Value, output: bool) -> Array:
        """One array, if it has the axes that it must have; several states lie in rows."""
        w, b = self.w, self.w.builder
        several = b.icmp_signed("==", batched, number(1))
        ndim = b.sext(w.load(I32, w.offset(view, VIEW["ndim"])), I64)
        w.require(b.icmp_signed("==", ndim, b.add(batched, number(len(field.shape)))), self.decline)
        shape, strides = (w.load(PTR, w.offset(view, VIEW[key])) for key in ("shape", "strides"))
        w.require(b.icmp_signed("==", b.select(several, w.load(I64, shape), m), m), self.decline)
        first = b.shl(batched, number(3))  # of the axes of a state, in bytes
        for axis, length in enumerate(field.shape):
            found = w.load(I64, w.offset(w.offset(shape, first), 8 * axis))
            w.require(b.icmp_signed("==", found, number(length)), self.decline)
        data, row = w.load(PTR, w.offset(view, VIEW["data"])), number(8 * field.width)
        if output:
            return Array(data, row, number(8))
        column = w.load(I64, w.offset(strides, first))
        in_rows = b.and_(
            b.icmp_signed("==", column, number(8)),
            b.icmp_signed("==", b.select(several, w.load(I64, strides), row), row),
        )
        w.require(b.or_(in_rows, b.not_(several)), self.decline)
        return Array(data, row, column)

    def _require_apart(self, arrays: Sequence[Array], m: ir.Value) -> None:
        """Outputs lie apart, and none over an input that a later block reads; within one block all is read before."""
        w, b, count = self.w, self.w.builder, len(self.block.program.inputs)
        ends = [b.ptrtoint(w.offset(array.base, b.mul(m, array.row)), I64) for array in arrays]
        starts = [b.ptrtoint(array.base, I64) for array in arrays]

        def apart(pairs: Iterable[tuple[int, int]]) -> ir.Value:
            clear: ir.Value = ir.Constant(I1, 1)
            for k, i in pairs:
                before, behind = (b.icmp_unsigned("<=", *pair) for pair in ((ends[k], starts[i]), (ends[i], starts[k])))
                clear = b.and_(clear, b.or_(before, behind))
            return clear

        outputs = range(count, len(arrays))
        w.require(apart(combinations(outputs, 2)), self.decline)
        in_one_block = b.icmp_signed("<=", m, number(self.block.layout.block))
        w.require(b.or_(in_one_block, apart(product(range(count), outputs))), self.decline)


def python_entry(module: ir.Module, block: Block) -> None:
    """The functions `set_context` and `one` of a program whose blocks are computed so."""
    context = ir.GlobalVariable(module, ir.ArrayType(PTR, len(CONTEXT)), "context")
    context.initializer = ir.Constant(context.value_type, None)
    untyped(context)
    _, w = function(module, "set_context", VOID, [I64, PTR], internal=False)
    place, item = w.builder.function.args
    w.store(item, w.offset(context, w.builder.mul(place, number(8))))
    w.builder.ret_void()
    api = {name: ir.Function(module, ir.FunctionType(*kind), name) for name, kind in FUNCTIONS.items()}
    made, w = function(module, "one", PTR, [PTR, PTR, I64], internal=False)
    objects = [w.load(PTR, w.offset(context, 8 * k)) for k in range(len(CONTEXT))]
    _One(w, block, api, made.append_basic_block("finish")).write(*objects)
