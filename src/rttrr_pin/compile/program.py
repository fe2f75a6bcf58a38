"""The straight-line program of one robot: inputs, operations in order, outputs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from rttrr_pin.compile.expression import FUSED, LEAVES, Graph, Op
from rttrr_pin.compile.fields import Field, Widths
from rttrr_pin.compile.float_type import FLOAT64, FloatType


@dataclass(frozen=True, slots=True)
class Operations:
    """What one state costs.

    Attributes:
        multiplications, additions, negations: counted one by one (a fused multiply-add counts as two).
        sincos: angles of which sine or cosine are needed.
    """

    multiplications: int
    additions: int
    negations: int
    sincos: int

    @property
    def total(self) -> int:
        """All but the sines and cosines; published counts are of this kind."""
        return self.multiplications + self.additions + self.negations

    def __str__(self) -> str:
        return (
            f"{self.multiplications} multiplications, {self.additions} additions, {self.negations} sign changes, "
            f"{self.sincos} angles"
        )


@dataclass(frozen=True, eq=False)
class Program(Widths):
    """A robot's program.

    Attributes:
        graph: the operations.
        inputs: the arrays it reads; the graph's inputs are their numbers, one array after the other.
        outputs: the arrays it writes.
        results: for each number of the outputs, one array after the other, the node that computes it.
        float_type: of all numbers, those of the robot included.
        quickly: whether it is to be compiled in little time, of code half as fast and without an entry for single
            states: what only checks need.
    """

    graph: Graph
    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    results: tuple[int, ...]
    float_type: FloatType = FLOAT64
    quickly: bool = False

    @cached_property
    def order(self) -> tuple[int, ...]:
        """The nodes that are needed, each behind what it takes.

        What depends on no finished vector, that is where the links are placed, comes first: compiled so, Panda and
        Talos need fewer instructions than link by link, as the reference recursion has it.
        """
        nodes = self.graph.reachable(self.results)
        behind: set[int] = set()
        for x in nodes:
            args = self.graph.args[x] if self.graph.op[x] not in LEAVES else ()
            if x in self.graph.kept or any(y in behind for y in args):
                behind.add(x)
        return tuple(sorted(nodes, key=lambda x: (x in behind, x)))

    @cached_property
    def unread(self) -> tuple[int, ...]:
        """Places of inputs that no output depends on; what is not finite there would go unseen."""
        read = set(inputs_of(self.graph, self.results))
        return tuple(index for index in range(self.width_in) if index not in read)

    @cached_property
    def operations(self) -> Operations:
        """What one state costs."""
        op, args = self.graph.op, self.graph.args
        ops = [op[x] for x in self.order]
        angles = {args[x][0] for x in self.order if op[x] in (Op.SIN, Op.COS)}
        fused = sum(ops.count(x) for x in FUSED)
        additions = ops.count(Op.ADD) + ops.count(Op.SUB) + fused
        return Operations(ops.count(Op.MUL) + fused, additions, ops.count(Op.NEG), len(angles))


def inputs_of(graph: Graph, nodes: Iterable[int]) -> tuple[int, ...]:
    """Places of the inputs that nodes depend on."""
    return tuple(sorted(graph.args[x][0] for x in graph.reachable(nodes) if graph.op[x] is Op.INPUT))
