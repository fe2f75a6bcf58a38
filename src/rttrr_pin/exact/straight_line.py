"""The reference recursion of one robot as a straight-line program, to be run in interval arithmetic many times.

The compiler's tracer records it with rational constants: products with 0 or 1 and sums of constants are folded exactly,
equal operations are done once, nothing is rounded and no inertia is regrouped. What depends on the robot's parameters
alone (sines of rpy, lengths of axes, turned tensors) is computed once for each precision.
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
from rttrr_pin.exact.intervals import LoadFrames, Run, flat_dynamics, interval
from rttrr_pin.exact.parameters import Parameters, exact_parameters

FORM = {
    Op.ADD: "{} + {}",
    Op.SUB: "{} - {}",
    Op.MUL: "{} * {}",
    Op.NEG: "-{}",
    Op.SIGN: "{}.sgn()",
}
"""Each operation on intervals, in Python; sine and cosine come as a pair."""

StraightLine = tuple[Callable[[], Run], NDArray[np.intp]]
"""What prepares, at the precision in force, the evaluation of states; and for each number the index of its result."""


@dataclass(eq=False)
class ExactGraph(Graph):
    """The tracer's graph with rational constants."""

    value: dict[int, Any] = field(default_factory=dict)

    def constant(self, value: Any) -> int:
        """The node of an exact number."""
        exact = value if isinstance(value, Fraction) else Fraction(value)
        node = self._node(Op.CONSTANT, (exact.numerator, exact.denominator))
        self.args[node] = ()
        self.value[node] = exact
        return node

    def function(self, op: Op, x: int) -> int:
        """Sine, cosine or sign; folded for constants where the result is rational."""
        if self.op[x] is Op.CONSTANT:
            value = self.value[x]
            if op is Op.SIGN:
                return self.constant((value > 0) - (value < 0))
            if value == 0:
                return self.constant(int(op is Op.COS))
            return self._node(op, (x,))
        return super().function(op, x)


@lru_cache(maxsize=16)
def straight_line(model: Model, frames: LoadFrames, parameters: Parameters) -> StraightLine:
    """Record the recursion of a robot, whose inputs are q, v, a, then f and n of each payload."""
    graph = ExactGraph()
    width = model.nq + 2 * model.nv + 6 * len(frames)
    inputs = [Node(graph, graph.input(k)) for k in range(width)]
    root_inputs: dict[Fraction, int] = {}

    def inverse_root(square: Fraction) -> Node:
        return Node(graph, root_inputs.setdefault(square, graph.input(width + len(root_inputs))))

    arithmetic = Arithmetic(
        number=lambda value, error: Node(graph, graph.constant(value)),
        column=lambda x: x,
        sincos=lambda x: (x.function(Op.SIN), x.function(Op.COS)),
        sign=lambda x: x.function(Op.SIGN),
    )
    if parameters == "doubles":
        links = [body_of(*pair, arithmetic) for pair in zip(model.joints, model.links, strict=True)]
    else:
        of_file = exact_parameters(model, parameters)
        model, links = of_file.model, of_file.bodies(arithmetic, inverse_root)
    scalars = flat_dynamics(model, arithmetic, inputs, frames, links)
    results = [x.number if isinstance(x, Node) else graph.constant(x) for x in scalars]
    return _program(graph, {node: square for square, node in root_inputs.items()}, width, results)


def _program(graph: Graph, squares: dict[int, Fraction], width: int, results: list[int]) -> StraightLine:
    """Compile the recorded graph to Python functions; `squares` are those whose inverse roots are inputs."""
    # What no state changes is computed once for each precision and handed to each run.
    order = graph.reachable(results)
    constants = [x for x in order if graph.op[x] is Op.CONSTANT or x in squares]
    fixed = set(constants)
    for x in order:
        if graph.op[x] is not Op.INPUT and fixed.issuperset(graph.args[x]):
            fixed.add(x)
    preparing = [x for x in order if x in fixed.difference(constants)]
    varying = [x for x in order if x not in fixed and graph.op[x] is not Op.INPUT]
    distinct = list(dict.fromkeys(results))
    operands = {y for x in varying for y in graph.args[x]} | set(distinct)
    handed = [x for x in order if x in fixed and x in operands]
    lines = [
        *_function("prepare", [constants], _operations(graph, preparing), handed),
        *_function("run", [handed, range(width)], _operations(graph, varying), distinct),
    ]
    namespace: dict[str, Any] = {}
    exec(compile("\n".join(lines), "<straight-line program>", "exec"), namespace)
    prepare, run = namespace["prepare"], namespace["run"]
    values = [(squares[x], True) if x in squares else (Fraction(graph.value[x]), False) for x in constants]
    column = {x: k for k, x in enumerate(distinct)}

    def prepared() -> Run:
        numbers = prepare([interval(value).rsqrt() if root else interval(value) for value, root in values])
        return lambda state: run(numbers, [arb(x) for x in state])

    return prepared, np.array([column[x] for x in results], dtype=np.intp)


def _function(name: str, inputs: Sequence[Sequence[int]], body: Iterator[str], results: Sequence[int]) -> Iterator[str]:
    """The lines of a function from sequences of intervals to a list of them."""
    yield f"def {name}({', '.join(f'x{k}' for k in range(len(inputs)))}):"
    for k, nodes in enumerate(inputs):
        if nodes:
            yield f"    {', '.join(f't{x}' for x in nodes)}, = x{k}"
    yield from (f"    {line}" for line in body)
    yield f"    return [{', '.join(f't{x}' for x in results)}]"


def _operations(graph: Graph, nodes: Sequence[int]) -> Iterator[str]:
    """A line for each operation; sine and cosine of one angle share a line."""
    pairs: dict[int, dict[Op, int]] = {}
    for x in nodes:
        if graph.op[x] in (Op.SIN, Op.COS):
            pairs.setdefault(graph.args[x][0], {})[graph.op[x]] = x
    for x in nodes:
        op, args = graph.op[x], graph.args[x]
        if op not in (Op.SIN, Op.COS):
            yield f"t{x} = {FORM[op].format(*(f't{y}' for y in args))}"
        elif args[0] in pairs:  # at the first of the two
            pair = pairs.pop(args[0])
            s, c = (f"t{pair[function]}" if function in pair else "_" for function in (Op.SIN, Op.COS))
            yield f"{s}, {c} = t{args[0]}.sin_cos()"
