"""Which column of a block holds what: the steps that were taken become calls, and columns are used again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from rttrr_pin.compile.call_program import Call, CallProgram, Step
from rttrr_pin.compile.expression import Graph, Node
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.outlining import CallSite, Outliner
from rttrr_pin.compile.program import Program


def arranged(
    outliner: Outliner, results: Sequence[int], inputs: tuple[Field, ...], outputs: tuple[Field, ...]
) -> CallProgram:
    """The schedule of what was recorded: calls in the order in which the reference recursion took the steps."""
    taken = outliner.needed(results)
    steps = list(dict.fromkeys((*STANDING, *(one.recorded.step for one in taken))))
    index = {step: k for k, step in enumerate(steps)}
    width = sum(field.width for field in inputs)
    last_reads = {x: k for k, one in enumerate(taken) for x in _read(one)}
    columns = _Columns(outliner.graph, width, results, last_reads)
    calls = [columns.call(k, index[one.recorded.step], one) for k, one in enumerate(taken)]
    rest = [columns.rest(position, x) for position, x in enumerate(results)]
    seen = _seen(taken, results)
    return CallProgram(
        steps=tuple(steps),
        calls=(*calls, *(call for call in rest if call is not None)),
        inputs=inputs,
        outputs=outputs,
        between=columns.count - width - len(results),
        unread=tuple(k for k in range(width) if outliner.graph.input(k) not in seen),
    )


def _read(one: CallSite) -> list[int]:
    """The nodes in the columns that a step reads."""
    return [leaf.number for index in one.recorded.step.columns if isinstance(leaf := one.leaves[index], Node)]


def _seen(taken: Sequence[CallSite], results: Sequence[int]) -> set[int]:
    """Nodes that the results depend on."""
    seen = set(results)
    for one in reversed(taken):
        for k, x in enumerate(one.live()):
            if x in seen:
                leaves = (one.leaves[index] for index in one.recorded.step.reads[k])
                seen.update(leaf.number for leaf in leaves if isinstance(leaf, Node))
    return seen


@dataclass(eq=False)
class _Columns:
    """Gives columns to nodes: the inputs' first, the results' behind them, then those that are used again."""

    graph: Graph
    width: int
    results: Sequence[int]
    last: dict[int, int]  # the last call that reads each node; from then on its column is free
    of: dict[int, int] = field(default_factory=dict)
    free: list[int] = field(default_factory=list)  # the one used last is used first
    count: int = 0

    def __post_init__(self) -> None:
        self.count = self.width + len(self.results)
        # A result is computed where it is returned; of one that is returned twice, the first place is its own (`rest`).
        self.of = {x: self.width + index for index, x in reversed(list(enumerate(self.results)))}
        self.of |= {self.graph.input(index): index for index in range(self.width)}

    def call(self, k: int, step: int, one: CallSite) -> Call:
        """The call, with columns for what it yields; they may be those of what it reads last."""
        read = _read(one)
        columns = tuple(self.of.get(x, 0) for x in read)  # 0 where only results that nobody needs depend on it
        self._release(x for x in dict.fromkeys(read) if self.last[x] == k)
        # Columns read for the last time are free for this call's own results: a step reads all before it writes.
        live = one.live()
        for x in live:
            if x not in self.of:
                self.of[x] = self._column()
        self._release(x for x in live if x not in self.last)  # written because other calls of this step need it
        leaves = (one.leaves[index] for index in one.recorded.step.numbers)
        numbers = tuple(leaf for leaf in leaves if not isinstance(leaf, Node))
        return Call(step, columns, numbers, tuple(self.of[x] for x in live))

    def _release(self, nodes: Iterable[int]) -> None:
        columns = (self.of[x] for x in nodes if x in self.of)
        # Results stay until they are scattered, and inputs until all calls are done: an output may be one (`rest`).
        self.free.extend(column for column in columns if column >= self.width + len(self.results))

    def _column(self) -> int:
        # The one freed last is the one most likely to be in the cache still.
        if not self.free:
            self.count += 1
        return self.free.pop() if self.free else self.count - 1

    def rest(self, index: int, x: int) -> Call | None:
        """What fills the column of an output that no step wrote."""
        column = self.width + index
        if self.of[x] != column:
            return Call(COPY, (self.of[x],), (), (column,))
        return Call(FILL, (), (self.graph.value[x],), (column,)) if x in self.graph.value else None


def _same(column: bool) -> Step:
    """A step that hands on what it is given."""
    graph = Graph()
    program = Program(graph, (Field("scalars", (1,)),), (Field("results", (1,)),), (graph.input(0),))
    return Step(program, (0,) * column, (0,) * (not column))


STANDING = (_same(column=True), _same(column=False))
"""The first steps of every schedule: an output may be an input, the same as another output, or a number."""

COPY, FILL = 0, 1
"""Their indices."""
