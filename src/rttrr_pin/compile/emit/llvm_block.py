"""Compiled code that computes states block by block.

States are gathered into columns, so that whatever the layout, every state goes through the same instructions: its bits
do not depend on its neighbours, on the block or on the thread.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import groupby

from llvmlite import ir

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit.llvm_columns import F32, F64, I64, LINE, PTR, Writer, number
from rttrr_pin.compile.emit.llvm_vectors import Layout
from rttrr_pin.compile.program import Field, Program

STACK = 128 * 1024
"""Bytes of a block that may lie on the stack, of which threads have little; larger ones are allocated."""


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
class Block:
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

    program: Program | CallProgram
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
            w.require(w.builder.icmp_unsigned("!=", held, ir.Constant(PTR, None)), without)
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


def compute(
    w: Writer, block: Block, arrays: Sequence[Array], between: tuple[ir.Value, ir.Value], without: ir.Block
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
