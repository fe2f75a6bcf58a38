"""Passes that make a program cheaper. Each returns a program with the same values but for rounding.

Folding, common subexpressions and dead code need no pass: the tracer sees to them as it records. Nor does the order
(`Program.order`), which was faster than the depth-first orders that were tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from rttrr_pin.compile.constants import exactly
from rttrr_pin.compile.cost import cost
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.program import Program

Pass = Callable[[Program], Program]


def simplify(program: Program) -> Program:
    """Every pass that makes this program cheaper, in the order of `PASSES`."""
    for improve in PASSES:
        program = min(program, improve(program), key=cost)
    return program


Monomial = tuple[int, ...]
"""Numbers of one or two nodes, sorted: the node, or the product of both."""

Form = dict[Monomial, float]
"""A sum of monomials, each times its coefficient."""


def collect(program: Program) -> Program:
    """Sums of products with the robot's numbers, collected by those numbers.

    w x (w x r) and I w multiply each component of w by many numbers, one after the other. As sums of monomials

        (w x (w x r) + w_dot x r)_x = r_x (-w_y^2 - w_z^2) + r_y (w_x w_y - w_dot_z) + r_z (w_x w_z + w_dot_y)

    each number is multiplied once, numbers that stand at the same monomial become one (I_zz - I_yy), and the brackets
    are those of every vector that turns with the link: r_C, the origins of the next joints, the columns of I.
    """
    return _Collector(program).run()


@dataclass
class _Collector:
    """Rebuilds a program from its sums.

    Attributes:
        program: the old program.
        graph: the new one.
        forms: of each old node, as monomials in new nodes.
        built: the new node of each old node.
    """

    program: Program
    graph: Graph = field(default_factory=Graph)
    forms: dict[int, Form] = field(default_factory=dict)
    deep: dict[int, Form] = field(default_factory=dict)
    built: dict[int, int] = field(default_factory=dict)
    uses: Counter[int] = field(default_factory=Counter)

    def run(self) -> Program:
        old = self.program
        for x in old.order:
            if old.graph.op[x] is not Op.INPUT:
                self.uses.update(old.graph.args[x])
        for x in old.order:
            self._visit(x)
        results = tuple(self._build(x) for x in old.results)
        return Program(self.graph, old.inputs, old.outputs, results, placed_first=False)

    def _visit(self, x: int) -> None:
        """The form of a node; what is finished, or no sum of known monomials, becomes a node of its own."""
        old, graph = self.program.graph, self.graph
        op, args = old.op[x], old.args[x]
        if op is Op.CONSTANT:
            self.built[x] = graph.constant(old.value[x])
            self.forms[x] = {(): old.value[x]}
            return
        if op is Op.INPUT:
            self.built[x] = graph.input(args[0])
            self.forms[x] = {(self.built[x],): 1.0}
            return
        form = self._form(x, op, args)
        if form is None:
            self.built[x] = graph.apply(op, [self._build(y) for y in args])
            self._atom(x)
        else:
            self.forms[x] = self.deep[x] = form
            if x in old.kept:
                self._build(x)
                self._atom(x)
                del self.deep[x]

    def _shared(self, x: int) -> Form:
        """The form of a node in a sum: what several sums take is computed once."""
        if self.uses[x] > 1 and x in self.deep and len(self.deep[x]) > 1:
            self._build(x)
            self._atom(x)
        return self.forms[x]

    def _atom(self, x: int) -> None:
        """A node that later sums take as it is."""
        graph, node = self.graph, self.built[x]
        if x in self.program.graph.kept:
            graph.kept.add(graph.args[node][0] if graph.op[node] is Op.NEG else node)
        self.forms[x] = self._of_node(node)

    def _of_node(self, node: int) -> Form:
        graph = self.graph
        if graph.op[node] is Op.CONSTANT:
            return {} if graph.is_constant(node, 0.0) else {(): graph.value[node]}
        if graph.op[node] is Op.NEG:
            return {(graph.args[node][0],): -1.0}
        return {(node,): 1.0}

    def _form(self, x: int, op: Op, args: tuple[int, ...]) -> Form | None:
        if op is Op.NEG:
            return {m: -c for m, c in self._shared(args[0]).items()}
        if op in (Op.ADD, Op.SUB):
            sign = 1.0 if op is Op.ADD else -1.0
            form = dict(self._shared(args[0]))
            for m, c in self._shared(args[1]).items():
                form[m] = form.get(m, 0.0) + sign * c
            return {m: c for m, c in form.items() if not exactly(c, 0.0)} if len(form) <= LONGEST else None
        if op is Op.MUL:
            return self._product(*args)
        return None

    def _product(self, x: int, y: int) -> Form | None:
        """A sum times a number, or times a finished component of the same motion."""
        old = self.program.graph
        if old.op[x] is Op.CONSTANT:
            return {m: c * old.value[x] for m, c in self._shared(y).items()}
        left, right = self.deep.get(x, self.forms[x]), self.deep.get(y, self.forms[y])
        if not (self._linear(left) and self._linear(right)) or (len(left) > 1 and len(right) > 1):
            return None
        if _plain(left) and _plain(right) and len(left) + len(right) > 2:
            return None
        form: Form = {}
        for m, c in left.items():
            for k, d in right.items():
                pair = (min(m[0], k[0]), max(m[0], k[0]))
                form[pair] = form.get(pair, 0.0) + c * d
        return form

    def _linear(self, form: Form) -> bool:
        """Whether it is a sum of single finished components."""
        return bool(form) and all(len(m) == 1 and m[0] in self.graph.kept for m in form)

    def _build(self, x: int) -> int:
        """The new node of an old one."""
        if x not in self.built:
            self.built[x] = self._sum(self.forms[x])
        return self.built[x]

    def _sum(self, form: Form) -> int:
        """Sums of equal coefficients first, then each times its coefficient."""
        graph = self.graph
        groups: dict[int, list[tuple[int, bool]]] = {}  # by the node of the coefficient
        for m, c in sorted(form.items()):
            groups.setdefault(graph.constant(abs(c)), []).append((self._monomial(m), c < 0.0))
        total = graph.constant(0.0)
        for factor, terms in groups.items():
            part = graph.constant(0.0)
            for node, negative in sorted(terms):
                part = graph.sub(part, node) if negative else graph.add(part, node)
            total = graph.add(total, graph.mul(factor, part))
        return total

    def _monomial(self, m: Monomial) -> int:
        if not m:
            return self.graph.constant(1.0)
        return m[0] if len(m) == 1 else self.graph.mul(*m)


def _plain(form: Form) -> bool:
    """Whether no number but 1 and -1 stands in it."""
    return all(abs(c) == 1.0 for c in form.values())


LONGEST = 60
"""Monomials beyond which a sum is not looked through."""


PASSES: tuple[Pass, ...] = (collect,)
"""In their order."""
