"""From a program to something that runs: one module for each way, one line for each in the registry.

An emitter turns a program into bytes that may be kept on disk, and such bytes into an executable. A new one is one new
file and one line here.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

from numpy.typing import NDArray

from rttrr_pin.errors import InputError, UnknownNameError

if TYPE_CHECKING:  # what is on disk needs nothing of what compiles
    from rttrr_pin.compile.call_program import CallProgram
    from rttrr_pin.compile.fields import Field
    from rttrr_pin.compile.program import Program

Array = NDArray[Any]
"""float64 or float32 in, the program's type out; (N, width) with any strides."""

Task = Callable[[int, int], bool]
"""Computes the states from start to stop; tells whether a result is not finite."""


One = Callable[..., Any]
"""Computes one state, or up to `FEW` in arrays of any strides: `one(q, v, a, force, moment, ..., *outputs)`, with None
for what is not read and for outputs to be allocated; all but the first may be one state for all. Returns the output, a
tuple of several, or None where it declines what was passed, or a result is not finite."""

FEW, FEW_NUMBERS = 4096, 256 * 1024
"""States that `Executable.one` computes in one call, and numbers in and out that these may have; more are worth
threads, and must not hold up Ctrl-C."""


class Executable(Protocol):
    """A program that can be run.

    Attributes:
        one: the entry for one state or few; None where there is none, and `bind` does all.
    """

    one: One | None

    def bind(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> Task:
        """The task of computing these outputs from these inputs; it may run in several threads at once."""
        ...


class Emitter(Protocol):
    """A way to run programs.

    Attributes:
        name: in the registry.
        calls: whether it takes schedules as well; else straight lines only, however long.
        fuses: whether it has fused operations; else it is given none.
    """

    name: str
    calls: bool
    fuses: bool

    @property
    def identity(self) -> str:
        """Everything that its bytes depend on but the program: versions, processor."""
        ...

    def emit(self, program: Program | CallProgram) -> bytes:
        """Translate a program."""
        ...

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> Executable:
        """Make runnable what `emit` made, now or in another process."""
        ...


RECORD = 4
"""Numbers that describe an array (N, width) to compiled code: address, distance in bytes from state to state and from
column to column, 1 for float32."""


def task(run: Callable[[int, int, int], int], executable: object, arrays: Sequence[Array]) -> Task:
    """Describe arrays once to compiled code, for any number of calls from any thread.

    Args:
        run: `int64 run(int64 *records, int64 start, int64 stop)`: 1 where a result is not finite, -1 without memory.
        executable: what holds the code, which must live as long as the task.
        arrays: inputs, then outputs.
    """
    records = array("q")
    for x in arrays:
        row, column = x.strides
        records.extend((x.__array_interface__["data"][0], row, column, x.dtype.itemsize == 4))
    address = records.buffer_info()[0]

    def part(start: int, stop: int, alive: object = (executable, records, arrays)) -> bool:
        code = run(address, start, stop)
        if code < 0:
            raise MemoryError("no memory for one block of states")
        return bool(code)

    return part


EMITTERS = ("llvm", "numpy", "c")
"""By preference; the module of the same name here has a function `emitter()`."""

ON_DEVICES = ("cuda",)
"""Likewise; what these make takes no arrays of the host, see `rttrr_pin.compile.device`."""


def emitter(name: str | None = None) -> Emitter:
    """An emitter by name, or the first one whose compiler is there.

    Raises:
        UnknownNameError: there is none of that name.
        InputError: its compiler is not installed.
    """
    if name is None:
        return next(own for own in map(_importable, EMITTERS) if own is not None)
    if not isinstance(name, str) or name not in (*EMITTERS, *ON_DEVICES):
        raise UnknownNameError("emitter", name, (*EMITTERS, *ON_DEVICES))
    own = _importable(name)
    if own is None:
        raise InputError(f"emitter {name!r} cannot be imported: pip install rttrr-pin again, or take emitter='numpy'")
    return own


def _importable(name: str) -> Emitter | None:
    try:
        own: Emitter = import_module(f"{__name__}.{name}").emitter()
    except ImportError:
        return None
    return own
