"""A GPU as kernels see it: what compiles, loads, launches, looks at arrays. Nothing else imports NVIDIA's cuda-core."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.errors import InputError

NONE = 2**64 - 1
"""In a flag: all is finite."""

FLAGS = 512
"""Flags of one piece of pinned memory, which is had by pages."""


@dataclass(frozen=True, slots=True)
class View:
    """An array of some library, as it lies in memory.

    Attributes:
        address: of its first number.
        shape: its lengths.
        strides: the distances along its axes, in numbers.
        dtype: of its numbers.
        device: the card that it is on; -1 for memory of the host.
        writable: whether results may be written there.
    """

    address: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    dtype: np.dtype[Any]
    device: int
    writable: bool


class Driver(Protocol):
    """What a kernel needs of a card.

    Attributes:
        name: the card.
        device: its number.
        identity: what compiles, and for which kind of card: everything that machine code depends on but its text.
    """

    name: str
    device: int
    identity: str

    def compile(self, text: str) -> bytes:
        """Machine code of CUDA C++."""
        ...

    def load(self, code: bytes, name: str) -> Any:
        """A function of machine code, on the card."""
        ...

    def stream(self, stream: Any) -> Any:
        """The stream that a user means; None for the default one."""
        ...

    def view(self, x: Any, stream: Any) -> View:
        """An array of any library, ordered behind what its own stream still computes."""
        ...

    def empty(self, shape: tuple[int, ...], dtype: str, stream: Any) -> Any:
        """A new array, which other libraries take by DLPack."""
        ...

    def copied(self, x: NDArray[Any], stream: Any) -> Any:
        """A new array with the numbers of one of the host."""
        ...

    def flag(self) -> ctypes.c_ulonglong:
        """A number that host and card both see at the same address."""
        ...

    def launch(
        self, function: Any, blocks: int, threads: int, arguments: Sequence[int], stream: Any
    ) -> Callable[[], None]:
        """What puts a call of a function on a stream, each time it is called."""
        ...

    def wait(self, stream: Any) -> None:
        """Wait until everything on a stream is done."""
        ...


class CudaCore:
    """The current NVIDIA card, by cuda-core."""

    def __init__(self) -> None:
        """Look for cuda-core and a card.

        Raises:
            InputError: one of them is not there.
        """
        try:
            from cuda import core
            from cuda.bindings import nvrtc
        except ImportError as error:
            raise InputError(
                f"emitter 'cuda' needs NVIDIA's cuda-core ({error}): pip install 'rttrr-pin[cuda]', or for CUDA 12 "
                "pip install 'cuda-core[cu12]'"
            ) from None
        try:
            card = core.Device()
            card.set_current()
        except Exception as error:  # of whatever class: no driver, no card, a card in use, ...
            raise InputError(
                f"emitter 'cuda' finds no NVIDIA GPU ({' '.join(str(error).split())}): run `nvidia-smi` to see whether "
                "the driver is there, or take another emitter"
            ) from None
        _, *version = nvrtc.nvrtcVersion()
        self._core, self._card = core, card
        self.name, self.device = card.name, int(card.device_id)
        self.identity = f"cuda nvrtc {version} sm_{card.arch}"
        self._pinned = core.LegacyPinnedMemoryResource()
        self._pages: list[Any] = []
        self._free: list[int] = []  # addresses of flags

    def compile(self, text: str) -> bytes:
        """See `Driver`."""
        return compiled(text, f"sm_{self._card.arch}")

    def load(self, code: bytes, name: str) -> Any:
        """See `Driver`."""
        return self._core.ObjectCode.from_cubin(code).get_kernel(name)

    def stream(self, stream: Any) -> Any:
        """See `Driver`; a stream is one of cuda-core, anything with `__cuda_stream__`, or its handle."""
        self._core.Device(self.device).set_current()  # each thread has a current card of its own
        if stream is None:
            return self._core.LEGACY_DEFAULT_STREAM
        if isinstance(stream, int):
            return self._core.Stream.from_handle(stream)
        return stream if isinstance(stream, self._core.Stream) else self._card.create_stream(stream)

    def view(self, x: Any, stream: Any) -> View:
        """See `Driver`."""
        seen = self._core.utils.StridedMemoryView.from_any_interface(x, stream_ptr=int(stream.handle))
        shape, strides = tuple(seen.shape), seen.strides
        if strides is None:
            strides = tuple(prod(shape[k + 1 :]) for k in range(len(shape)))
        device = seen.device_id if seen.is_device_accessible else -1
        return View(seen.ptr, shape, tuple(strides), seen.dtype, device, not seen.readonly)

    def empty(self, shape: tuple[int, ...], dtype: str, stream: Any) -> Any:
        """See `Driver`."""
        own = np.dtype(dtype)
        buffer = self._card.allocate(max(1, prod(shape)) * own.itemsize, stream=stream)
        return self._core.utils.StridedMemoryView.from_buffer(buffer, shape, itemsize=own.itemsize, dtype=own)

    def copied(self, x: NDArray[Any], stream: Any) -> Any:
        """See `Driver`; waits, since the array of the host may go."""
        host = np.ascontiguousarray(x)
        array = self.empty(x.shape, x.dtype.name, stream)
        source = self._core.Buffer.from_handle(host.ctypes.data, host.nbytes, owner=host)
        array.exporting_obj.copy_from(source, stream=stream)
        stream.sync()
        return array

    def flag(self) -> ctypes.c_ulonglong:
        """See `Driver`: pinned memory, which a kernel writes to only where a number is not finite."""
        if not self._free:
            size = ctypes.sizeof(ctypes.c_ulonglong)
            self._pages.append(self._pinned.allocate(FLAGS * size))
            first = int(self._pages[-1].handle)
            self._free = list(range(first, first + FLAGS * size, size))
        return ctypes.c_ulonglong.from_address(self._free.pop())

    def launch(
        self, function: Any, blocks: int, threads: int, arguments: Sequence[int], stream: Any
    ) -> Callable[[], None]:
        """See `Driver`; whole numbers of Python are passed as 64 bits, which is what all arguments have."""
        config = self._core.LaunchConfig(grid=blocks, block=threads)
        return partial(self._core.launch, stream, config, function, *arguments)

    def wait(self, stream: Any) -> None:
        """See `Driver`."""
        stream.sync()


def compiled(text: str, architecture: str, ptxas: str | None = None) -> bytes:
    """CUDA C++ compiled by NVRTC, for which no card is needed.

    Args:
        text: the source.
        architecture: of the card, such as "sm_90".
        ptxas: an option for its assembler, such as "-v", which reports on stderr.
    """
    from cuda import core

    # Products and sums are intrinsics, which are never fused; this is for what a later edition may write otherwise.
    options = core.ProgramOptions(arch=architecture, fma=False, ptxas_options=ptxas)
    program = core.Program(text, "c++", options)
    return bytes(program.compile("cubin", logs=sys.stderr if ptxas else None).code)
