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
    program: Program | CallProgram,
    lanes: int,
    machine: llvm.TargetMachine,
    optimisation: int,
    near: llvm.TargetMachine | None = None,
) -> llvm.ModuleRef:
    """The program as a module, optimised where there is anything to be found: not in its straight lines.

    Args:
        program: the program.
        lanes: numbers in a vector.
        machine: the processor.
        optimisation: LLVM's level.
        near: the same processor, with code and constants less than 2 GiB apart; None where they cannot be put so.
    """
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
    lines = llvm.parse_assembly(text)
    whole.link_in(lines if near is None else llvm.parse_assembly(beside_code(near.emit_assembly(lines))))
    whole.verify()
    return whole


DATA = ([".ascii"], [".asciz"], [".string"])
"""What is followed by bytes as text, in which a label's first characters may stand by chance."""


def beside_code(assembly: str) -> str:
    """A module of assembly whose constants stand in the section of its code.

    There they are operands of instructions, by their distance. Sections of their own the loader puts anywhere, so that
    each constant would take a register to be found. Labels get another name than those of the code around the program.
    """
    lines = []
    for line in assembly.splitlines():
        directive = line.split(None, 2)[:2]
        if directive[:1] == [".section"]:
            line = "\t.text" if directive[1].startswith(".rodata") else ""
        if directive[:1] not in ([".file"], [".ident"]):
            line = line if directive[:1] in DATA else line.replace(".L", ".Lprogram_")
            lines.append(line.replace("\\", "\\5C").replace('"', "\\22"))
    return "\n".join(f'module asm "{line}"' for line in lines)


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
