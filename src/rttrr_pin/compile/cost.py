"""What a program costs a processor: instructions, and values that do not stay in its registers.

Operations alone mislead: a product shared by ten sums saves nine multiplications and costs a store and ten loads if it
finds no register meanwhile. Collecting sums saves operations in RTTRR and in Talos (`benchmarks/operation_counts.py`),
and yet makes the one faster and the other slower, as the estimate says; where both ways are close, it may err.
"""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass, field

from rttrr_pin.compile.expression import LEAVES, Op
from rttrr_pin.compile.program import Program

REGISTERS = 12
"""Vector registers that hold values; of 16, the rest holds constants and what is being computed."""


def cost(program: Program) -> int:
    """An estimate of the instructions: operations, fused where they can be, and loads and stores."""
    return fused(program) + _Registers(program).run()


def fused(program: Program) -> int:
    """Operations where a product that one sum alone takes is part of that sum."""
    op, args = program.graph.op, program.graph.args
    uses = Counter(program.results)
    for x in program.order:
        if op[x] is not Op.INPUT:
            uses.update(args[x])
    sums = (x for x in program.order if op[x] in (Op.ADD, Op.SUB))
    return program.operations.total - sum(any(op[y] is Op.MUL and uses[y] == 1 for y in args[x]) for x in sums)


@dataclass
class _Registers:
    """A processor that gives up the value it needs last (Belady), and loads and stores accordingly."""

    program: Program
    held: set[int] = field(default_factory=set)
    stored: set[int] = field(default_factory=set)
    traffic: int = 0
    needed: dict[int, deque[int]] = field(default_factory=dict)

    def run(self) -> int:
        """Loads and stores of the whole program."""
        op, args = self.program.graph.op, self.program.graph.args
        steps = [x for x in self.program.order if op[x] not in LEAVES]
        for time, x in enumerate(steps):
            for y in args[x]:
                self.needed.setdefault(y, deque()).append(time)
        for time, x in enumerate(steps):
            self._take([y for y in args[x] if op[y] is not Op.CONSTANT], time)
            if self.needed.get(x):
                self.held.add(x)
            while len(self.held) > REGISTERS:
                self._give_up_one()
        return self.traffic

    def _take(self, values: list[int], time: int) -> None:
        for y in values:
            self.traffic += y not in self.held
            self.held.add(y)
        for y in values:
            while self.needed[y] and self.needed[y][0] <= time:
                self.needed[y].popleft()
            if not self.needed[y]:
                self.held.discard(y)

    def _give_up_one(self) -> None:
        last = max(self.held, key=lambda y: (self.needed[y][0], y))
        self.held.discard(last)
        if self.program.graph.op[last] is not Op.INPUT and last not in self.stored:
            self.stored.add(last)
            self.traffic += 1
