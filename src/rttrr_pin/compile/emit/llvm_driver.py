"""The compiled code around a program: blocks of states in and out, and the calls from outside.

    int64 run(int64 *arrays, int64 start, int64 stop)    1 where a result is not finite, -1 without memory

and `one`, which CPython calls, see `llvm_python`. `arrays` has `RECORD` numbers for each input, then each output:
address, distance in bytes from state to state and from column to column, count of columns, 1 for float32.
"""

from __future__ import annotations

from llvmlite import ir

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit.llvm_block import Array, Block, compute
from rttrr_pin.compile.emit.llvm_columns import F32, F64, I64, PTR, function, number, pack, unpack, unsound
from rttrr_pin.compile.emit.llvm_python import python_entry
from rttrr_pin.compile.emit.llvm_vectors import Layout
from rttrr_pin.compile.program import Program

RECORD = 5
"""Numbers that describe an array."""


def driver(program: Program | CallProgram, layout: Layout, between: int) -> str:
    """The functions around the program's body, as LLVM assembly.

    Args:
        program: the program, for the widths of its arrays.
        layout: how blocks lie in memory.
        between: columns that its parts pass on.

    Returns:
        The text of a module that calls `body`.
    """
    module = ir.Module(name="driver")
    block = Block(
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
    python_entry(module, block)
    return str(module)


def _run(module: ir.Module, block: Block) -> None:
    """The function int64 run(int64 *arrays, int64 start, int64 stop)."""
    _, w = function(module, "run", I64, [PTR, I64, I64], internal=False)
    records, start, stop = w.builder.function.args
    fields = block.program.inputs + block.program.outputs
    described = [
        [w.load(I64, w.offset(records, 8 * (RECORD * k + entry))) for entry in (0, 1, 2, 4)] for k in range(len(fields))
    ]
    arrays = [Array(w.builder.inttoptr(base, PTR), *rest) for base, *rest in described]
    without = w.builder.append_basic_block("without_memory")
    w.builder.ret(compute(w, block, arrays, (start, stop), without))
    w.builder.position_at_end(without)
    w.builder.ret(number(-1))
