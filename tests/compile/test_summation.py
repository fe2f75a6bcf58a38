"""Sums in chains: the same values, smaller errors, and products fused where they can be."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin.compile.build import build
from rttrr_pin.compile.emit import emitter
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.summation import order_sums
from rttrr_pin.compile.trace import trace
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.exact import enclose
from rttrr_pin.exact.enclosures import Enclosure
from rttrr_pin.validation import Sampler
from support.programs import NUMERIC, evaluate
from support.serial_chains import EXAMPLES
from support.trees import random_tree

FIVE = ("tau", "F", "N", "f", "n")

ROBOTS = {"rttrr": "rttrr", **EXAMPLES, **{f"tree-{seed}": random_tree(seed, 8) for seed in range(3)}}

FUSIONS = pytest.mark.parametrize("fused", [False, True], ids=["apart", "fused"])

steps = st.lists(
    st.tuples(st.sampled_from((Op.ADD, Op.SUB, Op.MUL, Op.NEG)), st.integers(0, 99), st.integers(0, 99)),
    min_size=1,
    max_size=25,
)
numbers = st.fractions(-9, 9, max_denominator=8)


def program_of(steps: Sequence[tuple[Op, int, int]], results: int = 3) -> Program:
    """Operations on three inputs and two whole numbers, or on what was computed before."""
    graph = Graph()
    nodes = [graph.input(0), graph.input(1), graph.input(2), graph.constant(3.0), graph.constant(-2.0)]
    for op, x, y in steps:
        args = [nodes[x % len(nodes)], nodes[y % len(nodes)]][: 1 if op is Op.NEG else 2]
        nodes.append(graph.apply(op, args))
    last = tuple(nodes[-results:])
    return Program(graph, (Field("x", (3,)),), (Field("y", (len(last),)),), last)


@FUSIONS
@given(steps=steps, x=st.tuples(numbers, numbers, numbers))
def test_the_values_are_the_same(fused: bool, steps: list[tuple[Op, int, int]], x: tuple[Fraction, ...]) -> None:
    """Exactly, where nothing is rounded."""
    program = program_of(steps)
    assert exactly(order_sums(program, fused), x) == exactly(program, x)


def exactly(program: Program, x: Sequence[Fraction]) -> list[Fraction]:
    """The results in rational numbers."""
    graph = program.graph
    values: dict[int, Any] = {}
    for node in program.order:
        op, args = graph.op[node], graph.args[node]
        if op is Op.CONSTANT:
            values[node] = Fraction(graph.value[node])
        else:
            values[node] = x[args[0]] if op is Op.INPUT else NUMERIC[op](*(values[y] for y in args))
    return [values[node] for node in program.results]


@FUSIONS
@pytest.mark.parametrize("name", list(ROBOTS))
def test_no_operation_is_added(name: str, fused: bool) -> None:
    """A product that several sums take is computed once, or in each of them; a sum costs what it did."""
    for outputs in (("tau",), FIVE):
        plain = built(name, outputs, fused=False) if fused else trace(rttrr_pin.load(ROBOTS[name]).model, outputs)
        assert _instructions(built(name, outputs, fused)) <= _instructions(plain)


@cache
def built(name: str, outputs: tuple[str, ...], fused: bool) -> Program:
    made = build(rttrr_pin.load(ROBOTS[name]).model, outputs, straight_line=None, fused=fused)
    assert isinstance(made, Program)
    return made


def _instructions(program: Program) -> int:
    """All but changes of sign, most of which an instruction does on the side."""
    return sum(program.graph.op[x] not in (Op.CONSTANT, Op.INPUT, Op.NEG) for x in program.order)


@pytest.mark.parametrize("outputs", [("tau",), FIVE, ("tau", "tau_bound"), ("mass_matrix",)], ids="-".join)
@pytest.mark.parametrize("name", list(ROBOTS))
def test_no_value_is_left_to_the_compiler_to_fuse(name: str, outputs: tuple[str, ...]) -> None:
    """A sum that still took a product would be fused by one compiler, and rounded twice by another."""
    program = built(name, outputs, fused=True)
    graph = program.graph
    values = program.results[: program.outputs[0].width]
    for x in graph.reachable(values):
        if graph.op[x] in (Op.ADD, Op.SUB):
            assert not any(graph.op[y] is Op.MUL for y in graph.args[x])


def test_small_terms_come_first() -> None:
    """1000 x + 10 y + z + 1, with a sign that must not be lost; the number 1 is of the size of z."""
    graph = Graph()
    x, y, z = (graph.input(k) for k in range(3))
    total = graph.sub(graph.mul(graph.constant(1000.0), x), graph.mul(graph.constant(10.0), y))
    total = graph.add(graph.add(total, z), graph.constant(1.0))
    made = order_sums(Program(graph, (Field("x", (3,)),), (Field("s", (1,)),), (total,)), fused=True)
    ops = [made.graph.op[x] for x in made.order if made.graph.op[x] not in (Op.CONSTANT, Op.INPUT)]
    assert ops == [Op.ADD, Op.FNMA, Op.FMA]  # z + 1, then - 10 y, then 1000 x
    assert evaluate(made, [2.0, 3.0, 4.0]) == [2000.0 - 30.0 + 4.0 + 1.0]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("other", [1.0, -1.0])
def test_signs_find_their_operation(sign: float, other: float) -> None:
    """Sums and differences of a product and a number, in all four signs, are one operation each but for -x y - z."""
    graph = Graph()
    x, y, z = (graph.input(k) for k in range(3))
    product = graph.mul(graph.constant(sign), graph.mul(x, y))
    total = graph.add(product, graph.mul(graph.constant(other), z))
    made = order_sums(Program(graph, (Field("x", (3,)),), (Field("s", (1,)),), (total,)), fused=True)
    assert evaluate(made, [2.0, 3.0, 5.0]) == [sign * 6.0 + other * 5.0]
    ops = [made.graph.op[x] for x in made.order if made.graph.op[x] is not Op.INPUT]
    both = {(1.0, 1.0): Op.FMA, (1.0, -1.0): Op.FMS, (-1.0, 1.0): Op.FNMA, (-1.0, -1.0): Op.FMA}
    assert ops == [both[sign, other]] + [Op.NEG] * (sign == other == -1.0)


def test_a_sum_that_is_needed_elsewhere_stays_a_term() -> None:
    graph = Graph()
    x, y, z = (graph.input(k) for k in range(3))
    part = graph.add(x, y)
    made = order_sums(Program(graph, (), (), (graph.add(part, z), part)), fused=True)
    assert sum(op is Op.ADD for op in made.graph.op) == 2


def test_long_sums_need_no_deep_stack() -> None:
    graph = Graph()
    total = graph.input(0)
    for k in range(1, 5000):
        total = graph.add(total, graph.mul(graph.input(k), graph.input(k - 1)))
    made = order_sums(Program(graph, (Field("x", (5000,)),), (Field("s", (1,)),), (total,)), fused=True)
    assert evaluate(made, [1.0] * 5000) == [5000.0]


def test_chains_are_nearer_to_the_truth() -> None:
    """What is compiled, than the sums as the recursion writes them, for every quantity of the links."""
    robot = rttrr_pin.load("rttrr")
    states = Sampler(robot.model, "uniform", 4).draw(0, 2000)
    truth = enclose(robot.model, states.q, states.v, states.a, (), "read")
    compiled = robot.compile(LINK_QUANTITIES)(states.q, states.v, states.a)
    plain = trace(robot.model, LINK_QUANTITIES, regrouped=False)
    columns = iter(evaluate(plain, [*states.q.T, *states.v.T, *states.a.T]))
    for name, enclosure in truth.items():
        if name in LINK_QUANTITIES:
            written = np.stack([np.broadcast_to(next(columns), 2000) for _ in range(18)], axis=1).reshape(2000, 6, 3)
            assert _error(compiled[name], enclosure) < _error(written, enclosure)


def _error(x: Array, truth: Enclosure) -> float:
    """Mean over the states of the largest relative distance over the links."""
    off = np.linalg.norm(np.maximum(np.maximum(truth.lower - x, x - truth.upper), 0.0), axis=-1)
    size = np.linalg.norm(truth.mid, axis=-1)
    return float(np.divide(off, size, out=np.zeros_like(off), where=size > 0.0).max(axis=1).mean())


@pytest.mark.parametrize(("op", "expected"), [(Op.FMA, -(2.0**-60)), (Op.FMS, 2.0 - 2.0**-60), (Op.FNMA, -2.0)])
def test_fused_operations_round_once(op: Op, expected: float) -> None:
    """(1 + e) (1 - e) - 1 is -e^2, of which nothing is left where the product is rounded."""
    graph = Graph()
    program = Program(
        graph, (Field("x", (3,)),), (Field("s", (1,)),), (graph.apply(op, [graph.input(k) for k in range(3)]),)
    )
    made = emitter("llvm")
    executable = made.load(made.emit(program), program.inputs, program.outputs)
    e, out = 2.0**-30, np.zeros((5, 1))
    executable.bind([np.tile([1.0 + e, 1.0 - e, -1.0], (5, 1))], [out])(0, 5)
    assert (out == expected).all()
