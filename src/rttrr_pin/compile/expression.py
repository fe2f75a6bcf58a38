"""The tracer: a scalar whose operations are recorded, and shared, as an expression graph.

Run on these scalars, the reference recursion leaves behind the straight-line program of one robot. Every operation goes
through one constructor, which folds what the robot's numbers decide (a product with 0 or 1, a sum of constants, a
sign) and returns the node that is there already if the same operation was recorded before (hash-consing), so that
common subexpressions are found as they arise. What no output needs is never emitted.

Nodes are in canonical form: a constant factor stands first and is positive, signs are pulled out of products and
sums as far as they go, and the two sides of + and - stand in the order of their numbers.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from rttrr_pin.compile.constants import ConstantWithError, exactly, origin_of
from rttrr_pin.core.scalars import SINE_ULPS, UNIT_ROUNDOFF

Number: TypeAlias = int | float


class Op(enum.IntEnum):
    """What a node does. Fused ones round once: x y + z, x y - z, z - x y. The norm is that of three numbers."""

    CONSTANT = 0
    INPUT = 1
    ADD = 2
    SUB = 3
    MUL = 4
    NEG = 5
    SIN = 6
    COS = 7
    SIGN = 8
    ABS = 9
    FMA = 10
    FMS = 11
    FNMA = 12
    NORM = 13


FUSED = (Op.FMA, Op.FMS, Op.FNMA)

LEAVES = (Op.CONSTANT, Op.INPUT)


class GraphFullError(Exception):
    """A graph has as many nodes as it may have."""


@dataclass(eq=False)
class Graph:
    """Nodes by number; what a node needs stands before it.

    Attributes:
        op: what each node does.
        args: numbers of the nodes that it takes; of an input its place among the inputs.
        value: of a constant.
        kept: nodes that are a finished component of w, w_dot, v_dot, F, N, f or n.
        most: nodes that it may have; None for any number.
    """

    op: list[Op] = field(default_factory=list)
    args: list[tuple[int, ...]] = field(default_factory=list)
    value: dict[int, float] = field(default_factory=dict)
    kept: set[int] = field(default_factory=set)
    most: int | None = None
    _known: dict[tuple[object, ...], int] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.op)

    def _node(self, op: Op, args: tuple[int, ...]) -> int:
        """The node of that operation, new or known."""
        # Hash-consing is all the common-subexpression elimination there is: what was recorded once is never looked for.
        key = (op, args)
        number = self._known.get(key)
        if number is None:
            number = self._known[key] = len(self.op)
            self.op.append(op)
            self.args.append(args)
            if self.most is not None and number >= self.most:
                raise GraphFullError
        return number

    def constant(self, value: Number) -> int:
        """A number of the robot; +0 and -0 are one, since no sum or product of the recursion tells them apart.

        Numbers with a bound on their error (`ConstantWithError`) share a node only where they are the same number.
        """
        key = (Op.CONSTANT, float(value) + 0.0, origin_of(value))
        number = self._known.get(key)
        if number is None:
            number = self._known[key] = len(self.op)
            self.op.append(Op.CONSTANT)
            self.args.append(())
            exact = float(value) + 0.0
            self.value[number] = (
                ConstantWithError(exact, value.error, value.origin) if isinstance(value, ConstantWithError) else exact
            )
        return number

    def input(self, index: int) -> int:
        """The input at a place."""
        return self._node(Op.INPUT, (index,))

    def is_constant(self, x: int, value: Number | None = None) -> bool:
        """Whether a node is a constant, or exactly that constant."""
        return self.op[x] is Op.CONSTANT and (value is None or exactly(self.value[x], value))

    def neg(self, x: int) -> int:
        """The opposite -x."""
        if self.op[x] is Op.CONSTANT:
            return self.constant(-self.value[x])
        return self.args[x][0] if self.op[x] is Op.NEG else self._node(Op.NEG, (x,))

    def add(self, x: int, y: int) -> int:
        """The sum x + y."""
        if self.op[x] is Op.CONSTANT and self.op[y] is Op.CONSTANT:
            return self.constant(self.value[x] + self.value[y])
        if self.is_constant(x, 0):
            return y
        if self.is_constant(y, 0):
            return x
        if self.op[y] is Op.NEG:
            return self.sub(x, self.args[y][0])
        if self.op[x] is Op.NEG:
            return self.sub(y, self.args[x][0])
        if x == y:
            return self.mul(self.constant(2), x)  # so that 2 x meets other multiples of x in one form
        return self._node(Op.ADD, (min(x, y), max(x, y)))

    def sub(self, x: int, y: int) -> int:
        """The difference x - y."""
        if x == y:
            return self.constant(0)
        if self.op[x] is Op.CONSTANT and self.op[y] is Op.CONSTANT:
            return self.constant(self.value[x] - self.value[y])
        if self.is_constant(x, 0):
            return self.neg(y)
        if self.is_constant(y, 0):
            return x
        if self.op[y] is Op.NEG:
            return self.add(x, self.args[y][0])
        if self.op[x] is Op.NEG:  # -u - y = -(u + y): the sign goes outwards, where other signs may cancel it
            return self.neg(self.add(self.args[x][0], y))
        # y - x and x - y share a node: rounding is symmetric, so the sign costs no bit.
        return self._node(Op.SUB, (x, y)) if x < y else self.neg(self._node(Op.SUB, (y, x)))

    def mul(self, x: int, y: int) -> int:
        """The product x y."""
        if self.op[x] is not Op.CONSTANT:
            x, y = y, x
        if self.op[x] is Op.CONSTANT:
            return self._scaled(self.value[x], y)
        if self.op[x] is Op.NEG:
            return self.neg(self.mul(self.args[x][0], y))
        if self.op[y] is Op.NEG:
            return self.neg(self.mul(x, self.args[y][0]))
        return self._node(Op.MUL, (min(x, y), max(x, y)))

    def _scaled(self, factor: float, y: int) -> int:
        """A constant times y."""
        if self.op[y] is Op.CONSTANT:
            return self.constant(factor * self.value[y])
        if exactly(factor, 0):
            return self.constant(0)
        if factor < 0:
            return self.neg(self._scaled(-factor, y))
        if self.op[y] is Op.NEG:
            return self.neg(self._scaled(factor, self.args[y][0]))
        if exactly(factor, 1):  # a 1 with an error is no 1: its error must reach the bound
            return y
        if self.op[y] is Op.MUL and self.op[self.args[y][0]] is Op.CONSTANT:  # numbers of the robot meet here, once
            return self._scaled(factor * self.value[self.args[y][0]], self.args[y][1])
        return self._node(Op.MUL, (self.constant(factor), y))

    def function(self, op: Op, x: int) -> int:
        """Sine, cosine, sign or absolute value; odd and even ones lose the sign of their argument."""
        if self.op[x] is Op.CONSTANT:  # the angle of a locked joint, say
            return self.constant(of_number(op, self.value[x]))
        if self.op[x] is Op.NEG:
            inner = self.function(op, self.args[x][0])
            return inner if op in (Op.COS, Op.ABS) else self.neg(inner)
        return self._node(op, (x,))

    def norm(self, x: int, y: int, z: int) -> int:
        """The Euclidean norm, as `core.arrays.norm` computes it: no square overflows or vanishes."""
        bare = [self.args[part][0] if self.op[part] is Op.NEG else part for part in (x, y, z)]
        if sum(self.is_constant(part, 0) for part in bare) == len(bare) - 1:
            return self.function(Op.ABS, next(part for part in bare if not self.is_constant(part, 0)))
        return self._node(Op.NORM, tuple(bare))

    def apply(self, op: Op, args: Sequence[int]) -> int:
        """An operation on nodes of this graph, by its constructor."""
        if op in FUSED:
            return self._node(op, tuple(args))  # a product of two factors, as they stand in a node, with a third number
        if op in FUNCTIONS:
            return self.function(op, *args)
        if op is Op.NEG:
            return self.neg(*args)
        return {Op.ADD: self.add, Op.SUB: self.sub, Op.MUL: self.mul}[op](*args)

    def reachable(self, outputs: Iterable[int]) -> list[int]:
        """The nodes that the outputs need, in the order of their numbers."""
        seen = set()
        waiting = list(outputs)
        while waiting:
            x = waiting.pop()
            if x not in seen:
                seen.add(x)
                if self.op[x] is not Op.INPUT:
                    waiting.extend(self.args[x])
        return sorted(seen)


FUNCTIONS: dict[Op, Callable[[float], float]] = {
    Op.SIN: math.sin,
    Op.COS: math.cos,
    Op.SIGN: lambda x: float((x > 0.0) - (x < 0.0)),
    Op.ABS: abs,
}
"""Each function of a number."""


def of_number(op: Op, x: float) -> float:
    """A function of a number; the sine and cosine of one that knows its error know theirs, but for sin 0 and cos 0."""
    value = FUNCTIONS[op](x)
    if op in (Op.SIN, Op.COS) and isinstance(x, ConstantWithError) and not exactly(x, 0.0):
        return x.function(op.name, value, x.error + 2 * SINE_ULPS * UNIT_ROUNDOFF * abs(value))
    return value


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A scalar that records what is done with it; plain numbers join in as constants.

    Attributes:
        graph: where it is recorded.
        number: of its node there.
    """

    graph: Graph
    number: int

    def _join(self, other: Node | Number) -> int:
        return other.number if isinstance(other, Node) else self.graph.constant(other)

    def __add__(self, other: Node | Number) -> Node:
        if not isinstance(other, SCALARS):
            return NotImplemented  # a dual number knows what to do
        return Node(self.graph, self.graph.add(self.number, self._join(other)))

    __radd__ = __add__

    def __sub__(self, other: Node | Number) -> Node:
        if not isinstance(other, SCALARS):
            return NotImplemented
        return Node(self.graph, self.graph.sub(self.number, self._join(other)))

    def __rsub__(self, other: Number) -> Node:
        return Node(self.graph, self.graph.sub(self._join(other), self.number))

    def __mul__(self, other: Node | Number) -> Node:
        if not isinstance(other, SCALARS):
            return NotImplemented
        return Node(self.graph, self.graph.mul(self.number, self._join(other)))

    __rmul__ = __mul__

    def __neg__(self) -> Node:
        return Node(self.graph, self.graph.neg(self.number))

    def function(self, op: Op) -> Node:
        """Sine, cosine, sign or absolute value of it."""
        return Node(self.graph, self.graph.function(op, self.number))


SCALARS = (Node, int, float)
"""What a node can be added to or multiplied with by itself."""
