"""Sums as chains, small terms first: fewer and smaller rounding errors, and a product with its sum in one operation.

A sum of k terms rounds k - 1 partial sums, each by at most u times its size. In the order of the terms' sizes the
partial sums stay small as long as they can (Higham, "Accuracy and Stability of Numerical Algorithms", section 4.2),
and a fused multiply-add rounds a product and its sum once where two operations round twice. Sizes are estimated, for
inputs of size 1, once for the program: the order is the same for all states.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.program import Program

SUMS = (Op.ADD, Op.SUB)

SIGNS = {Op.ADD: (False, False), Op.SUB: (False, True), Op.NEG: (True,)}
"""Which operands are subtracted."""


def order_sums(program: Program, fused: bool) -> Program:
    """The program with its sums of sums as chains, products fused into them if wanted: the same but for rounding."""
    return _Chainer(program, fused).run()


@dataclass
class _Chainer:
    """Rebuilds a program, sum by sum."""

    program: Program
    fused: bool
    graph: Graph = field(default_factory=Graph)
    built: dict[int, int] = field(default_factory=dict)  # new nodes; none for sums that are part of another one
    sizes: dict[int, float] = field(default_factory=dict)  # estimates, of old nodes
    uses: Counter[int] = field(default_factory=Counter)

    def run(self) -> Program:
        old = self.program
        self.uses.update(old.results)
        inner: set[int] = set()  # sums of which another sum, or an opposite, is made, and nothing else
        for x in old.order:
            if old.graph.op[x] is not Op.INPUT:
                self.uses.update(old.graph.args[x])
        for x in old.order:
            if old.graph.op[x] in SIGNS:
                inner.update(y for y in old.graph.args[x] if self._opens(y))
        for x in old.order:
            self.sizes[x] = self._size(x)
            # A sum inside another becomes terms of the outer one: a node of its own would fix its order.
            if x not in inner:
                self.built[x] = self._node(x)
                if x in old.graph.kept:
                    self.graph.kept.add(self._bare(self.built[x])[0])
        results = tuple(self.built[x] for x in old.results)
        return Program(self.graph, old.inputs, old.outputs, results)

    def _opens(self, x: int) -> bool:
        """Whether a term of a sum is a sum that is needed nowhere else."""
        return self.program.graph.op[x] in SUMS and self.uses[x] == 1

    def _size(self, x: int) -> float:
        graph = self.program.graph
        op, args = graph.op[x], graph.args[x]
        if op is Op.CONSTANT:
            return abs(float(graph.value[x]))
        if op is Op.MUL:
            return self.sizes[args[0]] * self.sizes[args[1]]
        if op in SUMS:  # terms of either sign: their sum is as large as a random walk's, and not as all together
            return math.hypot(self.sizes[args[0]], self.sizes[args[1]])
        return self.sizes[args[0]] if op in (Op.NEG, Op.ABS) else 1.0

    def _node(self, x: int) -> int:
        """The new node of an old one."""
        old = self.program.graph
        op, args = old.op[x], old.args[x]
        if op is Op.CONSTANT:
            return self.graph.constant(old.value[x])
        if op is Op.INPUT:
            return self.graph.input(args[0])
        if op in SIGNS:
            return self._chain(self._terms(x))
        return self.graph.apply(op, [self.built[y] for y in args])

    def _terms(self, x: int) -> list[tuple[int, bool]]:
        """What a sum adds up, small terms first: new nodes, and whether they are subtracted."""
        old = self.program.graph
        constant: float = 0.0
        terms: list[tuple[float, int, bool]] = []
        waiting = [*zip(old.args[x], SIGNS[old.op[x]], strict=True)]
        while waiting:
            y, negative = waiting.pop()
            if self._opens(y):
                waiting += ((z, negative != turned) for z, turned in zip(old.args[y], SIGNS[old.op[y]], strict=True))
            elif old.op[y] is Op.CONSTANT:  # constants of one sum are one number, added once
                constant = constant - old.value[y] if negative else constant + old.value[y]
            else:
                node, turned = self._bare(self.built[y])
                terms.append((self.sizes[y], node, negative != turned))
        number = self.graph.constant(constant)
        if not self.graph.is_constant(number, 0.0):
            terms.append((abs(float(constant)), number, False))
        return [(node, negative) for _, node, negative in sorted(terms)]

    def _chain(self, terms: list[tuple[int, bool]]) -> int:
        """The sum, term by term; a product is fused with what there is so far, or with the first number there is."""
        graph = self.graph
        # The first term has nothing to be fused with: where it is a product, a plain number starts the chain instead.
        if self.fused and len(terms) > 1 and self._is_product(terms[0][0]) and not self._is_product(terms[1][0]):
            terms = [terms[1], terms[0], *terms[2:]]
        total, negative = terms[0] if terms else (graph.constant(0.0), False)
        for node, subtracted in terms[1:]:
            if self.fused and self._is_product(node):
                x, y = graph.args[node]
                if subtracted == negative:
                    total = graph.apply(Op.FMA, (x, y, total))
                else:  # total - x y, or x y - total where the sum is the opposite of the total
                    total = graph.apply(Op.FMS if negative else Op.FNMA, (x, y, total))
                    negative = False
            elif subtracted == negative:
                total = graph.add(total, node)
            else:
                total = graph.sub(node, total) if negative else graph.sub(total, node)
                negative = False
            # The graph pulls signs out of sums; the chain carries its own apart, so that no term has to be negated.
            total, turned = self._bare(total)
            negative = negative != turned
        return graph.neg(total) if negative else total

    def _is_product(self, node: int) -> bool:
        return self.graph.op[node] is Op.MUL

    def _bare(self, node: int) -> tuple[int, bool]:
        """A node without its sign, and whether it has one."""
        if self.graph.op[node] is Op.NEG:
            return self.graph.args[node][0], True
        return node, False
