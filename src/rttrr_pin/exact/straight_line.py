"""The specification as a list of operations without branches, for one robot, to be run on balls again and again.

The kernel's tracer records it, over constants that are rationals: a product with 0 or 1 and a sum of numbers are folded
exactly, equal operations are done once, nothing is rounded and no link is merged with another. What depends on the
robot's numbers alone (sines of rpy, lengths of axes, turned tensors) is computed once for each precision.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb
from numpy.typing import NDArray

from rttrr_pin.compile.expression import Graph, Node, Op
from rttrr_pin.core.dynamics import body_of
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.exact.intervals import interval
from rttrr_pin.exact.parameters import Numbers, exact_parameters
from rttrr_pin.exact.recursion import Slots, results_of

FORM = {
    Op.ADD: "{} + {}",
    Op.SUB: "{} - {}",
    Op.MUL: "{} * {}",
    Op.NEG: "-{}",
    Op.SIGN: "{}.sgn()",
}
"""Each operation on balls, in Python; sine and cosine come as a pair."""


@dataclass(eq=False)
class ExactGraph(Graph):
    """The tracer's graph with rationals for numbers."""

    value: dict[int, Any] = field(default_factory=dict)

    def constant(self, value: Any) -> int:
        """A number of the robot, exact."""
        exact = value if isinstance(value, Fraction) else Fraction(value)
        number = self._node(Op.CONSTANT, (exact.numerator, exact.denominator))
        self.args[number] = ()
        self.value[number] = exact
        return number

    def function(self, op: Op, x: int) -> int:
        """Sine, cosine or sign; of a number other than 0, sine and cosine are left to the balls."""
        if self.op[x] is Op.CONSTANT:
            value = self.value[x]
            if op is Op.SIGN:
                return self.constant((value > 0) - (value < 0))
            if value == 0:
                return self.constant(int(op is Op.COS))
            return self._node(op, (x,))
        return super().function(op, x)


@dataclass(frozen=True, slots=True, eq=False)
class Straight:
    """Two straight lines of operations: what the robot's numbers yield, and what each state does.

    Attributes:
        constants: the robot's numbers, and of some the reciprocal of the root.
        prepare: from balls of these to what `run` needs.
        run: from that, and a state's numbers, to the results that differ.
        places: for each number of tau, F, N, f, n the place of its result.
        operations: how many `run` does.
    """

    constants: tuple[tuple[Fraction, bool], ...]
    prepare: Callable[[list[arb]], tuple[arb, ...]]
    run: Callable[[tuple[arb, ...], list[arb]], list[arb]]
    places: NDArray[np.intp]
    operations: int

    def ready(self) -> Callable[[Sequence[float]], list[arb]]:
        """A function from a state's numbers to results, to the precision in force."""
        given = [interval(value).rsqrt() if root else interval(value) for value, root in self.constants]
        known, run = self.prepare(given), self.run
        return lambda numbers: run(known, [arb(x) for x in numbers])


@lru_cache(maxsize=16)
def straight_line(model: Model, slots: Slots, numbers: Numbers) -> Straight:
    """The operations of a robot, whose inputs are q, v, a, then f and n of each payload."""
    graph = ExactGraph()
    width = model.nq + 2 * model.nv + 6 * len(slots)
    inputs = [Node(graph, graph.input(place)) for place in range(width)]
    roots: dict[Fraction, int] = {}

    def inverse_root(square: Fraction) -> Node:
        return Node(graph, roots.setdefault(square, graph.input(width + len(roots))))

    arithmetic = Arithmetic(
        number=lambda value, error: Node(graph, graph.constant(value)),
        column=lambda x: x,
        sincos=lambda x: (x.function(Op.SIN), x.function(Op.COS)),
        sign=lambda x: x.function(Op.SIGN),
    )
    if numbers == "doubles":
        bodies = [body_of(*pair, arithmetic.number) for pair in zip(model.joints, model.links, strict=True)]
    else:
        of_file = exact_parameters(model, numbers)
        model, bodies = of_file.model, of_file.bodies(arithmetic, inverse_root)
    results = results_of(model, arithmetic, inputs, slots, bodies)
    nodes = [x.number if isinstance(x, Node) else graph.constant(x) for x in results]
    return _assembled(graph, {x: square for square, x in roots.items()}, width, nodes)


def _assembled(graph: Graph, roots: dict[int, Fraction], width: int, nodes: list[int]) -> Straight:
    """Python functions of what was recorded."""
    order = graph.reachable(nodes)
    fixed: set[int] = set()
    for x in order:
        if (
            graph.op[x] is Op.CONSTANT
            or x in roots
            or (graph.op[x] is not Op.INPUT and fixed.issuperset(graph.args[x]))
        ):
            fixed.add(x)
    given = [x for x in order if graph.op[x] is Op.CONSTANT or x in roots]
    made = [x for x in order if x in fixed and x not in given]
    run = [x for x in order if x not in fixed and graph.op[x] is not Op.INPUT]
    distinct = list(dict.fromkeys(nodes))
    read = {y for x in run for y in graph.args[x]} | set(distinct)
    known = [x for x in order if x in fixed and x in read]
    lines = [
        *_function("prepare", [given], _operations(graph, made), known),
        *_function("run", [known, range(width)], _operations(graph, run), distinct),
    ]
    space: dict[str, Any] = {}
    exec(compile("\n".join(lines), "<straight>", "exec"), space)
    constants = tuple((roots[x], True) if x in roots else (Fraction(graph.value[x]), False) for x in given)
    where = {x: place for place, x in enumerate(distinct)}
    places = np.array([where[x] for x in nodes], dtype=np.intp)
    return Straight(constants, space["prepare"], space["run"], places, len(run))


def _function(name: str, given: Sequence[Sequence[int]], body: Iterator[str], returned: Sequence[int]) -> Iterator[str]:
    """A function that takes sequences of balls and returns a list of them."""
    yield f"def {name}({', '.join(f'x{k}' for k in range(len(given)))}):"
    for k, nodes in enumerate(given):
        if nodes:
            yield f"    {', '.join(f't{x}' for x in nodes)}, = x{k}"
    yield from (f"    {line}" for line in body)
    yield f"    return [{', '.join(f't{x}' for x in returned)}]"


def _operations(graph: Graph, nodes: Sequence[int]) -> Iterator[str]:
    """A line for each operation."""
    turned: dict[int, dict[Op, int]] = {}
    for x in nodes:
        if graph.op[x] in (Op.SIN, Op.COS):
            turned.setdefault(graph.args[x][0], {})[graph.op[x]] = x
    for x in nodes:
        op, args = graph.op[x], graph.args[x]
        if op not in (Op.SIN, Op.COS):
            yield f"t{x} = {FORM[op].format(*(f't{y}' for y in args))}"
        elif args[0] in turned:  # at the first of the two
            pair = turned.pop(args[0])
            s, c = (f"t{pair[one]}" if one in pair else "_" for one in (Op.SIN, Op.COS))
            yield f"{s}, {c} = t{args[0]}.sin_cos()"
