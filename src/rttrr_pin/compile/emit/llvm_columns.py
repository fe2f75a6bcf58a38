"""Compiled code that moves states between arrays of any layout and the columns that a program works on.

Rows, whose numbers lie side by side, are read and written in tiles: a few numbers of LANES rows at a time, exchanged in
registers. Arrays that lie in columns are copied by vectors. All else goes number by number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from llvmlite import ir

from rttrr_pin.compile.emit.llvm_tiles import UNROLLED, Columns, Sound, rows_in, rows_out, vector
from rttrr_pin.compile.emit.llvm_vectors import LINE, Layout
from rttrr_pin.compile.emit.llvm_writer import I1, I32, I64, PTR, SCALAR, Writer, function, number

VOID = ir.VoidType()

TOGETHER = 4
"""Vectors of a column that are copied in a turn of a loop."""

AHEAD = 32
"""States between the one that is moved and the one that is fetched into the cache."""

Record = tuple[ir.Value, ir.Value, ir.Value, ir.Value]
"""Of an array, loaded; see `rttrr_pin.compile.emit.RECORD`."""


def pack(module: ir.Module, layout: Layout, bits: int, width: int) -> ir.Function:
    """Gather m states of an array, with so many numbers of so many bits each; lanes beyond m repeat the last state."""
    routine, w = function(module, f"pack_f{bits}_{width}", VOID, [PTR, I64, I64, PTR, I64])
    source, row, column, target, m = routine.args
    b, W, size = w.builder, layout.lanes, bits // 8
    columns = Columns(w, layout, target)
    full = b.and_(m, number(-W))
    # Twice: whole vectors, then the rest, where the last state is repeated in the lanes beyond it. Such vectors need no
    # code of their own in a program, and what is repeated raises no NaN that is not that state's.
    with w.loop(number(2)) as rest:
        whole = b.icmp_signed("==", rest, number(0))
        start, stop = b.select(whole, number(0), full), b.select(whole, full, m)
        last = b.select(whole, number(W), b.sub(m, b.add(full, number(1))))
        steps = [b.mul(w.least(number(k), last), row) for k in range(1, W)]

        def vectors() -> Iterator[tuple[list[ir.Value], ir.Value]]:
            """The rows of each vector, and the first of its states."""
            with w.loop(stop, W, start) as i:
                first = w.offset(source, b.mul(i, row))
                yield [first, *(w.offset(first, step) for step in steps)], i

        def number_by_number() -> None:
            for rows, i in vectors():
                with w.loop(number(width)) as j:
                    value: ir.Value = ir.Constant(vector(bits, W), ir.Undefined)
                    for k, x in enumerate(rows):
                        item = w.load(SCALAR[bits], w.offset(x, b.mul(j, column)), size)
                        value = b.insert_element(value, item, ir.Constant(I32, k))
                    columns.put(value, j, i)

        if layout.short:  # what lies better is moved in line
            number_by_number()
        else:
            in_columns = b.and_(whole, b.icmp_signed("==", row, number(size)))
            with b.if_else(in_columns) as (copied, gathered):
                with copied, w.loop(number(width)) as j:
                    x = w.offset(source, b.mul(j, column))
                    for i in _vectors(w, layout, full):
                        columns.put(w.load(vector(bits, W), w.offset(x, w.times(i, size)), size), j, i)
                with gathered, b.if_else(b.icmp_signed("==", column, number(size))) as (side_by_side, apart):
                    with side_by_side:
                        for rows, i in vectors():
                            rows_in(columns, bits, width, rows, i)
                    with apart:
                        number_by_number()
    b.ret_void()
    return routine


def unpack(module: ir.Module, layout: Layout, width: int) -> ir.Function:
    """Scatter m states from columns into an array; returns whether a number among them is not finite."""
    routine, w = function(module, f"unpack_{width}", I1, [PTR, I64, I64, PTR, I64])
    target, row, column, source, m = routine.args
    b = w.builder
    columns = Columns(w, layout, source)
    sound = Sound(w, columns.vector)
    done = number(0) if layout.short else _whole_vectors(columns, layout, width, (target, row, column, m), sound)
    single = Sound(w, columns.scalar)
    with w.loop(number(width)) as j, w.loop(m, 1, done) as i:
        value = single.seen(w.load(columns.scalar, columns.at(j, i), columns.size))
        y = w.offset(target, b.mul(j, column))
        w.store(value, w.offset(y, b.mul(i, row)), columns.size)
    b.ret(b.not_(b.and_(sound.all(), single.all())))
    return routine


def _whole_vectors(columns: Columns, layout: Layout, width: int, array: tuple[ir.Value, ...], sound: Sound) -> ir.Value:
    """Scatter what fills vectors, into rows or columns; returns how many states that are.

    The array has no room for repeated states: what fills no vector goes one by one.
    """
    w, b, size = columns.w, columns.w.builder, number(columns.size)
    target, row, column, m = array
    full = b.and_(m, number(-layout.lanes))
    done = w.memory(I64)
    w.store(full, done)
    with b.if_else(b.icmp_signed("==", row, size)) as (in_columns, in_rows):
        with in_columns, w.loop(number(width)) as j:
            y = w.offset(target, b.mul(j, column))
            for i in _vectors(w, layout, full):
                w.store(sound.seen(columns.get(j, i)), w.offset(y, b.mul(i, size)), columns.size)
        with in_rows, b.if_else(b.icmp_signed("==", column, size)) as (side_by_side, apart):
            with side_by_side, w.loop(full, layout.lanes) as i:
                rows_out(columns, width, _rows(w, target, row, i, layout.lanes), i, sound)
            with apart:
                w.store(number(0), done)
    return w.load(I64, done)


def block_in(columns: Columns, array: Record, width: int, block: int, otherwise: Callable[[], object]) -> None:
    """Gather a whole block in line where rows or columns are whole in memory; `otherwise` writes what does all else."""
    w, b = columns.w, columns.w.builder
    base, row, column, single = array
    done = b.append_basic_block("gathered")
    for bits in sorted(SCALAR, key=lambda bits: bits != 8 * columns.size):
        size = bits // 8
        same = b.icmp_signed("==", single, number(int(bits == 32)))
        with b.if_then(b.and_(same, b.icmp_signed("==", column, number(size)))):
            with w.loop(number(block), columns.lanes) as i:
                rows = _rows(w, base, row, i, columns.lanes)
                _ahead(w, rows, row, AHEAD, width * size)
                rows_in(columns, bits, width, rows, i)
            b.branch(done)
        with b.if_then(b.and_(same, b.icmp_signed("==", row, number(size)))):
            for j in _each(w, width):
                x = w.offset(base, b.mul(j, column))
                w.prefetch(w.offset(x, size * AHEAD))
                for i in range(0, block, columns.lanes):
                    columns.put(w.load(vector(bits, columns.lanes), w.offset(x, i * size), size), j, number(i))
            b.branch(done)
    otherwise()
    b.branch(done)
    b.position_at_end(done)


def block_out(
    columns: Columns, array: Record, width: int, block: int, sound: Sound, otherwise: Callable[[], object]
) -> None:
    """Scatter it likewise."""
    w, b, size = columns.w, columns.w.builder, columns.size
    base, row, column, _ = array
    done = b.append_basic_block("scattered")
    with b.if_then(b.icmp_signed("==", column, number(size))):
        with w.loop(number(block), columns.lanes) as i:
            rows = _rows(w, base, row, i, columns.lanes)
            _ahead(w, rows, row, AHEAD, width * size, write=True)
            rows_out(columns, width, rows, i, sound)
        b.branch(done)
    with b.if_then(b.icmp_signed("==", row, number(size))):
        for j in _each(w, width):
            x = w.offset(base, b.mul(j, column))
            w.prefetch(w.offset(x, size * AHEAD), write=True)
            for i in range(0, block, columns.lanes):
                w.store(sound.seen(columns.get(j, number(i))), w.offset(x, i * size), size)
        b.branch(done)
    otherwise()
    b.branch(done)
    b.position_at_end(done)


def _rows(w: Writer, base: ir.Value, row: ir.Value, state: ir.Value, lanes: int) -> list[ir.Value]:
    """LANES rows from a state on."""
    b = w.builder
    first = w.offset(base, b.mul(state, row))
    return [first, *(w.offset(first, b.mul(number(k), row)) for k in range(1, lanes))]


def _ahead(w: Writer, rows: Sequence[ir.Value], row: ir.Value, states: int, size: int, write: bool = False) -> None:
    """Fetch the rows, of so many bytes, that are so many states ahead."""
    further = w.builder.mul(row, number(states))
    for x in rows:
        for line in range(0, size, LINE):
            w.prefetch(w.offset(w.offset(x, further), line), write)


def _each(w: Writer, width: int) -> Iterator[ir.Value]:
    """All columns, one behind the other where they are few."""
    if width <= UNROLLED:
        yield from map(number, range(width))
    else:
        with w.loop(number(width)) as j:
            yield j


def _vectors(w: Writer, layout: Layout, full: ir.Value) -> Iterator[ir.Value]:
    """First states of all vectors, some in a turn of a loop."""
    b, turn = w.builder, layout.lanes * TOGETHER
    together = b.and_(full, number(-turn))
    with w.loop(together, turn) as i:
        for k in range(TOGETHER):
            yield w.plus(i, k * layout.lanes)
    with w.loop(full, layout.lanes, together) as i:
        yield i
