"""The kernel as a user of a GPU holds it: arrays of CuPy, PyTorch or JAX in, and out, where they lie."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import DTypeLike

from rttrr_pin.compile.device_arrays import Placed, looked_at, placed
from rttrr_pin.compile.emit import cuda_text
from rttrr_pin.compile.emit.cuda import CudaEmitter
from rttrr_pin.compile.emit.cuda_driver import NONE, Driver, View
from rttrr_pin.compile.fields import PayloadSlot
from rttrr_pin.compile.float_type import float_type
from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.compile.quantities import STRAIGHT_LINE
from rttrr_pin.compile.variant import Variant, compiled
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Payloads
from rttrr_pin.errors import InputError, NumberError

if TYPE_CHECKING:
    from rttrr_pin.compile.emit.cuda import CudaFunction

BLOCKS = 1 << 16
"""Most blocks of one launch; their threads go on with the states that are left."""


class DeviceKernel:
    """A robot's dynamics, compiled for the current NVIDIA GPU.

    Made by `Robot.compile(..., emitter="cuda")`. The first call compiles, or reads what another process has compiled.
    A state has the same bits as in a kernel of the processor, but for sines and cosines of angles beyond 131,072 rad,
    which are CUDA's own.

    Attributes:
        model: the robot.
        outputs: what it computes.
        dtype: the type of all its numbers, float64 or float32.
        host: the kernel of the processor for the same.
    """

    def __init__(
        self, model: Model, outputs: str | Sequence[str], dtype: DTypeLike = "float64", driver: Driver | None = None
    ) -> None:
        self.model, self.host = model, Kernel[Any](model, outputs, dtype=dtype)
        self.outputs, self._single, self.dtype = self.host.outputs, isinstance(outputs, str), self.host.dtype
        self._float_type = float_type(dtype)
        self._emitter = CudaEmitter(driver)
        self._driver = self._emitter.driver  # now, so that what is missing is said before the first call
        self._variants: dict[tuple[PayloadSlot, ...], Variant] = {}
        self._flags: list[ctypes.c_ulonglong] = []  # those that no call holds

    def __repr__(self) -> str:
        return (
            f"<DeviceKernel of {self.model.name!r}: {', '.join(self.outputs)} in {self.dtype} on {self._driver.name}>"
        )

    def source(self, emitter: str = "cuda") -> str:
        """The program as a source file; see `Kernel.source`."""
        return self.host.source(emitter)

    def __call__(
        self, q: Any, v: Any = None, a: Any = None, payload: Payloads = None, out: Any = None, stream: Any = None
    ) -> Any:
        """Compute a batch of states, and wait for it.

        Args:
            q: coordinates, (..., nq) [rad or m]: an array on this GPU, of any library that has DLPack or
                `__cuda_array_interface__`, of the kernel's type, its states at even distances. The length of
                quaternions is not looked at (but counts in `tau_bound`).
            v: rates, (..., nv); left out where the outputs do not depend on them.
            a: accelerations, (..., nv); left out likewise.
            payload: what the robot exerts on its surroundings, a `Wrench` or several, with numbers of the host.
            out: where to write: such an array for a single output, a dict of them by name for several. It may be one
                of the inputs.
            stream: the CUDA stream to compute on, anything with `__cuda_stream__` or its handle; None for the default.

        Returns:
            `out`, or new arrays (..., *shape) of the library of q (one that exports DLPack where that library cannot
            be told); a dict of them by name for a sequence of names.

        Raises:
            ShapeError: an array has another shape.
            NumberError: a result is not finite.
            InputError: an argument is missing, or too many, or no array of this GPU.
        """
        flag = self._flags.pop() if self._flags else self._driver.flag()
        try:
            launch = self._prepared(flag, q, v, a, payload, out, stream)
            launch()
            launch.check()
        finally:
            self._flags.append(flag)
        return launch.out

    def bind(
        self, q: Any, v: Any = None, a: Any = None, payload: Payloads = None, out: Any = None, stream: Any = None
    ) -> Launch:
        """Prepare a call to be made many times, on what the arrays hold by then; arguments as of a call."""
        return self._prepared(self._driver.flag(), q, v, a, payload, out, stream)

    def _prepared(
        self, flag: ctypes.c_ulonglong, q: Any, v: Any, a: Any, payload: Payloads, out: Any, stream: Any
    ) -> Launch:
        driver, own = self._driver, self._driver.stream(stream)
        loads = self.host._loads(payload)
        variant = self._variant(tuple(PayloadSlot(load.link, load.in_base) for load in loads))
        given = self._given(q, v, a)
        with np.errstate(over="ignore"):  # infinite in float32, which results show
            given += [driver.copied(x.astype(self.dtype), own) for load in loads for x in (load.f, load.n)]
        views = [self._view(field.name, x, own) for field, x in zip(variant.inputs, given, strict=True)]
        leading = [view.shape[:-1] for view in views]
        batch = next((axes for axes in leading if prod(axes) != 1), max(leading, key=len, default=()))
        inputs = [placed(field.name, view, batch, field) for field, view in zip(variant.inputs, views, strict=True)]
        results = self._results(variant, out, batch, own)
        targets = [
            placed(f"out for {field.name}", self._view(f"out for {field.name}", x, own, True), batch, field, True)
            for field, x in zip(variant.outputs, results, strict=True)
        ]
        self._check_apart(variant, inputs, targets, prod(batch))
        flag.value = NONE
        numbers = [n for x in (*inputs, *targets) for n in (x.address, x.row, x.column)]
        if out is None:
            results = [_in_library_of(q, x) for x in results]
            out = results[0] if self._single else dict(zip(self.outputs, results, strict=True))
        rows, enqueue = prod(batch), _nothing
        if rows:
            threads = cuda_text.shape(variant.inputs, variant.outputs, self._float_type).threads
            blocks = min(-(-rows // threads), BLOCKS)
            handle = cast("CudaFunction", variant.executable).handle
            enqueue = driver.launch(handle, blocks, threads, (rows, *numbers, ctypes.addressof(flag)), own)
        return Launch(out, enqueue, partial(driver.wait, own), flag, batch, self.outputs, (given, results))

    def _variant(self, slots: tuple[PayloadSlot, ...]) -> Variant:
        if slots not in self._variants:
            self._variants[slots] = compiled(
                self.model, self.outputs, slots, STRAIGHT_LINE, self._emitter, self._float_type
            )
        return self._variants[slots]

    def _given(self, *arrays: Any) -> list[Any]:
        """The arrays that the outputs depend on."""
        read = self.host._inputs
        for name, x in zip("qva", arrays, strict=True):
            if (x is not None) != (name in read):
                what = "is missing" if x is None else "was passed"
                raise InputError(f"{name} {what}: {', '.join(self.outputs)} depend on {', '.join(read)}; pass these")
        return [x for x in arrays if x is not None]

    def _view(self, name: str, x: Any, stream: Any, written: bool = False) -> View:
        return looked_at(self._driver, name, x, stream, self.dtype, written)

    def _results(self, variant: Variant, out: Any, batch: tuple[int, ...], stream: Any) -> list[Any]:
        """The arrays to write, new ones where none are passed."""
        if out is None:
            name = self._float_type.name
            return [self._driver.empty((*batch, *field.shape), name, stream) for field in variant.outputs]
        if self._single:
            return [out]
        if not isinstance(out, Mapping) or set(out) != set(self.outputs):
            raise InputError(f"out must be a dict with an array for each of {', '.join(self.outputs)}")
        return [out[field.name] for field in variant.outputs]

    def _check_apart(self, variant: Variant, inputs: list[Placed], targets: list[Placed], rows: int) -> None:
        """Results may lie number by number over an input, but not between the addresses of anything else."""
        fields, arrays, size = (*variant.inputs, *variant.outputs), (*inputs, *targets), self._float_type.size
        ranges = [x.range(rows, field.width, size) for field, x in zip(fields, arrays, strict=True)]
        for k in range(len(inputs), len(fields)):
            for other in range(k):
                over_input = other < len(inputs) and arrays[k] == arrays[other]
                if over_input and fields[k].width == fields[other].width:
                    continue
                if ranges[k][0] < ranges[other][1] and ranges[other][0] < ranges[k][1]:
                    raise InputError(
                        f"out for {fields[k].name} shares memory with {fields[other].name}: pass an array of its own"
                    )


@dataclass(frozen=True, eq=False)
class Launch:
    """A call with its arrays, to be put on its stream any number of times.

    Attributes:
        out: the results, once the stream has come so far.
    """

    out: Any
    _enqueue: Callable[[], None]
    _wait: Callable[[], None]
    _flag: ctypes.c_ulonglong
    _batch: tuple[int, ...]
    _outputs: tuple[str, ...]
    _alive: object

    def __call__(self) -> None:
        """Put the call on the stream; nothing is waited for."""
        self._enqueue()

    def check(self) -> None:
        """Wait for the stream.

        Raises:
            NumberError: in one of the calls since the last check a result was not finite; the others are computed.
        """
        self._wait()
        state, self._flag.value = self._flag.value, NONE
        if state == NONE:
            return
        index = tuple(int(k) for k in np.unravel_index(state, self._batch))
        raise NumberError(
            f"{', '.join(self._outputs)} of state {', '.join(map(str, index)) or 0}: a number overflows, or one of the "
            "inputs is NaN or infinite",
            name=self._outputs[0],
            index=index,
        )


def _nothing() -> None:
    """The call of a batch without states."""


def _in_library_of(x: Any, result: Any) -> Any:
    """A result as an array of the library that x is of."""
    of_type: Any = sys.modules.get(type(x).__module__.partition(".")[0])
    library = x.__array_namespace__() if hasattr(x, "__array_namespace__") else of_type
    return library.from_dlpack(result) if hasattr(library, "from_dlpack") else result
