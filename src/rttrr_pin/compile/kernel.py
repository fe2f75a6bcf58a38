"""The kernel as a user holds it: one robot, compiled for what is asked of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from math import prod
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rttrr_pin.compile import emit, threads
from rttrr_pin.compile.arrays import as_rows, check_out, readable, rows_in_place
from rttrr_pin.compile.emit import Emitter, One, emitter
from rttrr_pin.compile.fields import PayloadSlot, inputs_read
from rttrr_pin.compile.float_type import float_type
from rttrr_pin.compile.quantities import QUANTITIES, STRAIGHT_LINE
from rttrr_pin.compile.threads import MOST as MOST_THREADS
from rttrr_pin.compile.variant import Variant, compiled
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import common_shape, overflow
from rttrr_pin.core.inputs import Coordinates, check_quaternions, coordinates, finite
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, Payloads, loads_of
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError, UnknownNameError

if TYPE_CHECKING:
    from rttrr_pin.compile.program import Program

Result = TypeVar("Result", bound=Array | dict[str, Array])
"""What a kernel returns: an array for a single output, a dict of them by name for several."""


class Kernel(Generic[Result]):
    """A robot's dynamics, compiled.

    Made by `Robot.compile`. The first call compiles, or reads what another process has compiled before. A kernel can
    be copied and pickled: a copy, in another process as well, loads its own code.

    Attributes:
        model: the robot.
        outputs: what it computes.
        dtype: the type of all its numbers, float64 or float32.
    """

    def __init__(
        self,
        model: Model,
        outputs: str | Sequence[str],
        emitter_name: str | None = None,
        straight_line: int = STRAIGHT_LINE,
        dtype: DTypeLike = "float64",
    ) -> None:
        self.model = model
        self._single = isinstance(outputs, str)
        self.outputs: tuple[str, ...] = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        for name in self.outputs:
            if name not in QUANTITIES:
                raise UnknownNameError("output", name, tuple(QUANTITIES))
        if not self.outputs or len(set(self.outputs)) < len(self.outputs):
            raise InputError(f"outputs is {outputs!r}: name at least one, and each once, of {', '.join(QUANTITIES)}")
        self._emitter_name, self._straight_line = emitter_name, straight_line
        self._emitter: Emitter = emitter(emitter_name)
        self._float_type = float_type(dtype)
        self.dtype: np.dtype[Any] = np.dtype(self._float_type.name)
        self._variants: dict[tuple[PayloadSlot, ...], Variant] = {}
        self._inputs = "".join(field.name for field in inputs_read(model, self.outputs))
        self._floats = bool(model.quaternions)
        self._widths = {"q": model.nq, "v": model.nv, "a": model.nv}
        self._without_payload: One | None = None  # once it is compiled; of quaternions Python looks at each
        self._one: One | None = None  # the same where one array is written
        self._last: tuple[Wrench | None, One | None, tuple[Array, ...]] = (None, None, ())

    def __reduce__(self) -> tuple[object, ...]:
        outputs = self.outputs[0] if self._single else self.outputs
        return type(self), (self.model, outputs, self._emitter_name, self._straight_line, self._float_type.name)

    def __repr__(self) -> str:
        short = f" in {self.dtype}" if self.dtype != np.float64 else ""
        return f"<Kernel of {self.model.name!r}: {', '.join(self.outputs)}{short} by {self._emitter.name}>"

    @cached_property
    def program(self) -> Program:
        """The straight-line program (without payload), with the count of its operations."""
        return self._straight_lines(fused=False)

    def _straight_lines(self, fused: bool) -> Program:
        from rttrr_pin.compile.build import straight_lines

        return straight_lines(self.model, self.outputs, fused=fused, float_type=self._float_type)

    def source(self, emitter: str = "c") -> str:
        """The program (without payload) as a source file, to carry the dynamics elsewhere.

        Args:
            emitter: "c", for a C99 file with the function `void ROBOT_OUTPUT(const double *q, ..., double *output)`, or
                float where that is the kernel's type; "cuda", for CUDA C++ with the kernel `ROBOT_OUTPUT`.

        Returns:
            The file's text; a comment on top says what goes in and out.

        Raises:
            UnknownNameError: there is no such emitter.
            InputError: it writes no source.
        """
        how = emit.emitter(emitter)
        write = getattr(how, "source", None)
        if write is None:
            raise InputError(f"emitter {emitter!r} writes no source for readers: take emitter='c' or 'cuda'")
        program = self._straight_lines(fused=True) if how.fuses else self.program
        text: str = write(program, self.model.name, {name: self._labels(name) for name in self._inputs})
        return text

    def _labels(self, name: str) -> tuple[str, ...]:
        return self.model.q_names if name == "q" else self.model.v_names

    def __call__(
        self,
        q: Coordinates,
        v: Coordinates | None = None,
        a: Coordinates | None = None,
        payload: Payloads = None,
        out: Result | None = None,
        threads: int | None = None,
    ) -> Result:
        """Compute a batch of states.

        Every state goes through the same instructions, so its bits depend neither on its neighbours nor on the layout
        of the arrays nor on the threads. Memory beyond inputs and outputs does not grow with the batch.

        Args:
            q: coordinates, (..., nq) [rad or m], as in `Robot.inverse_dynamics`; what is no array of the kernel's type
                is widened or rounded to it, any strides are taken as they are (the transpose of a C-ordered (n, N) as
                well), and leading axes broadcast.
            v: rates, (..., nv); left out where the outputs do not depend on them.
            a: accelerations, (..., nv); left out likewise.
            payload: what the robot exerts on its surroundings, a `Wrench` or several; with outputs that it enters.
            out: where to write: an array of the kernel's type for a single output, a dict of them by name for several.
            threads: how many; None for as many as pay.

        Returns:
            An array (..., *shape) for outputs="name"; a dict of arrays by name for a sequence of names.

        Raises:
            ShapeError: an array has not one value for each coordinate, leading axes do not broadcast, or `out` has
                another shape.
            NumberError: a value is NaN, inf, complex, ..., or so large that the result overflows.
            InputError: an argument is missing, or too many, or `out` is no array of the type that can be written.
        """
        # A control loop calls this with one state. Each line here costs a twentieth of the dynamics.
        # Few states go on this thread, however many are allowed.
        if threads is None or (type(threads) is int and 0 < threads <= MOST_THREADS):
            if payload is None and self._one is not None:
                answer: Result | None = self._one(q, v, a, out)
            else:
                answer = self._at_once(q, v, a, payload, out)
            if answer is not None:
                return answer
        return self._general(q, v, a, payload, out, threads)

    def _at_once(self, q: Any, v: Any, a: Any, payload: Payloads, out: Any) -> Result | None:
        """One state or few by the compiled entry for them; None where it declines, or is not there or not yet."""
        # A wrench never changes, so that of the last one it is known what it means.
        last, one, numbers = (None, self._without_payload, ()) if payload is None else self._last
        if one is None or last is not payload:
            return None
        if self._single:
            answer: Result | None = one(q, v, a, *numbers, out)
            return answer
        if out is None:
            arrays = one(q, v, a, *numbers, *[None] * len(self.outputs))  # of one output, no tuple
            arrays = (arrays,) if len(self.outputs) == 1 and arrays is not None else arrays
            return None if arrays is None else cast("Result", dict(zip(self.outputs, arrays, strict=True)))
        if type(out) is not dict or out.keys() != set(self.outputs):
            return None
        arrays = one(q, v, a, *numbers, *(out[name] for name in self.outputs))
        return None if arrays is None else cast("Result", out)

    def _general(
        self, q: Any, v: Any, a: Any, payload: Payloads, out: Result | None, wanted_threads: int | None
    ) -> Result:
        """The call for whatever is passed: any outputs and payload, batches, lists, dicts, errors."""
        payloads = self._loads(payload)
        variant = self._variant(tuple(PayloadSlot(load.link, load.in_base) for load in payloads))
        if isinstance(payload, Wrench) and not self._floats:
            self._last = payload, variant.executable.one, (payloads[0].f, payloads[0].n)
        arrays = self._arrays(q, v, a)
        numbers = {
            f"payload {name} at link {load.link + 1}{f' ({k + 1})' if len(payloads) > 1 else ''}": x
            for k, load in enumerate(payloads)
            for name, x in (("force", load.f), ("moment", load.n))
        }
        batch = common_shape({name: x.shape[:-1] for name, x in (arrays | numbers).items()})
        rows = prod(batch)
        inputs = [as_rows(x, batch, rows) for x in (*arrays.values(), *numbers.values())]
        targets, results = self._targets(variant, out, batch, rows, inputs)
        count = threads.count(wanted_threads, rows * (variant.width_in + variant.width_out))
        if rows and threads.run(variant.task(inputs, targets, batch or (1,)), rows, count):
            self._explain(arrays, numbers, variant, (inputs, targets))
        for result, target in zip(results, targets, strict=True):
            if not np.may_share_memory(result, target):
                result[...] = target.reshape(result.shape)
        if out is not None:
            return out
        return cast("Result", results[0] if self._single else dict(zip(self.outputs, results, strict=True)))

    def _loads(self, payload: Payloads) -> tuple[Load, ...]:
        deaf = [name for name in self.outputs if not QUANTITIES[name].payload]
        if payload is not None and deaf:
            raise InputError(f"a payload was passed, but {deaf[0]} does not depend on it: leave it out")
        return loads_of(self.model, payload)

    def _arrays(self, q: Any, v: Any, a: Any) -> dict[str, NDArray[Any]]:
        """The arguments that the outputs depend on, checked but for NaN and infinity, which the results betray."""
        arrays = {}
        for name, x in (("q", q), ("v", v), ("a", a)):
            if (x is not None) != (name in self._inputs):
                what = "is missing" if x is None else "was passed"
                raise InputError(
                    f"{name} {what}: {', '.join(self.outputs)} depend on {', '.join(self._inputs)}; pass these"
                )
            if x is not None:
                as_it_is = readable(x, self._widths[name])
                arrays[name] = (
                    x if as_it_is else coordinates(name, x, self.model.moving, self._float_type.unit_quaternion)
                )
        if self._floats and "q" in arrays:
            q = finite("q", np.asarray(arrays["q"], dtype=np.float64), self.model.q_names)
            check_quaternions(q, self.model.moving, self._float_type.unit_quaternion)
        return arrays

    def _variant(self, slots: tuple[PayloadSlot, ...]) -> Variant:
        """The program for payloads there: from this process, from disk, or compiled now."""
        if slots not in self._variants:
            with threads.COMPILING:  # one thread compiles, the others wait and find it
                if slots not in self._variants:
                    self._variants[slots] = compiled(
                        self.model, self.outputs, slots, self._straight_line, self._emitter, self._float_type
                    )
                    if not slots and not self._floats:
                        self._without_payload = self._variants[slots].executable.one
                        self._one = self._without_payload if self._single else None
        return self._variants[slots]

    def _targets(
        self, variant: Variant, out: Any, batch: tuple[int, ...], rows: int, inputs: Sequence[NDArray[Any]]
    ) -> tuple[list[Array], list[Array]]:
        """For each output the rows to write, and the array to return."""
        passed: Mapping[str, Any] = {} if out is None else {self.outputs[0]: out} if self._single else out
        if not self._single and out is not None and (not isinstance(out, Mapping) or set(out) != set(self.outputs)):
            raise InputError(f"out must be a dict with an array for each of {', '.join(self.outputs)}")
        targets: list[Array] = []
        results: list[Array] = []
        for field in variant.outputs:
            shape = (*batch, *field.shape)
            own = passed.get(field.name)
            if own is not None:
                check_out(field.name, own, shape, self.dtype)
            elsewhere = own is not None and any(np.may_share_memory(own, x) for x in inputs)
            target = None if own is None or elsewhere else rows_in_place(own, rows, field.width)
            if own is not None and target is None and not elsewhere:
                target = own if batch else own[None]  # in parts, see `Variant.task`
            if target is None:
                target = np.empty((rows, field.width), self.dtype)
            for other, result in zip(self.outputs, results, strict=False):  # those before it
                if own is not None and np.shares_memory(own, result):
                    raise InputError(
                        f"out for {other} and {field.name} share memory: pass an array of its own for each"
                    )
            targets.append(target)
            results.append(target.reshape(shape) if own is None else own)
        return targets, results

    def _explain(
        self,
        arrays: Mapping[str, Any],
        numbers: Mapping[str, Any],
        variant: Variant,
        rows: tuple[Sequence[NDArray[Any]], Sequence[Array]],
    ) -> None:
        """Name the number that is not finite, or the state that overflows."""
        for name, x in arrays.items():
            finite(name, x, self._labels(name))
        for name, x in numbers.items():
            finite(name, x)
        inputs = [x.reshape(-1, x.shape[-1]) for x in rows[0]]
        for field, target in zip(variant.outputs, rows[1], strict=True):
            bad = np.argwhere(~np.isfinite(target.reshape(-1, field.width)))
            if len(bad):
                raise overflow(field.name, int(bad[0][0]), dict(zip(self._inputs, inputs, strict=False)))
