"""C99: the program as a file that needs nothing but the C library, for controllers and for readers.

    void NAME(const double *q, const double *v, const double *a, double *tau);

computes one state. Where there is a C compiler the same text runs here as well, so that it can be tested.
"""

from __future__ import annotations

import ctypes
import math
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rttrr_pin.compile.emit import Array, Task
from rttrr_pin.compile.emit.c_text import Dialect, comment, function_name, operations
from rttrr_pin.compile.expression import Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.float_type import FLOAT32
from rttrr_pin.compile.program import Program
from rttrr_pin.errors import InputError

COMPILERS = ("cc", "gcc", "clang")
"""Looked for in this order, after what the environment's variable CC names."""

OPTIONS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
"""Each operation is rounded by itself: with any compiler the same bits, but for the C library's sines."""


def number(x: float) -> str:
    """A float64 in C: the shortest decimal that is read back as the same number."""
    if math.isfinite(x):
        return repr(x)
    return "NAN" if math.isnan(x) else "INFINITY" if x > 0 else "-INFINITY"


def _single(x: float) -> str:
    """The float32 nearest to a number, likewise."""
    nearest = FLOAT32.rounded(x)
    return f"{np.float32(nearest)}f" if math.isfinite(nearest) else number(nearest)


def _form(f: str) -> dict[Op, str]:
    """Each operation in C, with the suffix of functions and numbers; the sign of NaN is NaN."""
    return {
        Op.ADD: "{0} + {1}",
        Op.SUB: "{0} - {1}",
        Op.MUL: "{0} * {1}",
        Op.NEG: "-{0}",
        Op.SIN: f"sin{f}({{0}})",
        Op.COS: f"cos{f}({{0}})",
        Op.SIGN: f"{{0}} > 0.0{f} ? 1.0{f} : {{0}} < 0.0{f} ? -1.0{f} : {{0}}",
        Op.ABS: f"fabs{f}({{0}})",
    }


DIALECTS = {
    "float64": Dialect("double", _form(""), number),
    "float32": Dialect("float", _form("f"), _single),
}
"""How operations are written, by the type of the numbers."""

NAME = "program"
"""Of the function, where none is asked for."""

REMARKS = (
    "Outputs are written last: they may share memory with inputs. Nothing is allocated, kept or checked; NaN and "
    "infinity come through. Compile as C99, without -ffast-math."
)


class CEmitter:
    """Writes C."""

    name = "c"
    identity = "c"
    calls = False
    fuses = False

    def emit(self, program: Program) -> bytes:
        """C source of the function, and of a loop over states with it."""
        return (_text(program, NAME, ()) + _loop(program)).encode()

    def source(self, program: Program, robot: str, labels: Mapping[str, Sequence[str]]) -> str:
        """C source for readers.

        Args:
            program: the program.
            robot: its name.
            labels: names of the entries of q, v, a.

        Returns:
            A file: a comment that says what goes in and out, and the function ROBOT_OUTPUT.
        """
        name = function_name(program, robot)
        return _text(program, name, comment(program, robot, labels, _signature(program, name), REMARKS))

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> CExecutable:
        """Compile the source into this process.

        Raises:
            InputError: there is no C compiler, or it fails.
        """
        return CExecutable(_compiled(code.decode()))


def _text(program: Program, name: str, head: Iterable[str]) -> str:
    dialect = DIALECTS[program.float_type.name]
    body = (f"    {line}" for line in operations(program, dialect, lambda field, k: f"{field.name}[{k}]"))
    return "\n".join([*head, "#include <math.h>", "", f"{_signature(program, name)} {{", *body, "}", ""])


def _signature(program: Program, name: str) -> str:
    own = program.float_type.c_name
    arguments = [f"const {own} *{field.name}" for field in program.inputs]
    return f"void {name}({', '.join([*arguments, *(f'{own} *{field.name}' for field in program.outputs)])})"


def _loop(program: Program) -> str:
    """What follows the function here: a loop over states whose numbers stand one behind the other."""
    own = program.float_type.c_name
    fields = [(f"const {own}", field) for field in program.inputs] + [(own, field) for field in program.outputs]
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

    def bind(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> Task:
        """The states of a task as arrays without gaps, whatever the strides and types of these are."""

        def task(start: int, stop: int) -> bool:
            with np.errstate(over="ignore"):
                taken = [np.ascontiguousarray(x[start:stop], dtype=outputs[0].dtype) for x in inputs]
            written = [np.empty((stop - start, x.shape[1]), dtype=x.dtype) for x in outputs]
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
