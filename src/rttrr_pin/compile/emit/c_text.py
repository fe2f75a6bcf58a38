"""What languages of the C family have in common: a program's operations, names, and the comment on top for readers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap

from rttrr_pin.compile.expression import LEAVES, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program

UNITS = {
    "q": "rad or m",
    "v": "rad/s or m/s",
    "a": "rad/s^2 or m/s^2",
    "tau": "N m or N",
    "tau_joint": "N m or N",
    "nonlinear_effects": "N m or N",
    "gravity_torque": "N m or N",
    "F": "N",
    "N": "N m",
    "f": "N",
    "n": "N m",
    "mass_matrix": "kg m^2, kg m or kg",
}
"""Of what goes in and out; the rest is in SI units too."""

WIDTH = 110
"""Characters in a line of the comment."""

Place = Callable[[Field, int], str]
"""Where number k of an array stands, as an expression that can be read and assigned to."""


@dataclass(frozen=True)
class Dialect:
    """How a language writes operations.

    Attributes:
        real: the type of the numbers.
        form: each operation, with its operands in braces.
        number: a constant.
        sincos: the function `void sincos(x, &sine, &cosine)` for both at once; None where the forms do.
    """

    real: str
    form: Mapping[Op, str]
    number: Callable[[float], str]
    sincos: str | None = None


def operations(program: Program, dialect: Dialect, place: Place, early: bool = False) -> Iterator[str]:
    """The body of a function: all inputs read, operations in order, outputs written.

    Args:
        program: the program.
        dialect: how it is written.
        place: where inputs and outputs stand.
        early: whether an output is written once it is computed, so that no register has to keep it; else all at last.
    """
    op, args = program.graph.op, program.graph.args
    entries = _entries(program.inputs)
    names = {x: _name(program, dialect, entries, x) for x in program.order}
    for x in program.order:
        if op[x] is Op.INPUT:
            yield f"const {dialect.real} {names[x]} = {place(*entries[args[x][0]])};"
    written: dict[int, list[str]] = {}
    for (field, k), x in zip(_entries(program.outputs), program.results, strict=True):
        written.setdefault(x, []).append(f"{place(field, k)} = {names[x]};")
    angles: set[int] = set()
    for x in program.order:
        if op[x] not in LEAVES:
            yield from _operation(program, dialect, names, angles, x)
            if early:
                yield from written.pop(x, ())
    for lines in written.values():
        yield from lines


def _operation(program: Program, dialect: Dialect, names: Mapping[int, str], angles: set[int], x: int) -> Iterator[str]:
    """The operation of a node; `angles` are those whose sine and cosine there are."""
    op, args = program.graph.op[x], program.graph.args[x]
    if not (dialect.sincos and op in (Op.SIN, Op.COS)):
        yield f"const {dialect.real} {names[x]} = {dialect.form[op].format(*(names[y] for y in args))};"
        return
    angle = args[0]
    if angle not in angles:
        angles.add(angle)
        yield f"{dialect.real} sin{angle}, cos{angle};"
        yield f"{dialect.sincos}({names[angle]}, &sin{angle}, &cos{angle});"
    yield f"const {dialect.real} {names[x]} = {op.name.lower()}{angle};"


def results(program: Program, dialect: Dialect) -> list[str]:
    """The name of each number of the outputs, or its value."""
    entries = _entries(program.inputs)
    return [_name(program, dialect, entries, x) for x in program.results]


def _entries(fields: Sequence[Field]) -> list[tuple[Field, int]]:
    return [(field, k) for field in fields for k in range(field.width)]


def _name(program: Program, dialect: Dialect, entries: Sequence[tuple[Field, int]], x: int) -> str:
    """The name of a node; of a constant its value."""
    graph = program.graph
    if graph.op[x] is Op.CONSTANT:
        return dialect.number(graph.value[x])
    if graph.op[x] is Op.INPUT:
        field, k = entries[graph.args[x][0]]
        return f"{field.name}{k}"
    return f"t{x}"


def function_name(program: Program, robot: str) -> str:
    """ROBOT_OUTPUT."""
    return identifier("_".join((robot, *(field.name for field in program.outputs))))


def identifier(text: str) -> str:
    """A name that C takes."""
    name = re.sub(r"\W", "_", text, flags=re.ASCII)
    return name if name[:1].isalpha() else f"robot_{name}"


def comment(
    program: Program, robot: str, labels: Mapping[str, Sequence[str]], signature: str, remarks: str
) -> Iterator[str]:
    """The comment on top: the robot, the function, what goes in and out, and what else is to be known.

    Args:
        program: the program.
        robot: its name.
        labels: names of the entries of q, v, a.
        signature: of the function.
        remarks: sentences.
    """
    yield f"/* {_plain(robot)}: {', '.join(field.name for field in program.outputs)} of one state, by rttrr-pin."
    yield ""
    yield from _wrapped(f"{signature};", 6)
    yield ""
    for field in program.inputs:
        entries = ", ".join(map(_plain, labels.get(field.name, ())))
        yield from _wrapped(f"{_declared(field)}: {entries}" if entries else _declared(field), 6)
    for field in program.outputs:
        ordered = field.shape == tuple(x.width for x in program.inputs if x.name == "v")
        yield from _wrapped(f"{_declared(field)}, written{', in the order of v' if ordered else ''}", 6)
    yield ""
    yield from _wrapped(f"{program.operations}.")
    yield from _wrapped(f"{remarks} */")


def _plain(name: str) -> str:
    """A name that may stand in a comment."""
    return re.sub(r"[^\w .,:()+-]", "?", name, flags=re.ASCII)


def _declared(field: Field) -> str:
    """Name, size and unit of an array."""
    lengths = " x ".join(map(str, field.shape))
    rows = f", {lengths} row by row" if len(field.shape) > 1 else ""
    return f"{field.name}[{field.width}] [{UNITS.get(field.name, 'SI units')}]{rows}"


def _wrapped(text: str, indent: int = 3) -> list[str]:
    return wrap(text, WIDTH, initial_indent="   ", subsequent_indent=" " * indent)
