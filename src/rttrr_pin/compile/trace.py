"""From a robot to its program: the reference recursion, run on scalars that record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rttrr_pin.compile.constants import ConstantWithError
from rttrr_pin.compile.expression import Graph, Node, Op, of_number
from rttrr_pin.compile.fields import PayloadSlot, inputs_read, outputs_of
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.quantities import QUANTITIES, Motion
from rttrr_pin.compile.regrouping import regroup
from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import Arithmetic


def trace(
    model: Model,
    outputs: Sequence[str],
    payloads: Sequence[PayloadSlot] = (),
    regrouped: bool = True,
    most: int | None = None,
    with_errors: bool = False,
) -> Program:
    """The program of a robot.

    Args:
        model: the robot.
        outputs: names from `QUANTITIES`.
        payloads: where payloads act.
        regrouped: whether inertia may be moved between links where that leaves the outputs as they are.
        most: nodes to record before giving up; None for any number.
        with_errors: whether numbers of the model carry a bound on their error (`ConstantWithError`), and so do those
            that they fold into.

    Returns:
        The program as the operations of the recursion leave it.

    Raises:
        GraphFullError: it takes more nodes.
    """
    graph = Graph(most=most)
    arithmetic = TRACING_WITH_ERRORS if with_errors else TRACING
    results = record(graph, arithmetic, model, outputs, payloads, regrouped)
    return Program(graph, inputs_read(model, outputs, payloads), outputs_of(model, outputs), results)


def record(
    graph: Graph,
    arithmetic: Arithmetic,
    model: Model,
    outputs: Sequence[str],
    payloads: Sequence[PayloadSlot],
    regrouped: bool = True,
) -> tuple[int, ...]:
    """Run the reference recursion on nodes of a graph, whose first inputs are the numbers of `inputs_read`.

    As `trace`, but that the arithmetic may be one made from `TRACING`. Returns the nodes of the outputs' numbers.
    """
    wanted = [QUANTITIES[name] for name in outputs]
    links: Sequence[Body] | None = None
    if regrouped and not any(quantity.of_links for quantity in wanted):
        model, links = regroup(model, bodies(model, arithmetic))
    inputs = inputs_read(model, outputs, payloads)
    columns = (Node(graph, graph.input(index)) for index in range(sum(field.width for field in inputs)))
    values = {field.name: [next(columns) for _ in range(field.width)] for field in inputs}
    motion = Motion(
        model,
        arithmetic,
        values.get("q", []),
        values.get("v", []),
        values.get("a", []),
        payloads=[
            Payload(slot.link, Vector(*values[f"payload_{k}_f"]), Vector(*values[f"payload_{k}_n"]), slot.in_base)
            for k, slot in enumerate(payloads)
        ],
        links=links,
    )
    scalars: list[Any] = [x for quantity in wanted for x in quantity.scalars(motion)]
    return tuple(x.number if isinstance(x, Node) else graph.constant(x) for x in scalars)


def _keep(vector: Vector) -> Vector:
    for scalar in vector:
        if isinstance(scalar, Node):
            scalar.graph.kept.add(scalar.number)
    return vector


def _sincos(q: Any) -> tuple[Scalar, Scalar]:
    """Also of a plain number: a locked joint stands still, and one that follows another with multiplier 0."""
    if isinstance(q, Node):
        return q.function(Op.SIN), q.function(Op.COS)
    return of_number(Op.SIN, q), of_number(Op.COS, q)


def _sign(x: Any) -> Scalar:
    return x.function(Op.SIGN) if isinstance(x, Node) else float((x > 0) - (x < 0))


TRACING = Arithmetic(number=lambda value, error: value, column=lambda x: x, sincos=_sincos, sign=_sign, keep=_keep)
"""The arithmetic that records; numbers of the model stay floats and fold among themselves."""

TRACING_WITH_ERRORS = replace(TRACING, number=ConstantWithError)
"""The same; numbers of the model carry a bound on their error."""
