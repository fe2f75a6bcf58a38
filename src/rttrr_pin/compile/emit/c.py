"""C99: the program as a file that needs nothing but the C library, for controllers and for readers.

    void NAME(const double *q, const double *v, const double *a, double *tau);

computes one state. Where there is a C compiler the same text runs here as well, so that it can be tested.
"""

from __future__ import annotations

import ctypes
import math
import os
import re
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from textwrap import wrap

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile.emit import Array, Task
from rttrr_pin.compile.expression import Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.errors import InputError

COMPILERS = ("cc", "gcc", "clang")
"""Looked for in this order, after what the environment's variable CC names."""

OPTIONS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
"""Each operation is rounded by itself: with any compiler the same bits, but for the C library's sines."""

FORM = {
    Op.ADD: "{0} + {1}",
    Op.SUB: "{0} - {1}",
    Op.MUL: "{0} * {1}",
    Op.NEG: "-{0}",
    Op.SIN: "sin({0})",
    Op.COS: "cos({0})",
    Op.SIGN: "{0} > 0.0 ? 1.0 : {0} < 0.0 ? -1.0 : {0}",
    Op.ABS: "fabs({0})",
}
"""Each operation in C; the sign of NaN is NaN."""

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

NAME = "program"
"""Of the function, where none is asked for."""

WIDTH = 110
"""Characters in a line of the comment."""


class CEmitter:
    """Writes C."""

    name = "c"
    identity = "c"
    calls = False
    fuses = False

    def emit(self, program: Program) -> bytes:
        """C source of the function alone."""
        return _text(program, NAME, []).encode()

    def source(self, program: Program, robot: str, labels: Mapping[str, Sequence[str]]) -> str:
        """C source for readers.

        Args:
            program: the program.
            robot: its name.
            labels: names of the entries of q, v, a.

        Returns:
            A file: a comment that says what goes in and out, and the function ROBOT_OUTPUT.
        """
        name = identifier("_".join((robot, *(field.name for field in program.outputs))))
        return _text(program, name, [*_comment(program, name, _plain(robot), labels)])

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> CExecutable:
        """Compile the source, and a loop over states with it, into this process.

        Raises:
            InputError: there is no C compiler, or it fails.
        """
        return CExecutable(_compiled(code.decode() + _loop(inputs, outputs)))


def identifier(text: str) -> str:
    """A name that C takes."""
    name = re.sub(r"\W", "_", text, flags=re.ASCII)
    return name if name[:1].isalpha() else f"robot_{name}"


def _plain(name: str) -> str:
    """A name that may stand in a comment."""
    return re.sub(r"[^\w .,:()+-]", "?", name, flags=re.ASCII)


def _text(program: Program, name: str, comment: list[str]) -> str:
    return "\n".join([*comment, "#include <math.h>", "", f"{_signature(program, name)} {{", *_lines(program), "}", ""])


def _signature(program: Program, name: str) -> str:
    arguments = [f"const double *{field.name}" for field in program.inputs]
    return f"void {name}({', '.join([*arguments, *(f'double *{field.name}' for field in program.outputs)])})"


def _lines(program: Program) -> Iterator[str]:
    """The function's body: inputs, operations, outputs."""
    op, args = program.graph.op, program.graph.args
    entries = [(field.name, k) for field in program.inputs for k in range(field.width)]

    def name(x: int) -> str:
        if op[x] is Op.CONSTANT:
            return number(program.graph.value[x])
        return "{}{}".format(*entries[args[x][0]]) if op[x] is Op.INPUT else f"t{x}"

    for x in program.order:
        if op[x] is Op.INPUT:
            yield "    const double {0}{1} = {0}[{1}];".format(*entries[args[x][0]])
    for x in program.order:
        if op[x] not in (Op.CONSTANT, Op.INPUT):
            yield f"    const double t{x} = {FORM[op[x]].format(*(name(y) for y in args[x]))};"
    results = iter(program.results)
    for field in program.outputs:
        for k in range(field.width):
            yield f"    {field.name}[{k}] = {name(next(results))};"


def number(x: float) -> str:
    """A float64 in C: the shortest decimal that is read back as the same number."""
    if math.isfinite(x):
        return repr(x)
    return "NAN" if math.isnan(x) else "INFINITY" if x > 0 else "-INFINITY"


