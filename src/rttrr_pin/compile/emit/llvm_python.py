"""Compiled code that CPython calls, for one state or few: arrays in, without a detour through ctypes.

    PyObject *one(PyObject *self, PyObject *const *args, Py_ssize_t count)

takes q, v, a, force and moment of each payload, then the outputs; None for what is not read, and for outputs that it
is to allocate. It returns the output, a tuple of several, or None: declined.

Only functions of the C APIs of CPython (the stable one) and NumPy are called (`FUNCTIONS`): arrays are read through the
buffer protocol, whose `Py_buffer` has a documented layout.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from llvmlite import ir

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit import FEW, FEW_NUMBERS, RECORD
from rttrr_pin.compile.emit.llvm_vectors import Layout
from rttrr_pin.compile.emit.llvm_writer import I1, I32, I64, PTR, Writer, function, number, untyped
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program

VOID = ir.VoidType()

FUNCTIONS: dict[str, ir.FunctionType] = {
    "PyObject_Type": ir.FunctionType(PTR, [PTR]),
    "PyObject_GetBuffer": ir.FunctionType(I32, [PTR, PTR, I32]),
    "PyBuffer_Release": ir.FunctionType(VOID, [PTR]),
    "PyErr_Clear": ir.FunctionType(VOID, []),
    "PyTuple_Pack": ir.FunctionType(PTR, [I64], var_arg=True),
    "Py_IncRef": ir.FunctionType(VOID, [PTR]),
    "Py_DecRef": ir.FunctionType(VOID, [PTR]),
    "PyArray_New": ir.FunctionType(PTR, [PTR, I32, PTR, I32, PTR, PTR, I32, I32, PTR]),
    "PyArray_GetPtr": ir.FunctionType(PTR, [PTR, PTR]),
}
"""Functions that compiled code calls."""

TYPE_NUMBER = {"float64": 12, "float32": 11}
"""NPY_DOUBLE and NPY_FLOAT."""

VIEW = {"data": 0, "object": 8, "ndim": 36, "format": 40, "shape": 48, "strides": 56}
"""Offsets of a Py_buffer on machines of 64 bits."""

VIEW_SIZE = 80

READ, WRITE = 0x1C, 0x1D
"""What is asked of an input, PyBUF_RECORDS_RO; of an output, PyBUF_RECORDS."""

FORMAT = {
    bits: ir.Constant(ir.IntType(16), int.from_bytes(code, "little")) for bits, code in ((64, b"d\0"), (32, b"f\0"))
}
"""The format of native, aligned numbers: all else begins with another character, or with one more."""

NULL = ir.Constant(PTR, None)

Array = tuple[ir.Value, ir.Value, ir.Value, ir.Value]
"""Address, distance in bytes from state to state and from column to column, 1 for float32: as in a record."""


@dataclass
class _One:
    """Writes the function `one`; where it does not take what was passed, it goes to `decline`."""

    w: Writer
    program: Program | CallProgram
    layout: Layout
    run: ir.Function
    api: dict[str, ir.Function]
    none: ir.Value
    ndarray: ir.Value
    decline: ir.Block

    @property
    def single(self) -> ir.Value:
        """What a record of an output has for its type."""
        return number(int(self.layout.float_type.bits == 32))

    @property
    def size(self) -> int:
        """Bytes of a number."""
        return self.layout.float_type.size

    def write(self) -> None:
        """Compute a state or a small batch and return the outputs, or release all and return None."""
        w, b = self.w, self.w.builder
        inputs, outputs = self.program.inputs, self.program.outputs
        answer = w.memory(PTR)
        w.store(self.none, answer)
        views = self._zeroed(VIEW_SIZE * len(inputs + outputs))  # to release what was never filled does nothing
        owned = self._zeroed(8 * (len(outputs) + 1))  # the outputs, and the tuple of them
        items = self._items()
        batched, m = number(0), number(1)
        arrays = []
        for k, field in enumerate(inputs):
            view = w.offset(views, VIEW_SIZE * k)
            single = self._fill(items[field.name], view, READ)
            if k == 0:
                batched, m = self._batch(view, field)
            arrays.append((*self._array(view, field, batched, m), single))
        for k, field in enumerate(outputs):
            view, reference = w.offset(views, VIEW_SIZE * (len(inputs) + k)), w.offset(owned, 8 * k)
            arrays.append(self._output(items[field.name], view, reference, field, (batched, m)))
        self._require_apart(arrays, m)
        records = self._zeroed(8 * RECORD * len(arrays))
        for k, (base, *rest) in enumerate(arrays):
            for entry, value in enumerate((b.ptrtoint(base, I64), *rest)):
                w.store(value, w.offset(records, 8 * (RECORD * k + entry)))
        bad = b.call(self.run, [records, number(0), m])
        w.require(b.icmp_signed("==", bad, number(0)), self.decline)
        results = [w.load(PTR, w.offset(owned, 8 * k)) for k in range(len(outputs))]
        if len(results) > 1:
            results = [b.call(self.api["PyTuple_Pack"], [number(len(results)), *results])]
            w.store(results[0], w.offset(owned, 8 * len(outputs)))
        w.store(results[0], answer)
        b.branch(self.decline)
        b.position_at_end(self.decline)
        for k in range(len(inputs + outputs)):
            b.call(self.api["PyBuffer_Release"], [w.offset(views, VIEW_SIZE * k)])
        b.call(self.api["Py_IncRef"], [w.load(PTR, answer)])
        for k in range(len(outputs) + 1):
            b.call(self.api["Py_DecRef"], [w.load(PTR, w.offset(owned, 8 * k))])
        b.ret(w.load(PTR, answer))

    def _items(self) -> dict[str, ir.Value]:
        """The arguments by name; of q, v, a those that are not read must be None."""
        w, b = self.w, self.w.builder
        read = [field.name for field in self.program.inputs + self.program.outputs]
        names = ["q", "v", "a", *(name for name in read if name not in ("q", "v", "a"))]
        _, args, count = b.function.args
        w.require(b.icmp_signed("==", count, number(len(names))), self.decline)
        items = {name: w.load(PTR, w.offset(args, 8 * k)) for k, name in enumerate(names)}
        for name in sorted(items.keys() - set(read)):
            w.require(b.icmp_unsigned("==", items[name], self.none), self.decline)
        return items

    def _zeroed(self, size: int) -> ir.Value:
        """Memory of so many bytes, all 0."""
        memory = self.w.memory(I64, size // 8)
        for k in range(size // 8):
            self.w.store(number(0), self.w.offset(memory, 8 * k))
        return memory

    def _output(
        self, item: ir.Value, view: ir.Value, reference: ir.Value, field: Field, batch: tuple[ir.Value, ir.Value]
    ) -> Array:
        """The array to write: the one passed, or a new one for None; a reference to it is kept."""
        w, b, (batched, m) = self.w, self.w.builder, batch
        data, row, column = w.memory(PTR), w.memory(I64), w.memory(I64)
        w.store(number(self.size * field.width), row)
        w.store(number(self.size), column)
        with b.if_else(b.icmp_unsigned("==", item, self.none)) as (absent, passed):
            with absent:
                sizes = w.memory(I64, 1 + len(field.shape))
                for k, size in enumerate((m, *map(number, field.shape))):
                    w.store(size, w.offset(sizes, 8 * k))
                sizes = w.offset(sizes, b.mul(b.sub(number(1), batched), number(8)))
                axes = b.add(b.trunc(batched, I32), ir.Constant(I32, len(field.shape)))
                zero = ir.Constant(I32, 0)
                number_type = ir.Constant(I32, TYPE_NUMBER[self.layout.float_type.name])
                arguments = [self.ndarray, axes, sizes, number_type, NULL, NULL, zero, zero, NULL]
                new = b.call(self.api["PyArray_New"], arguments)
                w.store(new, reference)
                with b.if_then(b.icmp_unsigned("==", new, NULL), likely=False):
                    b.call(self.api["PyErr_Clear"], [])
                    b.branch(self.decline)
                first = self._zeroed(8 * (1 + len(field.shape)))
                w.store(b.call(self.api["PyArray_GetPtr"], [new, first]), data)
            with passed:
                b.call(self.api["Py_IncRef"], [item])
                w.store(item, reference)
                single = self._fill(item, view, WRITE)
                w.require(b.icmp_signed("==", single, self.single), self.decline)
                for value, memory in zip(self._array(view, field, batched, m), (data, row, column), strict=True):
                    w.store(value, memory)
        return w.load(PTR, data), w.load(I64, row), w.load(I64, column), self.single

    def _fill(self, item: ir.Value, view: ir.Value, flags: int) -> ir.Value:
        """The buffer of an array, 1 if of float32; of a subclass, masked arrays among them, Python code decides."""
        w, b = self.w, self.w.builder
        cls = b.call(self.api["PyObject_Type"], [item])
        b.call(self.api["Py_DecRef"], [cls])
        w.require(b.icmp_unsigned("==", cls, self.ndarray), self.decline)
        filled = b.call(self.api["PyObject_GetBuffer"], [item, view, ir.Constant(I32, flags)])
        with b.if_then(b.icmp_signed("!=", filled, ir.Constant(I32, 0)), likely=False):
            b.call(self.api["PyErr_Clear"], [])
            b.branch(self.decline)
        form = w.load(ir.IntType(16), w.load(PTR, w.offset(view, VIEW["format"])), 1)
        single = b.icmp_unsigned("==", form, FORMAT[32])
        w.require(b.or_(single, b.icmp_unsigned("==", form, FORMAT[64])), self.decline)
        return b.zext(single, I64)

    def _batch(self, view: ir.Value, field: Field) -> tuple[ir.Value, ir.Value]:
        """Whether the first array has one axis more than a state, 0 or 1, and how many states there are."""
        w, b = self.w, self.w.builder
        axes = b.sub(w.load(I32, w.offset(view, VIEW["ndim"])), ir.Constant(I32, len(field.shape)))
        w.require(b.icmp_unsigned("<=", axes, ir.Constant(I32, 1)), self.decline)
        batched = b.zext(axes, I64)
        several = b.icmp_signed("==", batched, number(1))
        m = b.select(several, w.load(I64, w.load(PTR, w.offset(view, VIEW["shape"]))), number(1))
        numbers = self.program.width_in + self.program.width_out
        few = max(self.layout.block, min(FEW, FEW_NUMBERS // max(numbers, 1)))
        w.require(b.and_(b.icmp_signed(">=", m, number(1)), b.icmp_signed("<=", m, number(few))), self.decline)
        return batched, m

    def _array(
        self, view: ir.Value, field: Field, batched: ir.Value, m: ir.Value
    ) -> tuple[ir.Value, ir.Value, ir.Value]:
        """One array, if it has the axes that it must and evenly spaced numbers; an input may be one state for all."""
        w, b = self.w, self.w.builder
        axes = b.sub(b.sext(w.load(I32, w.offset(view, VIEW["ndim"])), I64), number(len(field.shape)))
        several = b.icmp_signed("==", axes, number(1))
        one_for_all = b.icmp_signed("==", axes, number(0)) if field in self.program.inputs else ir.Constant(I1, 0)
        w.require(b.or_(b.icmp_signed("==", axes, batched), one_for_all), self.decline)
        shape, strides = (w.load(PTR, w.offset(view, VIEW[key])) for key in ("shape", "strides"))
        w.require(b.icmp_signed("==", b.select(several, w.load(I64, shape), m), m), self.decline)
        row = b.select(several, w.load(I64, strides), number(0))
        first = b.shl(axes, number(3))  # of the axes of a state, in bytes
        shape, strides = w.offset(shape, first), w.offset(strides, first)
        column, inside = number(self.size), 1
        for axis, length in reversed(list(enumerate(field.shape))):
            w.require(b.icmp_signed("==", w.load(I64, w.offset(shape, 8 * axis)), number(length)), self.decline)
            stride = w.load(I64, w.offset(strides, 8 * axis))
            column = stride if axis == len(field.shape) - 1 else column
            w.require(b.icmp_signed("==", stride, b.mul(column, number(inside))), self.decline)
            inside *= length
        return w.load(PTR, w.offset(view, VIEW["data"])), row, column

    def _require_apart(self, arrays: Sequence[Array], m: ir.Value) -> None:
        """Outputs lie apart, and none over an input that a later block reads; within one block all is read before."""
        w, b, count = self.w, self.w.builder, len(self.program.inputs)
        fields = (*self.program.inputs, *self.program.outputs)
        spans = [self._span(array, field.width, m) for array, field in zip(arrays, fields, strict=True)]

        def apart(pairs: Iterable[tuple[int, int]]) -> ir.Value:
            clear: ir.Value = ir.Constant(I1, 1)
            for k, i in pairs:
                (start, end), (other_start, other_end) = spans[k], spans[i]
                before, behind = b.icmp_signed("<=", end, other_start), b.icmp_signed("<=", other_end, start)
                clear = b.and_(clear, b.or_(before, behind))
            return clear

        outputs = range(count, len(arrays))
        w.require(apart(combinations(outputs, 2)), self.decline)
        in_one_block = b.icmp_signed("<=", m, number(self.layout.block))
        w.require(b.or_(in_one_block, apart(product(range(count), outputs))), self.decline)

    def _span(self, array: Array, width: int, m: ir.Value) -> tuple[ir.Value, ir.Value]:
        """Where an array begins and ends in memory, whatever its strides."""
        b, (base, row, column, _) = self.w.builder, array
        start = end = b.ptrtoint(base, I64)
        for distance in (b.mul(row, b.sub(m, number(1))), b.mul(column, number(width - 1))):
            forward = b.icmp_signed(">", distance, number(0))
            start = b.add(start, b.select(forward, number(0), distance))
            end = b.add(end, b.select(forward, distance, number(0)))
        return start, b.add(end, number(8))


def python_entry(module: ir.Module, program: Program | CallProgram, layout: Layout, run: ir.Function) -> None:
    """The function `one` of a program whose states `run` computes."""
    api = {name: ir.Function(module, signature, name) for name, signature in FUNCTIONS.items()}
    none, ndarray = (untyped(ir.GlobalVariable(module, I64, name)) for name in ("_Py_NoneStruct", "PyArray_Type"))
    one, w = function(module, "one", PTR, [PTR, PTR, I64], internal=False)
    _One(w, program, layout, run, api, none, ndarray, one.append_basic_block("finish")).write()
