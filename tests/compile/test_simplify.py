"""Passes leave the values as they are, and make programs cheaper."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.compile.cost import cost, fused
from rttrr_pin.compile.expression import Graph
from rttrr_pin.compile.program import Field, Program
from rttrr_pin.compile.simplify import PASSES, Pass, simplify
from rttrr_pin.compile.trace import trace
from support.serial_chains import EXAMPLES
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

OUTPUTS = [("tau",), ("tau", "F", "N", "f", "n")]

ROBOTS = {"rttrr": "rttrr", **EXAMPLES, **{f"tree-{seed}": random_tree(seed, 8) for seed in range(6)}}


def values(program: Program, robot: Robot) -> list[np.ndarray]:
    model = robot.model
    rng = np.random.default_rng(0)
    columns = [*rng.uniform(-2, 2, (model.nq + 2 * model.nv, 20))]
    return [np.broadcast_to(x, 20) for x in program.evaluate(columns)]


@pytest.mark.parametrize("outputs", OUTPUTS, ids="-".join)
@pytest.mark.parametrize("shorten", PASSES, ids=lambda shorten: shorten.__name__)
@pytest.mark.parametrize("name", list(ROBOTS))
def test_a_pass_changes_rounding_only(name: str, shorten: Pass, outputs: tuple[str, ...]) -> None:
    """Also where it is not taken."""
    robot = rttrr_pin.load(ROBOTS[name])
    program = trace(robot.model, outputs)
    shorter = shorten(program)
    assert (shorter.inputs, shorter.outputs) == (program.inputs, program.outputs)
    assert norm_error(np.array(values(shorter, robot)), np.array(values(program, robot))) <= ROUNDING


@pytest.mark.parametrize("name", list(ROBOTS))
def test_what_is_compiled_costs_no_more(name: str) -> None:
    program = trace(rttrr_pin.load(ROBOTS[name]).model, ["tau"])
    assert cost(simplify(program)) <= cost(program)


def test_rttrr_gets_shorter() -> None:
    """So that a pass that does nothing is seen."""
    program = trace(rttrr_pin.load("rttrr").model, ["tau"])
    assert simplify(program).operations.total < program.operations.total
    assert fused(simplify(program)) < fused(program)


def test_collecting_by_hand() -> None:
    """w_y (w_x r - w_y s) - w_z w_z s, of finished components, becomes r w_x w_y - s (w_y^2 + w_z^2)."""
    graph = Graph()
    x, y, z = (graph.input(k) for k in range(3))
    graph.kept.update((x, y, z))
    r, s = graph.constant(3.0), graph.constant(5.0)
    inner = graph.sub(graph.mul(x, r), graph.mul(y, s))
    total = graph.sub(graph.mul(y, inner), graph.mul(z, graph.mul(z, s)))
    program = Program(graph, (Field("w", (3,)),), (Field("a", (1,)),), (total,))
    assert program.operations.multiplications == 5
    shorter = PASSES[0](program)
    assert (shorter.operations.multiplications, shorter.operations.additions) == (5, 2)
    assert shorter.evaluate([2.0, 7.0, 11.0]) == program.evaluate([2.0, 7.0, 11.0]) == [3 * 14 - 5 * (49 + 121)]


def test_a_product_of_one_sum_is_fused() -> None:
    graph = Graph()
    x, y = graph.input(0), graph.input(1)
    product = graph.mul(x, y)
    once = Program(graph, (), (), (graph.add(product, x),))
    assert (once.operations.total, fused(once)) == (2, 1)
    twice = Program(graph, (), (), (graph.add(product, x), graph.sub(y, product)))
    assert (twice.operations.total, fused(twice)) == (3, 3)