def _comment(program: Program, name: str, robot: str, labels: Mapping[str, Sequence[str]]) -> Iterator[str]:
    yield f"/* {robot}: {', '.join(field.name for field in program.outputs)} of one state, by rttrr-pin."
    yield ""
    yield f"   {_signature(program, name)};"
    yield ""
    for field in program.inputs:
        entries = ", ".join(map(_plain, labels.get(field.name, ())))
        yield from _wrapped(f"{_declared(field)}: {entries}" if entries else _declared(field), 6)
    for field in program.outputs:
        ordered = field.shape == tuple(x.width for x in program.inputs if x.name == "v")
        yield from _wrapped(f"{_declared(field)}, written{', in the order of v' if ordered else ''}", 6)
    yield ""
    yield from _wrapped(f"{program.operations}.")
    yield from _wrapped(
        "Outputs are written last: they may share memory with inputs. Nothing is allocated, kept or checked; NaN and "
        "infinity come through. Compile as C99, without -ffast-math. */"
    )


def _declared(field: Field) -> str:
    """Name, size and unit of an array."""
    lengths = " x ".join(map(str, field.shape))
    rows = f", {lengths} row by row" if len(field.shape) > 1 else ""
    return f"{field.name}[{field.width}] [{UNITS.get(field.name, 'SI units')}]{rows}"


def _wrapped(text: str, indent: int = 3) -> list[str]:
    return wrap(text, WIDTH, initial_indent="   ", subsequent_indent=" " * indent)


def _loop(inputs: Sequence[Field], outputs: Sequence[Field]) -> str:
    """What follows the function here: a loop over states whose numbers stand one behind the other."""
    fields = [("const double", field) for field in inputs] + [("double", field) for field in outputs]
    declared = ", ".join(f"{type_name} *x{k}" for k, (type_name, _) in enumerate(fields))
    arguments = ", ".join(f"x{k} + i * {field.width}" for k, (_, field) in enumerate(fields))
    return f"void run(long states, {declared}) {{\n    for (long i = 0; i < states; ++i) {NAME}({arguments});\n}}\n"


def compiler() -> list[str]:
    """The C compiler's command.

    Raises:
        InputError: there is none.
    """
    for command in (os.environ.get("CC", ""), *COMPILERS):
        words = shlex.split(command)
        if words and shutil.which(words[0]):
            return words
    raise InputError(
        f"emitter 'c' runs only where there is a C compiler, and neither CC nor {', '.join(COMPILERS)} names one: "
        "install gcc, or take another emitter; `source()` needs none"
    )


def _compiled(text: str) -> ctypes.CDLL:
    """The text as a shared object in this process; its file is needed no longer then."""
    with tempfile.TemporaryDirectory(prefix="rttrr-pin-") as folder:
        source, target = Path(folder, "program.c"), Path(folder, "program.so")
        source.write_text(text)
        command = [*compiler(), *OPTIONS, "-o", str(target), str(source), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
        if done.returncode:
            raise InputError(f"{shlex.join(command)} failed: {done.stderr.strip()[:400]}; set CC to another C compiler")
        return ctypes.CDLL(str(target))


class CExecutable:
    """Machine code in memory."""

    one = None

    def __init__(self, library: ctypes.CDLL) -> None:
        self._run = library.run
        self._run.restype = None

    def bind(self, inputs: Sequence[Array], outputs: Sequence[NDArray[np.float64]]) -> Task:
        """The states of a task as arrays without gaps, whatever the strides and types of these are."""

        def task(start: int, stop: int) -> bool:
            taken = [np.ascontiguousarray(x[start:stop], dtype=np.float64) for x in inputs]
            written = [np.empty((stop - start, x.shape[1])) for x in outputs]
            pointers = [ctypes.c_void_p(x.ctypes.data) for x in (*taken, *written)]
            self._run(ctypes.c_long(stop - start), *pointers)
            for out, result in zip(outputs, written, strict=True):
                out[start:stop] = result
            return not all(np.isfinite(x).all() for x in (*taken, *written))

        return task


@cache
def emitter() -> CEmitter:
    """The one of this process."""
    return CEmitter()
