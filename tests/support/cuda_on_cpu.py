"""CUDA C++ compiled by the C compiler at hand and run on the CPU, so that it is tested where there is no GPU."""

from __future__ import annotations

import ctypes
import re
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.compile.emit import c, cuda_text
from rttrr_pin.compile.emit.cuda_driver import NONE, View
from rttrr_pin.compile.program import Program

SHIM = Path(__file__).with_name("cuda_shim.h")
"""What the text finds instead of CUDA."""

OPTIONS = ("-std=gnu11", "-O0", "-ffp-contract=off", "-fPIC", "-shared", "-Wall", "-Wno-unused")


class OnCpu:
    """A kernel's text as machine code of this processor.

    Attributes:
        threads: of a block.
    """

    def __init__(self, program: Program) -> None:
        self.dtype = np.dtype(program.float_type.name)
        self.threads = cuda_text.shape(program.inputs, program.outputs, program.float_type).threads
        self._library = library(cuda_text.source(program))

    def __call__(
        self, states: int, arrays: Sequence[np.ndarray], blocks: int | None = None, backwards: bool = False
    ) -> int:
        """Run the kernel over arrays (states, width) of any strides; returns `first_bad`."""
        bad = ctypes.c_ulonglong(NONE)
        arguments = [states]
        for x in arrays:
            assert x.dtype == self.dtype
            arguments += [x.ctypes.data, *(stride // x.itemsize for stride in x.strides)]
        arguments.append(ctypes.addressof(bad))
        run(
            self._library,
            max(1, -(-states // self.threads)) if blocks is None else blocks,
            self.threads,
            arguments,
            backwards,
        )
        return bad.value


def run(kernel: ctypes.CDLL, blocks: int, threads: int, arguments: Sequence[int], backwards: bool = False) -> None:
    """Run all threads of all blocks."""
    diverged = kernel.run(blocks, threads, int(backwards), (ctypes.c_longlong * len(arguments))(*arguments))
    assert not diverged, "threads of a block met at different barriers"


def library(text: str) -> ctypes.CDLL:
    """The text as a library with `int run(int blocks, int threads, int backwards, long long *arguments)`."""
    declared = re.search(rf"^{cuda_text.NAME}\((.*)\) {{$", text, re.MULTILINE)
    assert declared
    types = [each.rpartition(" ")[0] + " *" * ("*" in each) for each in declared[1].split(", ")]
    passed = ", ".join(f"({own})own_arguments[{k}]" for k, own in enumerate(types))
    entry = f"""
static const long long *own_arguments;
static void own_thread(void) {{ {cuda_text.NAME}({passed}); }}
int run(int blocks, int threads, int backwards, const long long *arguments) {{
    own_arguments = arguments;
    return run_blocks(own_thread, blocks, threads, backwards);
}}
"""
    with tempfile.TemporaryDirectory(prefix="rttrr-pin-") as folder:
        path, target = Path(folder, "kernel.c"), Path(folder, "kernel.so")
        path.write_text(f'#include "{SHIM}"\n{text}{entry}')
        command = [*c.compiler(), *OPTIONS, "-o", str(target), str(path), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert not done.returncode and not done.stderr, done.stderr[:2000]
        return ctypes.CDLL(str(target))


@dataclass
class OnCard:
    """An array that pretends to be on a card."""

    array: np.ndarray
    device: int = 0
    writable: bool = True


class Library:
    """A library of such arrays."""

    @staticmethod
    def from_dlpack(x: OnCard) -> np.ndarray:
        """The array, so that a test sees that it has been asked for."""
        return x.array


@dataclass
class OfLibrary(OnCard):
    """An array that names its library."""

    def __array_namespace__(self) -> type[Library]:
        return Library


class CpuDriver:
    """A card whose kernels run on the CPU; see `rttrr_pin.compile.emit.cuda_driver.Driver`.

    Attributes:
        launches: blocks and threads of each launch.
        waits: how often a stream was waited for.
    """

    name, device, identity = "a CPU", 0, "cuda on a CPU"

    def __init__(self) -> None:
        self.launches: list[tuple[int, int]] = []
        self.waits = 0

    def compile(self, text: str) -> bytes:
        return text.encode()

    def load(self, code: bytes, name: str) -> ctypes.CDLL:
        assert name == cuda_text.NAME
        return library(code.decode())

    def stream(self, stream: Any) -> Any:
        return stream

    def view(self, x: Any, stream: Any) -> View:
        if isinstance(x, np.ndarray):
            return self._view(x, -1, True)
        if not isinstance(x, OnCard):
            raise BufferError("neither DLPack nor CUDA's array interface")
        return self._view(x.array, x.device, x.writable)

    def _view(self, x: np.ndarray, device: int, writable: bool) -> View:
        strides = tuple(stride // x.itemsize for stride in x.strides)
        return View(x.ctypes.data, x.shape, strides, x.dtype, device, writable)

    def empty(self, shape: tuple[int, ...], dtype: str, stream: Any) -> OnCard:
        return OnCard(np.full(shape, 7.0, dtype=dtype))

    def copied(self, x: np.ndarray, stream: Any) -> OnCard:
        return OnCard(x.copy())

    def flag(self) -> ctypes.c_ulonglong:
        return ctypes.c_ulonglong(7)

    def launch(
        self, function: Any, blocks: int, threads: int, arguments: Sequence[int], stream: Any
    ) -> Callable[[], None]:
        def enqueue() -> None:
            self.launches.append((blocks, threads))
            run(function, blocks, threads, arguments)

        return enqueue

    def wait(self, stream: Any) -> None:
        self.waits += 1
