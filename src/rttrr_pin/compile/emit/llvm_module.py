"""From a program to a module of LLVM.

Straight from the program to LLVM's assembly: vectors of states are written as vectors, so that nothing is left to the
luck of an optimiser.
"""

from __future__ import annotations

import llvmlite.binding as llvm
from llvmlite.binding.newpassmanagers import NewPassManager

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit.llvm_body import body, is_short
from rttrr_pin.compile.emit.llvm_calls import calls
from rttrr_pin.compile.emit.llvm_driver import driver
from rttrr_pin.compile.emit.llvm_vectors import LINE, Layout
from rttrr_pin.compile.program import Program

BLOCK = 64
"""States in a block."""

NEAR = 48 * 1024
"""Bytes that a block's inputs and outputs may take: what a segment has of them stays in the first level of the cache,
and its code, read once for each block, costs little."""

SECOND_LEVEL = 512 * 1024
"""Bytes that all columns of a block may take in a schedule, which goes through them twice."""


def module(
    program: Program | CallProgram, lanes: int, machine: llvm.TargetMachine, optimisation: int
) -> llvm.ModuleRef:
    """The program as a module, optimised where there is anything to be found: not in its straight lines."""
    layout = _layout(program, lanes)
    if isinstance(program, CallProgram):
        text, between = calls(program, layout), program.between
    else:
        text, between = body(program, layout)
    whole = llvm.parse_assembly(driver(program, layout, between))
    options = llvm.create_pipeline_tuning_options(speed_level=optimisation)
    options.loop_vectorization = options.slp_vectorization = options.loop_unrolling = False
    builder = llvm.create_pass_builder(machine, options)
    passes = builder.getModulePassManager()
    passes.run(whole, builder)
    NewPassManager._dispose(passes)  # a method that llvmlite's own classes hide: passes would stay, 0.1 MB of them
    passes.detach()
    whole.link_in(llvm.parse_assembly(text))
    whole.verify()
    return whole


def _layout(program: Program | CallProgram, lanes: int) -> Layout:
    """How blocks of this program lie in memory: as many states as keep its columns in the nearest cache."""
    if isinstance(program, Program) and is_short(program):
        line = max(lanes, LINE // program.float_type.size)
        return Layout(lanes, line, line, program.float_type, short=True)
    if isinstance(program, CallProgram):
        room, width = SECOND_LEVEL, program.columns
    else:
        room, width = NEAR, program.width_in + program.width_out
    block = min(BLOCK, max(lanes, room // (program.float_type.size * max(width, 1)) // lanes * lanes))
    return Layout(lanes, block, block + lanes, program.float_type)
