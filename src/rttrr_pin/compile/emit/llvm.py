"""Machine code for this processor by LLVM, through llvmlite.

Code that is on disk is loaded by what is here; `llvm_module` makes it.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from collections.abc import Sequence
from functools import cache, cached_property
from importlib import import_module
from typing import TYPE_CHECKING

import llvmlite
import llvmlite.binding as llvm

from rttrr_pin.compile.emit import Array, One, Task, task
from rttrr_pin.compile.threads import COMPILING

if TYPE_CHECKING:
    from rttrr_pin.compile.call_program import CallProgram
    from rttrr_pin.compile.fields import Field
    from rttrr_pin.compile.program import Program

OPTIMISATION = 2

ELF = sys.platform == "linux" and platform.machine() == "x86_64"
"""Whether assembly is of the kind that `llvm_module.beside_code` knows."""

CPU, CPU_FEATURES = "RTTRR_PIN_CPU", "RTTRR_PIN_CPU_FEATURES"
"""Variables of the environment that choose another processor than the one at hand, by LLVM's names."""


def _processor() -> tuple[str, str]:
    """Name and features of the processor to compile for; the environment may choose another."""
    name = os.environ.get(CPU) or llvm.get_host_cpu_name()
    named = CPU in os.environ
    features = os.environ.get(CPU_FEATURES, "" if named else llvm.get_host_cpu_features().flatten())
    return name, features


def vector_bits(name: str, features: str) -> int:
    """How many bits of numbers the processor computes with at once."""
    if "+avx512f" in features.split(","):
        return 512
    if "+avx2" in features.split(","):
        return 256
    if features:
        return 128
    wide = ("avx512", "icelake", "sapphirerapids", "graniterapids", "emeraldrapids", "cascadelake", "znver4", "znver5")
    return 512 if any(word in name for word in wide) else 256


class LlvmEmitter:
    """Compiles for the processor at hand."""

    name = "llvm"
    calls = True
    fuses = True

    def __init__(self) -> None:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        llvm.initialize_native_asmparser()
        self.processor, self.features = _processor()
        version = ".".join(map(str, llvm.llvm_version_info))
        self.identity = (
            f"llvm {version} {llvmlite.__version__} {llvm.get_process_triple()} {self.processor} {self.features}"
        )

    def _machine(self, level: int = OPTIMISATION, code_model: str = "jitdefault") -> llvm.TargetMachine:
        target = llvm.Target.from_default_triple()
        return target.create_target_machine(
            cpu=self.processor, features=self.features, opt=level, jit=True, reloc="pic", codemodel=code_model
        )

    def emit(self, program: Program | CallProgram) -> bytes:
        """Object code."""
        from rttrr_pin.compile.emit.llvm_module import module  # llvmlite's builder, not needed for what is on disk
        from rttrr_pin.compile.program import Program

        level = 0 if isinstance(program, Program) and program.quickly else OPTIMISATION
        machine = self._machine(level)
        lanes = vector_bits(self.processor, self.features) // program.float_type.bits
        near = self._machine(level, "small") if ELF else None
        code: bytes = machine.emit_object(module(program, lanes, machine, level, near))
        return code

    def load(self, code: bytes, inputs: Sequence[Field], outputs: Sequence[Field]) -> LlvmExecutable:
        """Link object code into this process."""
        link_numpy()
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), self._machine())
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return LlvmExecutable(engine)


METH_FASTCALL = 0x0080

NUMPY_API = {"PyArray_Type": 2, "PyArray_New": 93, "PyArray_GetPtr": 160}
"""Places in NumPy's table of its C API, as in its header `__multiarray_api.h`: they never change."""


class _Method(ctypes.Structure):
    """PyMethodDef."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


_alive: list[object] = []
"""CPython keeps pointers to method definitions."""


@cache
def link_numpy() -> None:
    """Let compiled code find what it uses of NumPy, as `import_array()` does for extensions in C."""
    get = ctypes.PYFUNCTYPE(ctypes.POINTER(ctypes.c_void_p), ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    table = get(import_module("numpy._core._multiarray_umath")._ARRAY_API, None)
    for name, entry in NUMPY_API.items():
        llvm.add_symbol(name, table[entry])


def python_function(address: int) -> One | None:
    """The compiled function at an address as a callable (ctypes takes longer to hand over four arrays than one state).

    None where there is none, and where pointers have not the 64 bits that it expects.
    """
    if not address or ctypes.sizeof(ctypes.c_void_p) != 8:
        return None
    method = _Method(b"one", address, METH_FASTCALL, None)
    _alive.append(method)
    make = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)(
        ("PyCFunction_NewEx", ctypes.pythonapi)
    )
    function: One = make(ctypes.addressof(method), None, None)
    return function


class LlvmExecutable:
    """Machine code in memory; it lives as long as this object."""

    def __init__(self, engine: llvm.ExecutionEngine) -> None:
        self._engine = engine
        signature = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)
        self._run = signature(engine.get_function_address("run"))

    @cached_property
    def one(self) -> One | None:
        """The entry for single states; programs that were compiled quickly have none."""
        return python_function(self._engine.get_function_address("one"))

    def __del__(self) -> None:
        # While the interpreter ends, modules are gone or going, and the process gives the memory back anyway.
        if sys is not None and not sys.is_finalizing():
            with COMPILING:
                self._engine.close()

    def bind(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> Task:
        """See `task`."""
        return task(self._run, self, (*inputs, *outputs))


@cache
def emitter() -> LlvmEmitter:
    """The one of this process."""
    return LlvmEmitter()
