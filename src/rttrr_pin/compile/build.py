"""What is compiled for a robot: straight lines where they stay short, calls of steps where the robot is too large."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rttrr_pin.compile.bounds import with_bounds
from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.expression import Graph, GraphFullError
from rttrr_pin.compile.fields import PayloadSlot, inputs_read, outputs_of
from rttrr_pin.compile.float_type import FLOAT64, FloatType
from rttrr_pin.compile.outlining import Outliner
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.quantities import BOUND, QUANTITIES, STRAIGHT_LINE
from rttrr_pin.compile.register_allocation import arranged
from rttrr_pin.compile.summation import order_sums
from rttrr_pin.compile.trace import TRACING, record, trace
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError

NODES = 3
"""Nodes that the tracer may record for each operation that an output needs: more than it does in chains about any axes,
and in the RTTRR arm, most of whose numbers are zero. A robot with more is not traced to its end."""

LONGEST = 4_000_000
"""Nodes of what cannot be made of calls: beyond it, compiling takes more minutes and memory than anyone has."""

WITH_BOUNDS = 5
"""Nodes of a program with bounds for each one without."""


def build(
    model: Model,
    outputs: Sequence[str],
    payloads: Sequence[PayloadSlot] = (),
    straight_line: int | None = STRAIGHT_LINE,
    fused: bool = False,
    float_type: FloatType = FLOAT64,
) -> Program | CallProgram:
    """The program of a robot, of the kind that suits its size.

    Args:
        model: the robot.
        outputs: names from `QUANTITIES`.
        payloads: where payloads act.
        straight_line: operations, as traced, beyond which it is made of calls; None for never.
        fused: whether products may be fused with sums; without, operations can be counted.
        float_type: to compute in. Numbers of the robot are folded in float64 first, and rounded once.

    Returns:
        Straight lines or calls, with sums in chains.

    Raises:
        InputError: the robot is too large for these outputs.
    """
    if straight_line is None or not all(QUANTITIES[name].by_steps for name in outputs):
        return straight_lines(model, outputs, payloads, fused, float_type)
    try:
        program = trace(model, outputs, payloads, most=straight_line * NODES)
    except GraphFullError:
        program = None
    if program is None or program.operations.total > straight_line:
        return call_program(model, outputs, payloads, fused=fused, float_type=float_type)
    return replace(order_sums(program, fused), float_type=float_type)


def straight_lines(
    model: Model,
    outputs: Sequence[str],
    payloads: Sequence[PayloadSlot] = (),
    fused: bool = False,
    float_type: FloatType = FLOAT64,
) -> Program:
    """The program in straight lines, however long; as `build`."""
    if any(name.endswith(BOUND) for name in outputs):
        return _bounded(model, outputs, payloads, fused, float_type)
    return replace(order_sums(_whole(model, outputs, payloads), fused), float_type=float_type)


def _bounded(
    model: Model, outputs: Sequence[str], payloads: Sequence[PayloadSlot], fused: bool, float_type: FloatType
) -> Program:
    """Values and bounds on their rounding."""
    plain = tuple(dict.fromkeys(name.removesuffix(BOUND) for name in outputs))
    program = _whole(model, plain, payloads, with_bounds=True)
    chained = replace(order_sums(program, fused), float_type=float_type)
    # q comes first among the inputs, so that places in q are places among the inputs
    quaternions = model.quaternions if any(field.name == "q" for field in program.inputs) else ()
    return with_bounds(chained, outputs_of(model, outputs), quaternions, fused)


def _whole(model: Model, outputs: Sequence[str], payloads: Sequence[PayloadSlot], with_bounds: bool = False) -> Program:
    """Straight lines, however long, but no longer than can be compiled once they have bounds."""
    most = LONGEST // WITH_BOUNDS if with_bounds else LONGEST
    try:
        return trace(model, outputs, payloads, most=most, with_errors=with_bounds)
    except GraphFullError:
        names = [name for name in outputs if not QUANTITIES[name].by_steps] or outputs
        raise InputError(
            f"{', '.join(names)} of robot {model.name!r} with {model.nv} degrees of freedom: the program has more than "
            f"{most} nodes, expected fewer; take differences of tau, or a smaller part of the robot"
        ) from None


def call_program(
    model: Model,
    outputs: Sequence[str],
    payloads: Sequence[PayloadSlot] = (),
    regrouped: bool = True,
    fused: bool = False,
    float_type: FloatType = FLOAT64,
) -> CallProgram:
    """A robot as calls, however large or small it is, for quantities with `by_steps`; arguments as of `trace`."""
    outliner = Outliner(Graph())
    arithmetic = replace(TRACING, call=outliner.call)
    results = record(outliner.graph, arithmetic, model, outputs, payloads, regrouped)
    plain = arranged(outliner, results, inputs_read(model, outputs, payloads), outputs_of(model, outputs))
    steps = tuple(replace(step, program=order_sums(step.program, fused)) for step in plain.steps)
    return replace(plain, steps=steps, float_type=float_type)
