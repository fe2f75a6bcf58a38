"""A robot's program for payloads at certain links: from disk or compiled now, loaded, bound to the arrays of a call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile import cache
from rttrr_pin.compile.emit import Emitter, Executable
from rttrr_pin.compile.fields import Field, PayloadSlot, Widths, inputs_read, outputs_of
from rttrr_pin.compile.float_type import FloatType
from rttrr_pin.compile.quantities import BOUND
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model


@dataclass(frozen=True)
class Variant(Widths):
    """The program for payloads at certain links, loaded.

    Attributes:
        inputs: the arrays it reads.
        outputs: the arrays it writes.
        executable: what runs it.
    """

    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    executable: Executable

    def task(
        self, inputs: Sequence[NDArray[Any]], targets: Sequence[Array], batch: tuple[int, ...]
    ) -> Callable[[int, int], bool]:
        """The task of a batch; where the states of an array lie in no even rows, each part is copied in its turn."""
        rows = prod(batch)
        pairs = zip((*inputs, *targets), (*self.inputs, *self.outputs), strict=True)
        if all(x.shape == (rows, field.width) for x, field in pairs):
            return self.executable.bind(inputs, targets)

        def part(start: int, stop: int) -> bool:
            states = np.unravel_index(np.arange(start, stop), batch)
            sources = [x[start:stop] if x.ndim == 2 else x[states] for x in inputs]
            results = [np.empty((stop - start, field.width), dtype=targets[0].dtype) for field in self.outputs]
            failed = self.executable.bind(sources, results)(0, stop - start)
            for target, result, field in zip(targets, results, self.outputs, strict=True):
                if target.shape == (rows, field.width):
                    target[start:stop] = result
                else:
                    target[states] = result.reshape(-1, *field.shape)
            return failed

        return part


def compiled(
    model: Model,
    outputs: tuple[str, ...],
    slots: tuple[PayloadSlot, ...],
    straight_line: int,
    emitter: Emitter,
    float_type: FloatType,
) -> Variant:
    """The program for payloads there, from disk or compiled now; arguments as of `Kernel`."""
    longest = straight_line if emitter.calls else None
    name = cache.key(emitter.identity, fingerprint(model), repr((outputs, slots, longest, float_type.name)))
    code = cache.read(name)
    if code is None:
        from rttrr_pin.compile.build import build  # the compiler, not needed for what is on disk
        from rttrr_pin.compile.program import Program

        program = build(model, outputs, slots, longest, emitter.fuses, float_type)
        if isinstance(program, Program) and all(name.endswith(BOUND) for name in outputs):
            program = replace(program, quickly=True)
        code = emitter.emit(program)
        cache.write(name, code)
    fields_in, fields_out = inputs_read(model, outputs, slots), outputs_of(model, outputs)
    return Variant(fields_in, fields_out, emitter.load(code, fields_in, fields_out))


def fingerprint(model: Model) -> bytes:
    """Everything of a robot that a program can depend on: all data but names, the provenance of numbers included.

    Two robots of equal numbers can need two programs: a tensor that was turned is rounded, one that was read is not.
    """
    return repr([model.gravity.tobytes(), _data(model.links), _data(model.joints)]).encode()


def _data(x: object) -> object:
    """An object as what `repr` tells apart; arrays by their bits."""
    if isinstance(x, np.ndarray):
        return x.tobytes()
    if isinstance(x, tuple):
        return [_data(item) for item in x]
    if is_dataclass(x):
        return [type(x).__name__, *(_data(getattr(x, own.name)) for own in fields(x) if own.name not in UNREAD)]
    return x


UNREAD = {"name", "limits", "dynamics"}
"""What of links and joints no program reads."""
