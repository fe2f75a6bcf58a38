"""A schedule as LLVM assembly: one function for each step, a table of calls, and a loop that goes through it.

    void step_k(ptr in, ptr row, ptr numbers, i64 m)     a loop over m states, LANES at a time
    void body(ptr in, ptr out, ptr between, i64 m)       all calls

A row of the table has the step, then the columns that it reads and those that it writes, as distances from `in` in
numbers: `out` and `between` lie behind `in`. The numbers of all calls stand one behind the other in another table.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

from rttrr_pin.compile.call_program import CallProgram, Step
from rttrr_pin.compile.emit.llvm_vectors import Layout, VectorCode, declarations, loop
from rttrr_pin.compile.expression import LEAVES

END = 2**32 - 1
"""In the place of a step, behind the last call."""

FORMAT = {64: "d", 32: "f"}
"""Of numbers of so many bits, for `struct`."""

FILL = "define void @fill(ptr %out, i64 %m) {\n  ret void\n}\n"
"""What no state changes is written by calls, as all else is."""


def calls(call_program: CallProgram, layout: Layout) -> str:
    """The schedule's functions and tables."""
    steps = (_step(step, layout, k) for k, step in enumerate(call_program.steps))
    return "\n".join([*declarations(layout), *_tables(call_program, layout), *steps, _body(call_program, layout), FILL])


def _tables(call_program: CallProgram, layout: Layout) -> Iterator[str]:
    """Rows and numbers as bytes, which take no time to read."""
    rows = [
        x
        for call in call_program.calls
        for x in (call.step, *(column * layout.pitch for column in (*call.columns, *call.results)))
    ]
    numbers = [layout.float_type.rounded(x) for call in call_program.calls for x in call.numbers]
    yield _constant("rows", struct.pack(f"<{len(rows) + 1}I", *rows, END))
    yield _constant("numbers", struct.pack(f"<{len(numbers)}{FORMAT[layout.float_type.bits]}", *numbers))


def _constant(name: str, data: bytes) -> str:
    text = "".join(f"\\{byte:02X}" for byte in data)
    return f'@{name} = internal constant [{len(data)} x i8] c"{text}", align 64'


@dataclass
class _StepCode(VectorCode):
    """Writes the operations of one step; its columns and numbers are found through the table."""

    step: Step | None = None

    def read(self, index: int) -> str:
        """The vector of a column, or a number in all lanes."""
        assert self.step is not None
        lines, v, scalar = self.lines, self.lines.vector, self.lines.float_type.c_name
        if index in self.step.columns:
            return lines(f"load {v}, ptr {self.address(self.step.columns.index(index))}, align {lines.float_type.size}")
        x = lines(f"load {scalar}, ptr {lines.at('%numbers', self.step.numbers.index(index))}")
        first = lines(f"insertelement {v} poison, {scalar} {x}, i32 0")
        return lines(f"shufflevector {v} {first}, {v} poison, <{lines.lanes} x i32> zeroinitializer")

    def address(self, entry: int) -> str:
        """Where the column of an entry of the row has the present states."""
        lines = self.lines
        offset = lines(f"load i32, ptr {lines(f'getelementptr i32, ptr %row, i64 {entry}')}")
        return lines(f"getelementptr {lines.float_type.c_name}, ptr %q, i64 {lines(f'zext i32 {offset} to i64')}")


def _step(step: Step, layout: Layout, k: int) -> str:
    """One loop over the states; everything is read before anything is written, since columns are used again."""
    program, lines = step.program, layout.lines()
    code = _StepCode(program, layout, lines, step=step)
    for x in program.order:
        if program.graph.op[x] not in LEAVES:
            code.compute(x)
    # A result may be an argument that is handed on: `get` loads it here, before a store can overwrite its column.
    values = [code.get(x) for x in program.results]
    for entry, value in enumerate(values, len(step.columns)):
        lines.do(f"store {lines.vector} {value}, ptr {code.address(entry)}, align {lines.float_type.size}")
    lines.text.insert(0, f"  %q = getelementptr {lines.float_type.c_name}, ptr %in, i64 %i")
    return loop(f"step_{k}", "ptr %in, ptr %row, ptr %numbers", lines, code.label)


def _body(call_program: CallProgram, layout: Layout) -> str:
    """The loop over the rows of the table."""
    steps = range(len(call_program.steps))
    cases = " ".join(f"i32 {k}, label %case_{k}" for k in steps)
    parts = []
    for k, step in enumerate(call_program.steps):
        entries = 1 + len(step.columns) + len(step.program.results)
        parts.append(f"""case_{k}:
  %columns_{k} = getelementptr i32, ptr %row, i64 1
  call void @step_{k}(ptr %in, ptr %columns_{k}, ptr %number, i64 %m)
  %row_{k} = getelementptr i32, ptr %row, i64 {entries}
  %number_{k} = getelementptr {layout.float_type.c_name}, ptr %number, i64 {len(step.numbers)}
  br label %loop""")
    rows = ", ".join(["[ @rows, %start ]", *(f"[ %row_{k}, %case_{k} ]" for k in steps)])
    numbers = ", ".join(["[ @numbers, %start ]", *(f"[ %number_{k}, %case_{k} ]" for k in steps)])
    text = "\n".join(parts)
    return f"""define void @body(ptr %in, ptr %out, ptr %between, i64 %m) noinline {{
start:
  br label %loop
loop:
  %row = phi ptr {rows}
  %number = phi ptr {numbers}
  %step = load i32, ptr %row
  switch i32 %step, label %done [ {cases} ]
{text}
done:
  ret void
}}
"""
