"""Kernels for NVIDIA's GPUs: the text of `cuda_text`, compiled at run time through NVRTC for the card at hand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, cached_property
from typing import Any

from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit import One, Task, cuda_text
from rttrr_pin.compile.emit.cuda_driver import CudaCore, Driver
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.errors import InputError

LONGEST = 20_000
"""Nodes of a program that is compiled: at that length NVRTC takes a minute or two."""


class CudaEmitter:
    """Writes CUDA C++, and compiles it where there is a card."""

    name = "cuda"
    calls = True  # so that what is too large for straight lines is told by its kind, before it is written
    fuses = True

    def __init__(self, driver: Driver | None = None) -> None:
        self._given = driver

    @cached_property
    def driver(self) -> Driver:
        """The card; only what runs needs one."""
        return self._given or CudaCore()

    @property
    def identity(self) -> str:
        """What the machine code depends on."""
        return self.driver.identity

    def emit(self, program: Program | CallProgram) -> bytes:
        """Machine code.

        Raises:
            InputError: the program is too long.
        """
        if isinstance(program, CallProgram) or len(program.order) > LONGEST:
            raise InputError(
                f"{', '.join(field.name for field in program.outputs)} of this robot takes too many operations for one "
                "thread of a GPU, whose registers they would leave: take emitter='llvm', or fewer outputs"
            )
        return self.driver.compile(cuda_text.source(program))

    def source(self, program: Program, robot: str, labels: Mapping[str, Sequence[str]]) -> str:
        """CUDA C++ for readers; arguments as of `CEmitter.source`."""
        return cuda_text.source(program, robot, labels)

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> CudaFunction:
        """Load machine code onto the card."""
        return CudaFunction(self.driver.load(code, cuda_text.NAME))


class CudaFunction:
    """A program on the card."""

    one: One | None = None

    def __init__(self, handle: Any) -> None:
        self.handle = handle

    def bind(self, inputs: Sequence[Any], outputs: Sequence[Any]) -> Task:
        """Refuse arrays of the host: `DeviceKernel` takes those of the card."""
        raise InputError(
            "emitter 'cuda' computes on arrays of the GPU: make the kernel by robot.compile(emitter='cuda')"
        )


@cache
def emitter() -> CudaEmitter:
    """The one of this process."""
    return CudaEmitter()
