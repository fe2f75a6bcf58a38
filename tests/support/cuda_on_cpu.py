"""CUDA C++ compiled by the C compiler at hand and run on the CPU, so that its text is tested where there is no GPU."""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rttrr_pin.compile.emit import c, cuda_text
from rttrr_pin.compile.fields import Field

SHIM = Path(__file__).with_name("cuda_shim.h")
"""What the text finds instead of CUDA."""

OPTIONS = ("-std=gnu11", "-O1", "-ffp-contract=off", "-fPIC", "-shared", "-Wall", "-Werror=vla", "-Wno-unused")

NONE = 2**64 - 1
"""Of `first_bad`, where all is finite."""


class OnCpu:
    """A kernel's text as machine code of this processor.

    Attributes:
        threads: of a block.
        fields: of the arrays, inputs first.
    """

    def __init__(self, text: str, inputs: Sequence[Field], outputs: Sequence[Field], dtype: str) -> None:
        self.fields, self.dtype = (*inputs, *outputs), np.dtype(dtype)
        self.threads = cuda_text.shape(inputs, outputs, dtype).threads
        self._run = _compiled(f'#include "{SHIM}"\n{text}\n{_entry(self.fields, dtype)}').run

    def __call__(
        self, states: int, arrays: Sequence[np.ndarray], blocks: int | None = None, backwards: bool = False
    ) -> int:
        """Run the kernel over arrays (states, width) of any strides; returns `first_bad`."""
        bad = ctypes.c_ulonglong(NONE)
        numbers: list[object] = []
        for x in arrays:
            assert x.dtype == self.dtype
            strides = [stride // x.itemsize for stride in x.strides]
            numbers += [ctypes.c_void_p(x.ctypes.data), *map(ctypes.c_longlong, strides)]
        blocks = max(1, -(-states // self.threads)) if blocks is None else blocks
        diverged = self._run(
            blocks, self.threads, int(backwards), ctypes.c_longlong(states), *numbers, ctypes.byref(bad)
        )
        assert not diverged, "threads of a block met at different barriers"
        return bad.value


def _entry(fields: Sequence[Field], dtype: str) -> str:
    """The function that runs the kernel's threads, `int run(blocks, threads, backwards, ...arguments of the kernel)`."""
    real = cuda_text.DIALECTS[dtype].real
    own = ["long long states"]
    for field in fields:
        own += [f"{real} *{field.name}", f"long long {field.name}_row", f"long long {field.name}_column"]
    own.append("unsigned long long *first_bad")
    names = [each.replace("*", "").split()[-1] for each in own]
    kept = "".join(f"static {_renamed(each, name)};\n" for each, name in zip(own, names, strict=True))
    assigned = " ".join(f"own_{name} = {name};" for name in names)
    passed = ", ".join(f"own_{name}" for name in names)
    return (
        f"{kept}static void thread(void) {{ {cuda_text.NAME}({passed}); }}\n"
        f"int run(int blocks, int threads, int backwards, {', '.join(own)}) {{\n"
        f"    {assigned}\n    return run_blocks(thread, blocks, threads, backwards);\n}}\n"
    )


def _renamed(declaration: str, name: str) -> str:
    return declaration[: -len(name)] + f"own_{name}"


def _compiled(text: str) -> ctypes.CDLL:
    with tempfile.TemporaryDirectory(prefix="rttrr-pin-") as folder:
        path, library = Path(folder, "kernel.c"), Path(folder, "kernel.so")
        path.write_text(text)
        command = [*c.compiler(), *OPTIONS, "-o", str(library), str(path), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert not done.returncode and not done.stderr, done.stderr[:2000]
        return ctypes.CDLL(str(library))
