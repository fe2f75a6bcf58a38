"""What rounding can have done to each result of a program, compiled beside the results.

Each operation of the program gets a running error bound (Wilkinson; Higham, "Accuracy and Stability of Numerical
Algorithms", section 3.3), counted in units u, which is 2^-53 in float64 and 2^-24 in float32. With
|x - x_true| <= u b_x and m_x = |x| + u b_x, which is at least |x| and at least |x_true|:

    z = fl(x + y):  b_z = b_x + b_y + |z|
    z = fl(x y):    b_z = m_x b_y + m_y b_x + |z| + underflow (that is |x| b_y + |y| b_x + 2 u b_x b_y + ...)
    z = fl(x y + w), and with other signs: b_z = m_x b_y + m_y b_x + b_w + |z| + underflow
    z = sin x:      b_z = b_x + 2 ulps |z|

Terms of first order are exact; of second order one is counted twice. Inputs are the numbers that the program reads,
without error, but for quaternions: what is meant by s is s / |s|, which differs by | |s| - 1 | <= | |s|^2 - 1 | of each
component. Numbers of the robot bring their errors (`ConstantWithError`), and that of rounding them to the program's
type. Changes of sign, and products with powers of two among the robot's numbers, are exact.

The bounds are rounded too: that changes a bound by at most some u for each operation on its way, and is covered by one
factor (`FloatType.slack`). Where a product underflows, `underflow` covers what it and its bound lose. An error of a
number of the robot counts as no less in float32, so that what it is multiplied with leaves something of it; there also
products with powers of two, and sines, may lose as much.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from rttrr_pin.compile.constants import error_of, is_power_of_two
from rttrr_pin.compile.expression import FUSED, LEAVES, Graph, Node, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.quantities import BOUND


def with_bounds(
    program: Program, outputs: tuple[Field, ...], quaternions: tuple[int, ...] = (), fused: bool = False
) -> Program:
    """The program with bounds among its outputs.

    Args:
        program: whose numbers of the robot are `ConstantWithError`; its type is that of the bounds.
        outputs: names of the program's outputs, and of such with `BOUND` behind.
        quaternions: the place of the first component of each among the inputs.
        fused: whether products may be fused with sums.

    Returns:
        A program with the same operations for the values, whose outputs are these.
    """
    bounder = _Bounder(program, quaternions, fused)
    ranges = {}
    at = 0
    for output in program.outputs:
        ranges[output.name] = range(at, at + output.width)
        at += output.width
    results: list[int] = []
    for output in outputs:
        plain = output.name.removesuffix(BOUND)
        nodes = [program.results[index] for index in ranges[plain]]
        results += [bounder.bound_of(x) if output.name.endswith(BOUND) else bounder.values[x].number for x in nodes]
    return replace(program, graph=bounder.graph, outputs=outputs, results=tuple(results))


@dataclass
class _Bounder:
    """Rebuilds a program with a bound beside each node."""

    program: Program
    quaternions: tuple[int, ...]
    fused: bool
    graph: Graph = field(default_factory=Graph)
    values: dict[int, Node] = field(default_factory=dict)  # by old node
    bounds: dict[int, Node] = field(default_factory=dict)  # on their errors, in u
    depths: dict[int, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.type = self.program.float_type
        self.short = self.type.bits < 64  # so that numbers below the normal ones have to be thought of everywhere
        self.underflow = self.type.underflow / self.type.unit_roundoff
        op, args = self.program.graph.op, self.program.graph.args
        for x in self.program.order:
            self.values[x], self.bounds[x] = self._visit(x)
            self.depths[x] = 0 if op[x] in LEAVES else 1 + max(self.depths[y] for y in args[x])
            if x in self.program.graph.kept:
                self.graph.kept.add(self.values[x].number)

    def bound_of(self, x: int) -> int:
        """The node of a bound in the unit of its value."""
        return (self.bounds[x] * (self.type.unit_roundoff * self.type.slack(self.depths[x]))).number

    def _visit(self, x: int) -> tuple[Node, Node]:
        old, graph = self.program.graph, self.graph
        op, args = old.op[x], old.args[x]
        if op is Op.CONSTANT:
            value = old.value[x]
            nearest = self.type.rounded(value)
            error = error_of(value) + abs(nearest - float(value))
            return self._constant(nearest), self._constant(self._units(error))
        if op is Op.INPUT:
            return self._input(args[0]), self._length_error(args[0])
        z = Node(graph, graph.apply(op, [self.values[y].number for y in args]))
        inherited = self._inherited(op, args)
        if op in (Op.NEG, Op.ABS, Op.SIGN):
            return z, inherited
        if op in (Op.SIN, Op.COS):
            bound = self._sum(self._size(z) * (2.0 * self.type.sine_ulps), inherited)
            return z, bound + self.underflow if self.short else bound
        exact = self._is_exact(z, args)
        bound = inherited if exact else self._sum(inherited, self._size(z))
        loses = (op is Op.MUL or op in FUSED) and (self.short or not exact)
        return z, bound + self.underflow if loses else bound

    def _units(self, error: float) -> float:
        """An error in u."""
        if not self.short or not error:
            return error / self.type.unit_roundoff
        return self.type.rounded_up(max(error, self.type.underflow) / self.type.unit_roundoff)

    def _input(self, index: int) -> Node:
        return Node(self.graph, self.graph.input(index))

    def _length_error(self, index: int) -> Node:
        """How far a component of a quaternion may be from that of the unit one; 8 u cover the square's rounding."""
        for first in self.quaternions:
            if first <= index < first + 4:
                x, y, z, w = (self._input(k) for k in range(first, first + 4))
                defect = x * x + y * y + z * z + w * w - 1.0
                return self._size(self._input(index)) * (self._size(defect) * (1.0 / self.type.unit_roundoff) + 8.0)
        return self._constant(0.0)

    def _inherited(self, op: Op, args: tuple[int, ...]) -> Node:
        """What the errors of the operands do to the result."""
        if op is Op.SIGN:
            return self._constant(0.0)  # of rates, whose sign is that of an exact double
        if op is Op.MUL or op in FUSED:
            x, y, *term = args
            product = self._sum(self._most(x) * self.bounds[y], self._most(y) * self.bounds[x])
            return self._sum(product, self.bounds[term[0]]) if term else product
        total = self.bounds[args[0]]
        return self._sum(total, self.bounds[args[1]]) if len(args) > 1 else total

    def _most(self, x: int) -> Node:
        """|x| + u b_x."""
        return self._sum(self.bounds[x] * self.type.unit_roundoff, self._size(self.values[x]))

    def _sum(self, x: Node, y: Node) -> Node:
        """The sum of two bounds, none of which is negative."""
        graph = self.graph
        for product, term in ((x.number, y.number), (y.number, x.number)):
            if self.fused and graph.op[product] is Op.MUL and not graph.is_constant(term, 0):
                first, second = graph.args[product]
                return Node(graph, graph.apply(Op.FMA, (first, second, term)))
        return x + y

    def _size(self, x: Node) -> Node:
        return x.function(Op.ABS)

    def _is_exact(self, z: Node, args: tuple[int, ...]) -> bool:
        """Whether nothing was rounded: nothing was computed, or a number was doubled, halved, ..."""
        graph = self.graph
        operands = {self.values[y].number for y in args}
        bare = graph.args[z.number][0] if graph.op[z.number] is Op.NEG else z.number
        if bare in operands or graph.op[bare] in (Op.CONSTANT, Op.INPUT) or graph.neg(bare) in operands:
            return True
        first = graph.args[bare][0]
        if graph.op[bare] is not Op.MUL or graph.op[first] is not Op.CONSTANT:
            return False
        return (graph.args[bare][1] in operands or graph.neg(graph.args[bare][1]) in operands) and is_power_of_two(
            graph.value[first]
        )

    def _constant(self, value: float) -> Node:
        return Node(self.graph, self.graph.constant(value))
