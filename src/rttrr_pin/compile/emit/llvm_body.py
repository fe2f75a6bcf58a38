"""A program as LLVM assembly: straight lines over vectors of states.

The text has functions `void segment_k(ptr in, ptr out, ptr between, i64 m)`, each a loop over m states, `LANES` at a
time, and `void body(...)`, which calls them in turn. Column j of an array of the block starts at j * pitch.
"""

from __future__ import annotations

from collections.abc import Iterator

from rttrr_pin.compile.emit.llvm_angles import LIBRARY, mend, mending
from rttrr_pin.compile.emit.llvm_vectors import Layout, Lines, VectorCode, declarations, loop
from rttrr_pin.compile.expression import LEAVES, Op
from rttrr_pin.compile.program import Program

SEGMENT = 700
"""Operations in one loop: its code stays in the instruction cache, and the compiler's time linear."""

COLUMNS = (("q", "in"), ("o", "out"), ("b", "between"))
"""Addresses at the present states, and of what."""


def body(program: Program, layout: Layout) -> tuple[str, int]:
    """The program's functions, and how many columns they need to pass values from one to the next."""
    parts = _segments(program)
    passed = _passed(program, parts)
    texts = [_segment(program, layout, k, part, passed) for k, part in enumerate(parts)]
    every = range(len(parts))
    # A short program takes a vector of states through all segments before the next; a long one, all states of a block
    # through a segment before the next, so that code is read once for each block.
    groups = [every] if layout.short else [range(k, k + 1) for k in every]
    loops = [_through(layout, number, group) for number, group in enumerate(groups)]
    arguments = "ptr %in, ptr %out, ptr %between, i64 %m"
    calls = "\n".join(f"  call void @through_{number}({arguments})" for number in range(len(groups)))
    whole = f"define void @body({arguments}) noinline {{\n{calls}\n  ret void\n}}\n"
    lines = [*declarations(layout), *mending(layout), *texts, *loops, whole, *_fill(program, layout)]
    return "\n".join(lines), len(passed)


WIDEST = 48
"""Numbers in and out of a state up to which code in line gathers and scatters them: a fifth faster, but compiling takes
as long again, and that grows with them."""


def is_short(program: Program) -> bool:
    """Whether all operations but sines and cosines stay in the instruction cache, and what gathers and scatters too."""
    return len(_segments(program)) == 2 and program.width_in + program.width_out <= WIDEST


def _through(layout: Layout, number: int, segments: range) -> str:
    """A loop over vectors of states, which go through some segments."""
    lines = layout.lines()
    for k in segments:
        lines.do(f"call void @segment_{k}(ptr %q, ptr %o, ptr %b)")
    return _loop(f"through_{number}", layout, lines)


def _fill(program: Program, layout: Layout) -> Iterator[str]:
    """The function `void fill(ptr out, i64 m)`: what no state changes, written once for all blocks."""
    graph = program.graph
    still = [(column, x) for column, x in enumerate(program.results) if graph.op[x] is Op.CONSTANT]
    parts = [still[start : start + SEGMENT] for start in range(0, len(still), SEGMENT)]
    for k, part in enumerate(parts):
        lines = layout.lines()
        for column, x in part:
            value = lines.splat(graph.value[x])
            lines.do(f"store {lines.vector} {value}, ptr {lines.at('%o', column * layout.pitch)}")
        yield _loop(f"fill_{k}", layout, lines)
    calls = "\n".join(f"  call void @fill_{k}(ptr %out, ptr %out, ptr %out, i64 %m)" for k in range(len(parts)))
    yield f"define void @fill(ptr %out, i64 %m) noinline {{\n{calls}\n  ret void\n}}\n"


