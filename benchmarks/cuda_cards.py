"""The card that GPU kernels are measured on, or this processor in its place: arrays and clocks."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.compile.device import DeviceKernel
from rttrr_pin.compile.emit.cuda_driver import CudaCore

sys.path.append(str(Path(__file__).parents[1] / "tests"))


class OnCard:
    """Arrays and clocks of the card."""

    def __init__(self) -> None:
        self.driver = CudaCore()  # says what is missing
        from cuda import core

        self.core = core
        self.stream = self.driver.stream(None)

    def copied(self, x: np.ndarray) -> Any:
        """An array on the card, with the same layout."""
        return self.driver.copied(np.ascontiguousarray(x), self.stream)

    def columns(self, x: np.ndarray) -> Any:
        """The transpose (N, n) of an array (n, N) on the card."""
        buffer = self.copied(x.T).exporting_obj
        view = self.core.utils.StridedMemoryView
        return view.from_buffer(buffer, x.shape, (1, len(x)), itemsize=x.itemsize, dtype=x.dtype)

    def empty(self, shape: tuple[int, ...], dtype: str) -> Any:
        """A new array of rows."""
        return self.driver.empty(shape, dtype, self.stream)

    def on_host(self, x: Any, shape: tuple[int, ...], dtype: str) -> np.ndarray:
        """The numbers of an array of rows."""
        host = np.empty(shape, dtype)
        target = self.core.Buffer.from_handle(host.ctypes.data, host.nbytes, owner=host)
        x.exporting_obj.copy_to(target, stream=self.stream)
        self.stream.sync()
        return host

    def seconds(self, run: Callable[[], object], times: int) -> float:
        """The least mean of three rounds, by events on the stream."""
        run()
        least = float("inf")
        timed = self.core.EventOptions(timing_enabled=True)
        for _ in range(3):
            start = self.stream.record(options=timed)
            for _ in range(times):
                run()
            end = self.stream.record(options=timed)
            end.sync()
            least = min(least, (end - start) * 1e-3 / times)
        return least

    def copy_rate(self) -> float:
        """Bytes a second, read and written, of a copy of 512 MiB."""
        size = 1 << 29
        device = self.core.Device()
        one, other = (device.allocate(size, stream=self.stream) for _ in range(2))
        return 2 * size / self.seconds(lambda: one.copy_to(other, stream=self.stream), 20)

    def registers(self, kernel: DeviceKernel) -> dict[str, int]:
        """What the card says of the kernel."""
        said = kernel._variant(()).executable.handle.attributes
        return {
            "registers": said.num_regs,
            "local_bytes": said.local_size_bytes,
            "shared_bytes": said.shared_size_bytes,
        }


class OnCpu:
    """The same, played by this processor."""

    def __init__(self) -> None:
        from support import cuda_on_cpu

        self.own, self.driver = cuda_on_cpu, cuda_on_cpu.CpuDriver()

    def copied(self, x: np.ndarray) -> Any:
        """See `OnCard`."""
        return self.own.OnCard(np.ascontiguousarray(x))

    def columns(self, x: np.ndarray) -> Any:
        """See `OnCard`."""
        return self.own.OnCard(np.asfortranarray(x))

    def empty(self, shape: tuple[int, ...], dtype: str) -> Any:
        """See `OnCard`."""
        return self.own.OnCard(np.zeros(shape, dtype))

    def on_host(self, x: Any, shape: tuple[int, ...], dtype: str) -> np.ndarray:
        """See `OnCard`."""
        return np.asarray(x.array)

    def seconds(self, run: Callable[[], object], times: int) -> float:
        """See `OnCard`."""
        return wall(run, 1)

    def copy_rate(self) -> float:
        """See `OnCard`."""
        return 1e9

    def registers(self, kernel: DeviceKernel) -> dict[str, int]:
        """See `OnCard`."""
        return {}


Card = OnCard | OnCpu


def wall(run: Callable[[], object], times: int) -> float:
    """The median, in seconds of the wall."""
    found = []
    for _ in range(times):
        start = time.perf_counter()
        run()
        found.append(time.perf_counter() - start)
    return float(np.median(found))
