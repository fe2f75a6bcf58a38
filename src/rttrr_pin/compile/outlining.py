"""Takes the steps of the reference recursion: each kind is recorded once, however many links it is taken on.

The recursion hands its steps (a link outwards, a link inwards) to `Arithmetic.call`. The outliner looks at what a
step is given: which scalars are columns, which are numbers of the robot, and what stands for itself (the joint's type,
a vector of zeros). A step that was seen on arguments of this structure is not run again, but called.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count
from typing import Any

from rttrr_pin.compile.call_program import Step
from rttrr_pin.compile.call_signature import Leaf, answer, arguments, built
from rttrr_pin.compile.expression import FUNCTIONS, Graph, Node, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program, inputs_of


@dataclass(eq=False)
class Recorded:
    """A step, recorded on arguments of one structure.

    Attributes:
        graph: its operations; input k is the k-th scalar of the arguments.
        is_column: of each input.
        answer: the structure of what it returns.
        nodes: the scalars of that, as nodes of its graph.
        live: those of `outputs` that some call needs.
    """

    graph: Graph
    is_column: tuple[bool, ...]
    answer: Hashable
    nodes: list[int]
    live: set[int] = field(default_factory=set)

    @cached_property
    def outputs(self) -> tuple[int, ...]:
        """The nodes that are computed; the others are arguments handed back."""
        return tuple(dict.fromkeys(x for x in self.nodes if self.graph.op[x] is not Op.INPUT))

    @cached_property
    def reads(self) -> tuple[tuple[int, ...], ...]:
        """For each output the inputs that it depends on."""
        return tuple(inputs_of(self.graph, (x,)) for x in self.outputs)

    @cached_property
    def step(self) -> Step:
        """As a program of what is live, once that is known."""
        results = tuple(self.outputs[k] for k in sorted(self.live))
        fields = (Field("scalars", (len(self.is_column),)),), (Field("results", (len(results),)),)
        program = Program(self.graph, *fields, results)
        read = inputs_of(program.graph, program.results)
        columns = tuple(index for index in read if self.is_column[index])
        return Step(program, columns, tuple(index for index in read if not self.is_column[index]))


@dataclass(frozen=True, slots=True, eq=False)
class CallSite:
    """A step, taken: on which scalars, and the nodes that stand for its outputs."""

    recorded: Recorded
    leaves: Sequence[Leaf]
    results: tuple[int, ...]

    def live(self) -> list[int]:
        """The nodes of the outputs that the step's program has."""
        return [self.results[k] for k in sorted(self.recorded.live)]


@dataclass(eq=False)
class Outliner:
    """Takes steps, and records what is done between them.

    Attributes:
        graph: the operations between the steps; what a step yields is an input of it.
        steps: by function and structure of the arguments.
        made: answers by step and scalars: what was computed before is not computed again.
        origin: of a node the step that yields it, and as which output.
    """

    graph: Graph
    steps: dict[Hashable, Recorded] = field(default_factory=dict)
    made: dict[Hashable, Any] = field(default_factory=dict)
    origin: dict[int, tuple[CallSite, int]] = field(default_factory=dict)
    _fresh: Iterator[int] = field(default_factory=lambda: count(-1, -1))

    def call(self, function: Callable[..., Any], *scalars: Any) -> Any:
        """The function's answer; its scalars are nodes that a step yields."""
        structure, leaves = arguments(scalars, self.graph)
        if not any(isinstance(leaf, Node) for leaf in leaves):
            return function(*scalars)
        recorded = self._recorded(function, structure, leaves)
        key = (recorded, *(leaf.number if isinstance(leaf, Node) else leaf for leaf in leaves))
        if key not in self.made:
            self.made[key] = self._taken(recorded, leaves)
        return self.made[key]

    def _recorded(self, function: Callable[..., Any], structure: Hashable, leaves: Sequence[Leaf]) -> Recorded:
        """The step, run on nodes of a graph of its own unless that was done before."""
        key = (function, structure)
        if key not in self.steps:
            graph = Graph()
            scalars = (Node(graph, graph.input(index)) for index in range(len(leaves)))
            answered = answer(function(*built(structure, scalars)), graph)
            self.steps[key] = Recorded(graph, tuple(isinstance(leaf, Node) for leaf in leaves), *answered)
        return self.steps[key]

    def _taken(self, recorded: Recorded, leaves: Sequence[Leaf]) -> Any:
        """The answer for these scalars."""
        taken = CallSite(recorded, leaves, tuple(self.graph.input(next(self._fresh)) for _ in recorded.outputs))
        self.origin |= {x: (taken, k) for k, x in enumerate(taken.results)}
        outside: dict[int, Leaf] = {
            x: Node(self.graph, y) for x, y in zip(recorded.outputs, taken.results, strict=True)
        }
        op, args = recorded.graph.op, recorded.graph.args
        return built(
            recorded.answer, iter([leaves[args[x][0]] if op[x] is Op.INPUT else outside[x] for x in recorded.nodes])
        )

    def needed(self, results: Sequence[int]) -> list[CallSite]:
        """The steps that the results need, in order; operations between them have become steps too."""
        steps: dict[int, CallSite] = {}
        needed = set(results)
        for x in reversed(range(len(self.graph))):  # backwards: what needs a node stands behind it
            if x not in needed:
                continue
            if x not in self.origin and self.graph.op[x] in SINGLE:
                self.origin[x] = (self._single(x), 0)
            if x in self.origin:
                taken, output = self.origin[x]
                taken.recorded.live.add(output)
                steps[taken.results[0]] = taken
                needed.update(
                    leaf.number
                    for index in taken.recorded.reads[output]
                    if isinstance(leaf := taken.leaves[index], Node)
                )
        return [steps[first] for first in sorted(steps)]

    def _single(self, x: int) -> CallSite:
        """An operation as a step of its own."""
        structure, leaves = arguments(tuple(Node(self.graph, y) for y in self.graph.args[x]), self.graph)
        return CallSite(self._recorded(SINGLE[self.graph.op[x]], structure, leaves), leaves, (x,))


SINGLE: dict[Op, Callable[..., Any]] = {
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
    Op.NEG: operator.neg,
    **{op: operator.methodcaller("function", op) for op in FUNCTIONS},
}
"""Each operation on scalars."""