def _segments(program: Program) -> list[list[int]]:
    """The operations in order, cut into parts: sines and cosines, and parts of about equal length."""
    op = program.graph.op
    angles = _angles(program)
    todo = [x for x in program.order if op[x] not in (Op.CONSTANT, Op.INPUT) and x not in angles]
    count = max(1, -(-len(todo) // SEGMENT))
    size = -(-len(todo) // count) or 1
    parts = [todo[start : start + size] for start in range(0, len(todo), size)] or [[]]
    return [[x for x in program.order if x in angles], *_angles_together(program, parts)]


def _angles(program: Program) -> set[int]:
    """Sines and cosines, and what their angles take, but for those whose angle has a sine in it or never changes."""
    graph = program.graph
    turns = {x: set(graph.reachable([graph.args[x][0]])) for x in program.order if graph.op[x] in LIBRARY}
    others = {Op.CONSTANT, *LIBRARY}
    plain = [x for x, inside in turns.items() if graph.op[graph.args[x][0]] not in others]
    plain = [x for x in plain if not any(graph.op[y] in LIBRARY for y in turns[x])]
    return {y for x in plain for y in (x, *turns[x]) if graph.op[y] not in LEAVES}


def _angles_together(program: Program, parts: list[list[int]]) -> list[list[int]]:
    """Sine and cosine of one angle are computed at once: both stand where the first of them stands."""
    op, args = program.graph.op, program.graph.args
    # They share the reduction of the angle, and `VectorCode` computes both in one go within a segment only.
    first: dict[int, int] = {}
    moved: list[list[int]] = [[] for _ in parts]
    for k, part in enumerate(parts):
        for x in part:
            home = first.setdefault(args[x][0], k) if op[x] in LIBRARY else k
            moved[home].append(x)
    return moved


def _passed(program: Program, parts: list[list[int]]) -> dict[int, int]:
    """Values that a later segment needs, and the column that each is passed in."""
    home = {x: k for k, part in enumerate(parts) for x in part}
    last = {x: home[x] for part in parts for x in part}
    for k, part in enumerate(parts):
        for x in part:
            for y in program.graph.args[x]:
                if y in home:
                    last[y] = max(last[y], k)
    # In the first segment sines and cosines are mended in memory, with their angles: others store its results.
    mended = {y for x in parts[0] if program.graph.op[x] in LIBRARY for y in (x, program.graph.args[x][0])}
    needed = [x for x in home if last[x] > home[x] or x in mended or (x in program.results and home[x] == 0)]
    return {x: column for column, x in enumerate(sorted(needed))}


def _segment(program: Program, layout: Layout, k: int, part: list[int], passed: dict[int, int]) -> str:
    """Straight lines with the results of their operations; the second has those of the first as well."""
    lines = layout.lines()
    writer = VectorCode(program, layout, lines, passed)
    inside = set(part)
    for x in part:
        if k == 0 and program.graph.op[x] in LIBRARY:
            writer.near(x)
        else:
            writer.compute(x)
        if x in passed:
            lines.do(f"store {lines.vector} {writer.value[x]}, ptr {lines.at('%b', passed[x] * layout.pitch)}")
    if k == 0:
        mend(writer, [x for x in part if program.graph.op[x] in LIBRARY])
    early = {*_angles(program), *(x for x in program.results if program.graph.op[x] is Op.INPUT)} if k == 1 else set()
    for column, x in enumerate(program.results):
        if k and (x in inside or x in early):
            lines.do(f"store {lines.vector} {writer.get(x)}, ptr {lines.at('%o', column * layout.pitch)}")
    text = "\n".join(lines.text)
    arguments = "ptr noalias %q, ptr noalias %o, ptr noalias %b"
    return f"define internal void @segment_{k}({arguments}) noinline {{\nloop:\n{text}\n  ret void\n}}\n"


def _loop(name: str, layout: Layout, lines: Lines) -> str:
    """A function that does the lines for m states; %q, %o and %b are where these have their columns."""
    scalar = layout.float_type.c_name
    lines.text[:0] = [f"  %{at} = getelementptr {scalar}, ptr %{base}, i64 %i" for at, base in COLUMNS]
    return loop(name, "ptr noalias %in, ptr noalias %out, ptr noalias %between", lines, "loop")
