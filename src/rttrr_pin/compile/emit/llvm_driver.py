"""The compiled code around a program: blocks of states in and out, and the calls from outside.

    int64 run(int64 *arrays, int64 start, int64 stop)    1 where a result is not finite, -1 without memory

and `one`, which CPython calls, see `llvm_python`. `arrays` has `RECORD` numbers for each input, then each output:
address, distance in bytes from state to state and from column to column, 1 for float32.

States are gathered into columns, so that whatever the layout, every state goes through the same instructions: its bits
do not depend on its neighbours, on the block or on the thread.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from llvmlite import ir

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit import RECORD
from rttrr_pin.compile.emit.llvm_columns import pack, unpack, unsound
from rttrr_pin.compile.emit.llvm_python import python_entry
from rttrr_pin.compile.emit.llvm_vectors import Layout
from rttrr_pin.compile.emit.llvm_writer import I1, I64, LINE, PTR, SCALAR, function, number
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program

VOID = ir.VoidType()

STACK = 128 * 1024
"""Bytes of a block that may lie on the stack, of which threads have little; larger ones are allocated."""

Array = tuple[ir.Value, ir.Value, ir.Value, ir.Value]
"""A record, loaded."""


def driver(program: Program | CallProgram, layout: Layout, between: int) -> str:
    """The functions around a program's body, as LLVM assembly; `between` columns are passed on by its parts."""
    module = ir.Module(name="driver")
    run = _Driver(module, program, layout, between).run()
    python_entry(module, program, layout, run)
    return str(module)


class _Driver:
    """Writes `run`, and the functions that move columns; the program's own are `body` and `fill` (constant outputs)."""

    def __init__(self, module: ir.Module, program: Program | CallProgram, layout: Layout, between: int) -> None:
        self.program, self.layout, self.between = program, layout, between
        self.column = layout.pitch * layout.float_type.size  # in bytes
        self.body = ir.Function(module, ir.FunctionType(VOID, [PTR, PTR, PTR, I64]), "body")
        self.fill = ir.Function(module, ir.FunctionType(VOID, [PTR, I64]), "fill")
        self.malloc = ir.Function(module, ir.FunctionType(PTR, [I64]), "malloc")
        self.free = ir.Function(module, ir.FunctionType(VOID, [PTR]), "free")
        widths_in, widths_out = ({field.width for field in fields} for fields in (program.inputs, program.outputs))
        self.pack = {(bits, width): pack(module, layout, bits, width) for bits in SCALAR for width in sorted(widths_in)}
        self.unpack = {width: unpack(module, layout, width) for width in sorted(widths_out)}
        self.unsound = unsound(module, layout)
        self.function, self.w = function(module, "run", I64, [PTR, I64, I64], internal=False)

    def run(self) -> ir.Function:
        """Compute the states from start to stop, block by block."""
        w, b, block = self.w, self.w.builder, number(self.layout.block)
        records, start, stop = self.function.args
        count = len(self.program.inputs + self.program.outputs)
        loaded = [
            [w.load(I64, w.offset(records, 8 * (RECORD * k + entry))) for entry in range(RECORD)] for k in range(count)
        ]
        without = b.append_basic_block("without_memory")
        bad = w.memory(I64)
        w.store(number(0), bad)
        with self._scratch(without) as columns:
            b.call(self.fill, [columns[1], self._padded(w.least(block, b.sub(stop, start)))])
            with w.loop(stop, self.layout.block, start) as first:
                m = w.least(block, b.sub(stop, first))
                arrays = [(w.offset(b.inttoptr(at, PTR), b.mul(first, row)), row, *rest) for at, row, *rest in loaded]
                w.store(b.or_(w.load(I64, bad), b.zext(self._block(arrays, m, columns), I64)), bad)
        b.ret(w.load(I64, bad))
        b.position_at_end(without)
        b.ret(number(-1))
        return self.function

    @contextmanager
    def _scratch(self, without: ir.Block) -> Iterator[list[ir.Value]]:
        """Memory for columns: of the inputs, the outputs, and what is passed between parts, one behind the other."""
        w, b = self.w, self.w.builder
        sizes = [width * self.column for width in (self.program.width_in, self.program.width_out, self.between)]
        total = max(sum(sizes), 8)
        allocated = None
        if total <= STACK:
            base = w.memory(I64, -(-total // 8))
        else:
            allocated = b.call(self.malloc, [number(total + LINE)])
            w.require(b.icmp_unsigned("!=", allocated, ir.Constant(PTR, None)), without)
            base = w.aligned(allocated)
        yield [w.offset(base, sum(sizes[:k])) for k in range(3)]
        if allocated is not None:
            b.call(self.free, [allocated])

    def _block(self, arrays: Sequence[Array], m: ir.Value, columns: Sequence[ir.Value]) -> ir.Value:
        """Gather m states, run the body, scatter the results; returns whether a result is not finite."""
        b, program, (inputs, outputs, between) = self.w.builder, self.program, columns
        count = len(program.inputs)
        for (base, row, column, single), field, at in self._placed(arrays[:count], program.inputs, inputs):
            arguments = [base, row, column, at, m]
            with b.if_else(b.icmp_signed("!=", single, number(0))) as (float32, float64):
                with float32:
                    b.call(self.pack[32, field.width], arguments)
                with float64:
                    b.call(self.pack[64, field.width], arguments)
        padded = self._padded(m)
        # All is read before the first result is written: outputs may lie over inputs of the same block.
        b.call(self.body, [inputs, outputs, between, padded])
        bad: ir.Value = ir.Constant(I1, 0)
        for index in program.unread:  # NaN there would reach no result, and is an error all the same
            bad = b.or_(bad, b.call(self.unsound, [self.w.offset(inputs, index * self.column), padded]))
        for (base, row, column, _), field, at in self._placed(arrays[count:], program.outputs, outputs):
            bad = b.or_(bad, b.call(self.unpack[field.width], [base, row, column, at, m]))
        return bad

    def _padded(self, m: ir.Value) -> ir.Value:
        """So many states that vectors are full."""
        b = self.w.builder
        return b.and_(b.add(m, number(self.layout.lanes - 1)), number(-self.layout.lanes))

    def _placed(
        self, arrays: Sequence[Array], fields: Sequence[Field], base: ir.Value
    ) -> Iterator[tuple[Array, Field, ir.Value]]:
        """Each array with the address of its columns."""
        before = 0
        for array, field in zip(arrays, fields, strict=True):
            yield array, field, self.w.offset(base, before * self.column)
            before += field.width
