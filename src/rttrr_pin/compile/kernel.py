"""The kernel as a user holds it: one robot, compiled for what is asked of it."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile import cache, emit, threads
from rttrr_pin.compile.arrays import as_rows, check_out, readable, rows_in_place
from rttrr_pin.compile.build import STRAIGHT_LINE, build
from rttrr_pin.compile.emit import Emitter, Executable, emitter
from rttrr_pin.compile.program import Field, Program, Widths
from rttrr_pin.compile.quantities import QUANTITIES
from rttrr_pin.compile.shortcut import One, shortcut
from rttrr_pin.compile.trace import PayloadSlot, fields, outputs_of
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import common_shape
from rttrr_pin.core.inputs import Coordinates, check_quaternions, coordinates, finite
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import InputError, NumberError, UnknownNameError

LoadOf = Callable[[Any], list[Load]]
"""What a user passes as payload, as loads of links."""


@dataclass(frozen=True)
class Variant(Widths):
    """The program for payloads at given links, loaded.

    Attributes:
        inputs: the arrays it reads.
        outputs: the arrays it writes.
        executable: what runs it.
    """

    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    executable: Executable


class Kernel:
    """A robot's dynamics, compiled.

    Made by `Robot.compile`. The first call compiles, or reads what another process has compiled before.

    Attributes:
        model: the robot.
        outputs: what it computes.
    """

    def __init__(
        self,
        model: Model,
        outputs: str | Sequence[str],
        loads_of: LoadOf,
        emitter_name: str | None = None,
        straight_line: int = STRAIGHT_LINE,
    ) -> None:
        self.model = model
        self._single = isinstance(outputs, str)
        self.outputs: tuple[str, ...] = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        for name in self.outputs:
            if name not in QUANTITIES:
                raise UnknownNameError("output", name, tuple(QUANTITIES))
        if not self.outputs or len(set(self.outputs)) < len(self.outputs):
            raise InputError(f"outputs is {outputs!r}: name at least one, and each once, of {', '.join(QUANTITIES)}")
        self._loads_of = loads_of
        self._straight_line = straight_line
        self._emitter: Emitter = emitter(emitter_name)
        self._variants: dict[tuple[PayloadSlot, ...], Variant] = {}
        self._lock = threading.Lock()
        self._inputs = "".join(field.name for field in fields(model, self.outputs))
        self._floats = bool(model.quaternions)
        self._widths = {"q": model.nq, "v": model.nv, "a": model.nv}
        self._one: One | None = None

    def __repr__(self) -> str:
        return f"<Kernel of {self.model.name!r}: {', '.join(self.outputs)} by {self._emitter.name}>"

    @cached_property
    def program(self) -> Program:
        """The straight-line program (without payload), with the count of its operations."""
        program = build(self.model, self.outputs, straight_line=None)
        assert isinstance(program, Program)
        return program

    def source(self, emitter: str = "c") -> str:
        """The program (without payload) as a source file, to carry the dynamics elsewhere.

        Args:
            emitter: "c", for a C99 file with the function `void ROBOT_OUTPUT(const double *q, ..., double *output)`.

        Returns:
            The file's text; a comment on top says what goes in and out.

        Raises:
            UnknownNameError: there is no such emitter.
            InputError: it writes no source.
        """
        labels = {name: _labels(name, self.model.moving) for name in self._inputs}
        return emit.source(emitter, self.program, self.model.name, labels)

    def __call__(
        self,
        q: Coordinates,
        v: Coordinates | None = None,
        a: Coordinates | None = None,
        payload: Any = None,
        out: Any = None,
        threads: int | None = None,
    ) -> Any:
        """Compute a batch of states.

        Every state goes through the same instructions, so its bits depend neither on its neighbours nor on the layout
        of the arrays nor on the threads. Memory beyond inputs and outputs does not grow with the batch.

        Args:
            q: coordinates, (..., nq) [rad or m], as in `Robot.inverse_dynamics`; float32 is widened, any strides are
                taken as they are (the transpose of a C-ordered (n, N) as well), and leading axes broadcast.
            v: rates, (..., nv); left out where the outputs do not depend on them.
            a: accelerations, (..., nv); left out likewise.
            payload: what the robot exerts on its surroundings, a `Wrench` or several; with outputs that it enters.
            out: where to write: a float64 array for a single output, a dict of them by name for several.
            threads: how many; None for as many as pay.

        Returns:
            An array (..., *shape) for outputs="name"; a dict of arrays by name for a sequence of names.

        Raises:
            ShapeError: an array has not one value for each coordinate, leading axes do not broadcast, or `out` has
                another shape.
            NumberError: a value is NaN, inf, complex, ..., or so large that the result overflows.
            InputError: an argument is missing, or too many, or `out` is no float64 array that can be written.
        """
        one = self._one  # on this thread
        alone = threads is None or (type(threads) is int and threads == 1)
        if one is not None and payload is None and alone and one(q, v, a, out):
            return out
        _check_threads(threads)
        variant_loads = self._loads(payload)
        arrays = self._arrays(q, v, a)
        loads = {f"payload_{k}_{name}": getattr(load, name) for k, load in enumerate(variant_loads) for name in "fn"}
        batch = common_shape({name: x.shape[:-1] for name, x in (arrays | loads).items()})
        rows = prod(batch)
        inputs = [as_rows(x, batch, rows) for x in (*arrays.values(), *loads.values())]
        variant = self._variant(tuple(PayloadSlot(load.link, load.in_base) for load in variant_loads))
        targets, results = self._targets(variant, out, batch, rows, inputs)
        if rows and self._run(variant, inputs, targets, rows, threads):
            self._explain(arrays, loads, variant, targets)
        return self._returned(results, targets, out)

    def _loads(self, payload: Any) -> list[Load]:
        if payload is None:
            return []
        deaf = [name for name in self.outputs if not QUANTITIES[name].payload]
        if deaf:
            raise InputError(f"a payload was passed, but {deaf[0]} does not depend on it: leave it out")
        return self._loads_of(payload)

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
                arrays[name] = x if readable(x, self._widths[name]) else coordinates(name, x, self.model.moving)
        if self._floats and "q" in arrays:
            q = finite("q", np.asarray(arrays["q"], dtype=np.float64), _labels("q", self.model.moving))
            check_quaternions(q, self.model.moving)
        return arrays

    def _variant(self, slots: tuple[PayloadSlot, ...]) -> Variant:
        """The program for payloads there: from this process, from disk, or compiled now."""
        found = self._variants.get(slots)
        if found is None:
            with self._lock:
                found = self._variants.get(slots)
                if found is None:
                    found = self._variants[slots] = self._compiled(slots)
                    if not slots and not self._floats:  # quaternions are looked at in Python
                        self._one = shortcut(found.executable.one, self._inputs, self.outputs, self._single)
                        self._answer_at_once(found.executable)
        return found

    def _answer_at_once(self, executable: Executable) -> None:
        """Let compiled code take kernel(q, v, a, out=out): a `__call__` in Python takes longer than the dynamics."""
        call = getattr(executable, "call", None)
        if call is None or not self._single or self._inputs != "qva":
            return
        self._general = partial(Kernel.__call__, self)
        answer = call(self._general, self)
        if answer is not None:
            self.__signature__ = inspect.signature(self._general)
            self.__class__ = type("Kernel", (Kernel,), {"__call__": answer, "__doc__": Kernel.__doc__})

    def _compiled(self, slots: tuple[PayloadSlot, ...]) -> Variant:
        straight_line = self._straight_line if self._emitter.calls else None
        asked = repr((self.outputs, slots, straight_line))
        name = cache.key(self._emitter.identity, fingerprint(self.model), asked)
        code = cache.read(name)
        if code is None:
            code = self._emitter.emit(build(self.model, self.outputs, slots, straight_line, self._emitter.fuses))
            cache.write(name, code)
        inputs, outputs = fields(self.model, self.outputs, slots), outputs_of(self.model, self.outputs)
        return Variant(inputs, outputs, self._emitter.load(code, inputs, outputs))

    def _targets(
        self, variant: Variant, out: Any, batch: tuple[int, ...], rows: int, inputs: Sequence[NDArray[Any]]
    ) -> tuple[list[Array], list[Array]]:
        """For each output the rows to write, and the array to return."""
        given = self._given(out)
        targets: list[Array] = []
        results: list[Array] = []
        for field in variant.outputs:
            shape = (*batch, *field.shape)
            mine = given.get(field.name)
            if mine is not None:
                check_out(field.name, mine, shape)
            elsewhere = mine is not None and any(np.may_share_memory(mine, x) for x in inputs)
            target = None if mine is None or elsewhere else rows_in_place(mine, rows, field.width)
            if target is None:
                target = np.empty((rows, field.width))
            for other, result in zip(self.outputs, results, strict=False):  # those before it
                if mine is not None and np.shares_memory(mine, result):
                    raise InputError(
                        f"out for {other} and {field.name} share memory: pass an array of its own for each"
                    )
            targets.append(target)
            results.append(target.reshape(shape) if mine is None else mine)
        return targets, results

    def _given(self, out: Any) -> Mapping[str, Any]:
        if out is None:
            return {}
        if self._single:
            return {self.outputs[0]: out}
        if not isinstance(out, Mapping) or set(out) != set(self.outputs):
            raise InputError(f"out must be a dict with an array for each of {', '.join(self.outputs)}")
        return out

    def _run(
        self, variant: Variant, inputs: Sequence[Any], targets: Sequence[Array], rows: int, wanted: int | None
    ) -> bool:
        task = variant.executable.bind(inputs, targets)
        numbers = rows * (variant.width_in + variant.width_out)
        return threads.run(task, rows, threads.count(wanted, numbers))

    def _returned(self, results: Sequence[Array], targets: Sequence[Array], out: Any) -> Any:
        for result, target in zip(results, targets, strict=True):
            if not np.may_share_memory(result, target):
                result[...] = target.reshape(result.shape)
        if out is not None:
            return out
        return results[0] if self._single else dict(zip(self.outputs, results, strict=True))

    def _explain(
        self, arrays: Mapping[str, Any], loads: Mapping[str, Any], variant: Variant, targets: Sequence[Array]
    ) -> None:
        """Name the number that is not finite, or the state that overflows."""
        for name, x in arrays.items():
            finite(name, x, _labels(name, self.model.moving))
        for name, x in loads.items():
            finite(name, x)
        for field, target in zip(variant.outputs, targets, strict=True):
            bad = np.argwhere(~np.isfinite(target))
            if len(bad):
                raise NumberError(
                    f"{field.name} overflows in state {int(bad[0][0])}: "
                    "pass coordinates of a size that a robot can have, in rad, m and s",
                    name=field.name,
                    index=(int(bad[0][0]),),
                )


def fingerprint(model: Model) -> bytes:
    """Every number of a robot that a program can depend on."""
    parts: list[object] = [model.gravity.tobytes()]
    for link, joint in zip(model.links, model.joints, strict=True):
        effects, mimic = joint.effects, joint.mimic
        parts += [link.mass, link.com.tobytes(), link.inertia.tobytes(), repr(joint.type), joint.parent]
        parts += [joint.R.tobytes(), joint.p.tobytes(), joint.axis.tobytes()]
        parts += [effects.armature, effects.damping, effects.friction]
        parts += [mimic and (mimic.joint, mimic.multiplier, mimic.offset)]
    return repr(parts).encode()


def _labels(name: str, joints: Sequence[Joint]) -> list[str]:
    return [label for joint in joints for label in (joint.q_labels() if name == "q" else joint.v_labels())]


def _check_threads(wanted: int | None) -> None:
    """Also where nothing is to be computed."""
    threads.count(wanted, 0)
