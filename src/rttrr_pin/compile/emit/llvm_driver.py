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
from functools import partial

from llvmlite import ir

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit import RECORD
from rttrr_pin.compile.emit.llvm_columns import Record, block_in, block_out, pack, unpack
from rttrr_pin.compile.emit.llvm_python import python_entry
from rttrr_pin.compile.emit.llvm_tiles import Columns, Sound
from rttrr_pin.compile.emit.llvm_vectors import LINE, Layout
from rttrr_pin.compile.emit.llvm_writer import I1, I64, PTR, SCALAR, function, number
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program

VOID = ir.VoidType()

STACK = 128 * 1024
"""Bytes of a block that may lie on the stack, of which threads have little; larger ones are allocated."""


def driver(program: Program | CallProgram, layout: Layout, between: int) -> str:
    """The functions around a program's body, as LLVM assembly; `between` columns are passed on by its parts."""
    module = ir.Module(name="driver")
    run = _Driver(module, program, layout, between).run()
    if isinstance(program, CallProgram) or not program.quickly:
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
        self.function, self.w = function(module, "run", I64, [PTR, I64, I64], internal=False)
        self.sound = Sound(self.w, ir.VectorType(SCALAR[layout.float_type.bits], layout.lanes))
        self.bad = self.w.memory(I1)
        self.w.store(ir.Constant(I1, 0), self.bad)

    def run(self) -> ir.Function:
        """Compute the states from start to stop, block by block."""
        w, b, block = self.w, self.w.builder, number(self.layout.block)
        records, start, stop = self.function.args
        count = len(self.program.inputs + self.program.outputs)
        loaded = [
            [w.load(I64, w.offset(records, 8 * (RECORD * k + entry))) for entry in range(RECORD)] for k in range(count)
        ]
        without = b.append_basic_block("without_memory")

        def arrays(first: ir.Value) -> list[Record]:
            """From a state on."""
            return [(w.offset(b.inttoptr(at, PTR), b.mul(first, row)), row, *rest) for at, row, *rest in loaded]

        with self._scratch(without) as columns:
            b.call(self.fill, [columns[1], self._padded(w.least(block, b.sub(stop, start)))])
            if self.layout.short:
                whole = b.add(start, b.and_(b.sub(stop, start), number(-self.layout.block)))
                with w.loop(whole, self.layout.block, start) as first:
                    self._block(arrays(first), block, columns, in_line=True)
                start = whole
            with w.loop(stop, self.layout.block, start) as first:
                self._block(arrays(first), w.least(block, b.sub(stop, first)), columns)
        b.ret(b.zext(b.or_(w.load(I1, self.bad), b.not_(self.sound.all())), I64))
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

    def _block(self, arrays: Sequence[Record], m: ir.Value, columns: Sequence[ir.Value], in_line: bool = False) -> None:
        """Gather m states, run the body, scatter the results; in line for a whole block of a short program."""
        w, b, program, layout = self.w, self.w.builder, self.program, self.layout
        count, padded = len(program.inputs), self._padded(m)
        for array, field, at in self._placed(arrays[:count], program.inputs, columns[0]):
            pack = partial(self._pack, array, field, at, m)
            if in_line:
                block_in(Columns(w, layout, at), array, field.width, layout.block, pack)
            else:
                pack()
        # All is read before the first result is written: outputs may lie over inputs of the same block.
        b.call(self.body, [*columns, padded])
        inputs = Columns(w, layout, columns[0])
        for index in program.unread:  # NaN there would reach no result, and is an error all the same
            with w.loop(padded, layout.lanes) as i:
                self.sound.seen(inputs.get(number(index), i))
        for array, field, at in self._placed(arrays[count:], program.outputs, columns[1]):
            unpack = partial(self._unpack, array, field, at, m)
            if in_line:
                block_out(Columns(w, layout, at), array, field.width, layout.block, self.sound, unpack)
            else:
                unpack()

    def _pack(self, array: Record, field: Field, at: ir.Value, m: ir.Value) -> None:
        b, (base, row, column, single) = self.w.builder, array
        with b.if_else(b.icmp_signed("!=", single, number(0))) as (float32, float64):
            with float32:
                b.call(self.pack[32, field.width], [base, row, column, at, m])
            with float64:
                b.call(self.pack[64, field.width], [base, row, column, at, m])

    def _unpack(self, array: Record, field: Field, at: ir.Value, m: ir.Value) -> None:
        w, b, (base, row, column, _) = self.w, self.w.builder, array
        bad = b.call(self.unpack[field.width], [base, row, column, at, m])
        w.store(b.or_(w.load(I1, self.bad), bad), self.bad)

    def _padded(self, m: ir.Value) -> ir.Value:
        """So many states that vectors are full."""
        b = self.w.builder
        return b.and_(b.add(m, number(self.layout.lanes - 1)), number(-self.layout.lanes))

    def _placed(
        self, arrays: Sequence[Record], fields: Sequence[Field], base: ir.Value
    ) -> Iterator[tuple[Record, Field, ir.Value]]:
        """Each array with the address of its columns."""
        before = 0
        for array, field in zip(arrays, fields, strict=True):
            yield array, field, self.w.offset(base, before * self.column)
            before += field.width
