"""The tracer's algebra: what it folds, what it shares, what it moves between links; and dual numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.compile.expression import Graph, Node, Op
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.regrouping import regroup
from rttrr_pin.compile.trace import trace
from rttrr_pin.core.dual import Dual, part_of, value_of
from rttrr_pin.core.dynamics import bodies, dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.programs import evaluate
from support.recursion import recursion
from support.serial_chains import inertial, joint, random_chain
from support.slow import slow_after
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

INPUTS = 4
FUNCTIONS = {"sin": (Op.SIN, np.sin), "cos": (Op.COS, np.cos), "sign": (Op.SIGN, np.sign)}

Expression = Any
"""A number (constant), ("x", place), (name of a function, one) or (sign, one, other)."""


def expressions(constants: st.SearchStrategy[Any], functions: bool, leaves: int = 25) -> st.SearchStrategy[Expression]:
    leaf = st.one_of(constants, st.tuples(st.just("x"), st.integers(0, INPUTS - 1)))

    def larger(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
        unary = ["neg", *(FUNCTIONS if functions else ())]
        return st.one_of(
            st.tuples(st.sampled_from(unary), inner), st.tuples(st.sampled_from(["+", "-", "*"]), inner, inner)
        )

    return st.recursive(leaf, larger, max_leaves=leaves)


WHOLE = st.sampled_from([0, 1, -1, 2, -2, 3, 0.0, -0.0, 1.0, -1.0, 0.5, -4.0])
"""Small numbers, whose sums and products no float64 rounds, so that folding in any order is exact."""

POWERS = st.sampled_from([0, 1, -1, 0.0, -0.0, 1.0, -1.0, 2.0, -2.0, 0.5, -8.0])
"""Factors that only change the exponent: no order of products rounds otherwise."""

FLOATS = st.floats(-1e3, 1e3, allow_nan=False, allow_subnormal=False)


def computed(expression: Expression, x: list[Any], over: str) -> Any:
    """The expression by Python's own operations, over numbers or over nodes."""
    if not isinstance(expression, tuple):
        return expression
    kind, *rest = expression
    if kind == "x":
        return x[rest[0]]
    values = [computed(part, x, over) for part in rest]
    if kind == "+":
        return values[0] + values[1]
    if kind == "-":
        return values[0] - values[1]
    if kind == "*":
        return values[0] * values[1]
    if kind == "neg":
        return -values[0]
    op, function = FUNCTIONS[kind]
    return values[0].function(op) if over == "nodes" and isinstance(values[0], Node) else function(values[0])


def makes_constants(expression: Expression) -> bool:
    """Whether a sum or a function of constants alone is inside: their values need be no powers of two."""
    if not isinstance(expression, tuple) or expression[0] == "x":
        return False
    kind, *parts = expression
    constant = not any(has_input(part) for part in parts)
    return (constant and kind not in ("*", "neg")) or any(makes_constants(part) for part in parts)


def has_input(expression: Expression) -> bool:
    """Whether an input is inside."""
    return isinstance(expression, tuple) and (expression[0] == "x" or any(has_input(part) for part in expression[1:]))


def recorded(expression: Expression) -> tuple[Graph, int]:
    graph = Graph()
    x = [Node(graph, graph.input(k)) for k in range(INPUTS)]
    result = computed(expression, x, "nodes")
    return graph, result.number if isinstance(result, Node) else graph.constant(float(result))


def evaluated(graph: Graph, number: int, x: list[Any]) -> Any:
    return evaluate(Program(graph, (), (), (number,)), x)[0]


@given(expressions(WHOLE, functions=False), st.lists(st.integers(-3, 3), min_size=INPUTS, max_size=INPUTS))
def test_folding_changes_no_number(expression: Expression, x: list[int]) -> None:
    """Any sums and products, in numbers that floats hold exactly."""
    exact = computed(expression, [Fraction(value) for value in x], "numbers")
    if abs(exact) < 2**40:
        assert float(evaluated(*recorded(expression), [float(value) for value in x])) == exact


@given(expressions(POWERS, functions=True), st.lists(FLOATS, min_size=INPUTS, max_size=INPUTS))
def test_folding_rounds_no_number_otherwise(expression: Expression, x: list[float]) -> None:
    """Any floats: signs, zeros, ones and powers of two move without a rounding."""
    assume(not makes_constants(expression))
    arrays = [np.array([value]) for value in x]
    with np.errstate(over="ignore", invalid="ignore"):
        straight = computed(expression, arrays, "numbers")
        folded = evaluated(*recorded(expression), arrays)
    if np.isfinite(straight).all():
        np.testing.assert_array_equal(np.ravel(folded), np.ravel(straight))


@given(expressions(st.floats(-10, 10), functions=True))
def test_every_node_is_in_canonical_form(expression: Expression) -> None:
    graph, _ = recorded(expression)
    op, args, value = graph.op, graph.args, graph.value
    seen = set()
    for x in range(len(graph)):
        mine = args[x]
        if op[x] is not Op.INPUT:
            assert all(y < x for y in mine)
        key = (op[x], mine, value.get(x))
        assert key not in seen
        seen.add(key)
        kinds = [op[y] for y in mine] if op[x] is not Op.INPUT else []
        if op[x] in (Op.ADD, Op.SUB):
            assert mine[0] < mine[1]
        if op[x] is Op.MUL:
            assert Op.CONSTANT not in kinds[1:]
            assert kinds[0] is not Op.CONSTANT or (value[mine[0]] > 0.0 and value[mine[0]] != 1.0)
            assert kinds[0] is Op.CONSTANT or mine[0] <= mine[1]
            assert kinds[0] is not Op.CONSTANT or not (
                kinds[1] is Op.MUL and op[args[mine[1]][0]] is Op.CONSTANT
            )  # two constant factors are one
        if op[x] is not Op.NEG:
            assert Op.NEG not in kinds
        else:
            assert kinds[0] not in (Op.NEG, Op.CONSTANT)
        if op[x] in (Op.ADD, Op.SUB):
            assert not any(graph.is_constant(y, 0.0) for y in mine)
            assert not all(kind is Op.CONSTANT for kind in kinds)


@given(expressions(st.floats(-10, 10), functions=True))
def test_what_was_recorded_is_shared(expression: Expression) -> None:
    """The same expression again costs no node, and neither do its mirror images."""
    graph, number = recorded(expression)
    x = [Node(graph, k) for k in range(INPUTS)]
    nodes = len(graph)
    assert [graph.op[k] for k in range(INPUTS)] == [Op.INPUT] * INPUTS
    again = computed(expression, x, "nodes")
    if isinstance(again, Node):
        assert again.number == number
        opposite = -again
        assert (-opposite).number == number
    mirrored = computed(mirror(expression), x, "nodes")
    if isinstance(mirrored, Node):
        assert mirrored.number == number
    assert len(graph) <= nodes + 1  # the node of -again


def mirror(expression: Expression) -> Expression:
    """Sums and products with their sides changed."""
    if not isinstance(expression, tuple) or expression[0] == "x":
        return expression
    kind, *parts = expression
    parts = [mirror(part) for part in parts]
    return (kind, *(reversed(parts) if kind in "+*" else parts))


def test_folding_by_example() -> None:
    graph = Graph()
    x, y = (Node(graph, graph.input(k)) for k in range(2))
    same = [
        (x * 0, 0.0),
        (x * 1, x),
        (x + 0, x),
        (0 - x, -x),
        (x - x, 0.0),
        (x + x, 2 * x),
        (-x * -y, x * y),
        (x * -y, -(x * y)),
        (-x - y, -(x + y)),
        (-x + y, y - x),
        (y - x, -(x - y)),
        (3 * (2 * x), 6 * x),
        (-2 * x, -(2 * x)),
        ((-x).function(Op.SIN), -(x.function(Op.SIN))),
        ((-x).function(Op.COS), x.function(Op.COS)),
        ((-x).function(Op.SIGN), -(x.function(Op.SIGN))),
        (x * np.float64(2.0), np.float64(2.0) * x),
    ]
    for one, other in same:
        assert one.number == (other.number if isinstance(other, Node) else graph.constant(other))


def test_functions_of_constants_are_constants() -> None:
    """What follows another joint with multiplier 0 stands still: its angle costs nothing."""
    text = random_chain(7, ("revolute", "prismatic", "revolute"))
    mimic = '<mimic joint="joint_3" multiplier="0" offset="0.3"/></joint>'
    program = trace(rttrr_pin.load(text.replace("</joint>", mimic, 1)).model, ["tau"])
    assert program.operations.sincos == 1


# Moving inertia between links


def lumped_forces(model: Model, drawn: Batch) -> np.ndarray:
    """The driving forces, (N, nv), by the readable recursion on links whose inertia was moved."""
    tree, links = regroup(model, bodies(model, FLOAT))
    assert [link.type for link in links] == [joint.type for joint in model.joints]
    tau = dynamics(tree, FLOAT, list(drawn.q.T), list(drawn.v.T), list(drawn.a.T), links=links).tau
    return np.array([np.broadcast_to(x, len(drawn.q)) for x in tau]).reshape(model.nv, len(drawn.q)).T


@pytest.mark.one_in(2)
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", range(30))
def test_lumping_leaves_the_driving_forces(seed: int, base: Any) -> None:
    robot = rttrr_pin.load(random_tree(seed, 1 + seed % 12), base=base, friction=True)
    drawn = Sampler(robot.model, seed=seed).draw(0, 30)
    theirs = recursion(robot, drawn.q, drawn.v, drawn.a).tau
    assert norm_error(lumped_forces(robot.model, drawn), theirs) <= ROUNDING


@pytest.mark.parametrize("seed", slow_after(6, range(30)))
def test_lumping_adds_no_operation(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 1 + seed % 12), friction=True).model
    for outputs in (["tau"], ["mass_matrix"], ["tau", "gravity_torque"]):
        with_, without = (trace(model, outputs, regrouped=choice).operations for choice in (True, False))
        assert with_.total <= without.total
        assert with_.multiplications <= without.multiplications
        assert with_.sincos <= without.sincos


@pytest.mark.parametrize("seed", range(12))
def test_lumping_where_joints_stand_on_massless_links(seed: int) -> None:
    """Every second moving link is a frame only."""
    rng = np.random.default_rng(seed)
    links, joints = ['<link name="link_0"/>'], []
    for i in range(1, 6):
        links.append(f'<link name="link_{i}">{inertial(rng) if i % 2 == 0 or i == 5 else ""}</link>')
        kind = str(rng.choice(["revolute", "prismatic"]))
        xyz, rpy, axis = rng.uniform(-0.5, 0.5, 3), rng.uniform(-3, 3, 3), np.eye(3)[rng.integers(3)]
        joints.append(joint(i, kind, f"link_{i - 1}", f"link_{i}", xyz, rpy, axis))
    model = rttrr_pin.load(f'<robot name="x">{"".join(links + joints)}</robot>').model
    drawn = Sampler(model, seed=seed).draw(0, 30)
    theirs = recursion(Robot(model), drawn.q, drawn.v, drawn.a).tau
    assert norm_error(lumped_forces(model, drawn), theirs) <= ROUNDING


@pytest.mark.parametrize("seed", range(3))
def test_lumping_twice_is_lumping_once(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 8)).model
    once = regroup(model, bodies(model, FLOAT))
    (_, before), (_, after) = once, regroup(*once)
    assert numbers(after) <= numbers(before) < numbers(bodies(model, FLOAT))


def numbers(links: Sequence[Body]) -> int:
    """How many numbers of the inertias are not zero."""
    rows = ((link.M, *link.r_C, *(x for row in link.I.rows for x in row)) for link in links)
    return sum(x != 0.0 for row in rows for x in row)


# Dual numbers

Polynomial = dict[tuple[int, ...], int]
"""Coefficients by exponents: the independent reference, in whole numbers without a limit."""

SMALL = st.integers(-5, 5)


def polynomial(expression: Expression) -> Polynomial:
    if not isinstance(expression, tuple):
        return {(0,) * INPUTS: int(expression)}
    kind, *rest = expression
    if kind == "x":
        return {tuple(int(k == rest[0]) for k in range(INPUTS)): 1}
    parts = [polynomial(part) for part in rest]
    if kind == "neg":
        return {powers: -c for powers, c in parts[0].items()}
    total: Counter[tuple[int, ...]] = Counter()
    if kind == "*":
        for a, c in parts[0].items():
            for b, d in parts[1].items():
                total[tuple(i + j for i, j in zip(a, b, strict=True))] += c * d
    else:
        total.update(parts[0])
        for powers, c in parts[1].items():
            total[powers] += c if kind == "+" else -c
    return dict(total)


def at(p: Polynomial, x: list[int], by: int | None = None) -> int:
    """Its value, or that of its derivative."""
    total = 0
    for powers, c in p.items():
        if by is not None:
            c *= powers[by]
            powers = tuple(n - (k == by) for k, n in enumerate(powers))
        if c:
            for base, n in zip(x, powers, strict=True):
                c *= base**n
            total += c
    return total


@given(expressions(SMALL, functions=False, leaves=12), st.lists(SMALL, min_size=INPUTS, max_size=INPUTS))
def test_duals_obey_the_rules_of_sums_and_products(expression: Expression, x: list[int]) -> None:
    """Against the derivatives of the polynomial, in whole numbers: exactly."""
    result = computed(expression, [Dual(value, {k: 1}) for k, value in enumerate(x)], "numbers")
    p = polynomial(expression)
    assert value_of(result) == at(p, x)
    assert [part_of(result, k) for k in range(INPUTS)] == [at(p, x, k) for k in range(INPUTS)]


@given(expressions(SMALL, functions=False, leaves=12), st.lists(SMALL, min_size=INPUTS, max_size=INPUTS))
def test_duals_over_arrays_are_duals_over_their_entries(expression: Expression, x: list[int]) -> None:
    columns = [np.array([value, value + 1.0, 2.0 * value]) for value in x]
    together = computed(expression, [Dual(column, {k: 1.0}) for k, column in enumerate(columns)], "numbers")
    for row in range(3):
        single = [Dual(float(column[row]), {k: 1.0}) for k, column in enumerate(columns)]
        alone = computed(expression, single, "numbers")
        assert np.broadcast_to(value_of(together), 3)[row] == value_of(alone)
        for k in range(INPUTS):
            assert np.broadcast_to(part_of(together, k), 3)[row] == part_of(alone, k)


@given(
    expressions(SMALL, functions=False, leaves=6),
    st.lists(expressions(SMALL, functions=False, leaves=3), min_size=INPUTS, max_size=INPUTS),
    st.lists(SMALL, min_size=INPUTS, max_size=INPUTS),
)
def test_duals_obey_the_chain_rule(outer: Expression, inner: list[Expression], x: list[int]) -> None:
    """(f o g)' = sum over k of f_k' (g) g_k'."""
    seeds = [Dual(value, {k: 1}) for k, value in enumerate(x)]
    g = [computed(part, seeds, "numbers") for part in inner]
    whole = computed(outer, g, "numbers")
    values = [value_of(y) for y in g]
    f = polynomial(outer)
    for direction in range(INPUTS):
        expected = sum(at(f, values, k) * part_of(y, direction) for k, y in enumerate(g))
        assert part_of(whole, direction) == expected


@given(expressions(SMALL, functions=False, leaves=8), st.lists(SMALL, min_size=INPUTS, max_size=INPUTS))
@settings(max_examples=50)
def test_duals_over_nodes_record_the_derivative(expression: Expression, x: list[int]) -> None:
    graph = Graph()
    seeds = [Dual(Node(graph, graph.input(k)), {k: 1.0}) for k in range(INPUTS)]
    result = computed(expression, seeds, "numbers")
    for k in range(INPUTS):
        part = part_of(result, k)
        number = part.number if isinstance(part, Node) else graph.constant(part)
        assert evaluated(graph, number, [float(value) for value in x]) == at(polynomial(expression), x, k)


@pytest.mark.parametrize("other", [2, 2.0, np.float64(2.0), np.array([1.0, 2.0, 3.0])], ids=repr)
def test_plain_numbers_join_in_from_both_sides(other: Any) -> None:
    x = Dual(np.array([1.0, -2.0, 5.0]), {0: 1.0, 3: -2.0})
    for result, value, part in [
        (x + other, x.value + other, 1.0),
        (other + x, x.value + other, 1.0),
        (x - other, x.value - other, 1.0),
        (other - x, other - x.value, -1.0),
        (x * other, x.value * other, other),
        (other * x, x.value * other, other),
    ]:
        assert isinstance(result, Dual)
        np.testing.assert_array_equal(result.value, value)
        np.testing.assert_array_equal(part_of(result, 0), part)
        np.testing.assert_array_equal(part_of(result, 3), -2.0 * np.asarray(part))
        assert part_of(result, 1) == 0.0


def test_plain_nodes_join_in_from_both_sides() -> None:
    graph = Graph()
    y = Node(graph, graph.input(0))
    x = Dual(3.0, {0: 1.0})
    for result, value, part in [(x + y, 10.0, 1.0), (y - x, 4.0, -1.0), (x - y, -4.0, 1.0), (y * x, 21.0, 7.0)]:
        assert isinstance(result, Dual)
        for scalar, expected in ((result.value, value), (result.parts[0], part)):
            number = scalar.number if isinstance(scalar, Node) else graph.constant(scalar)
            assert evaluated(graph, number, [7.0]) == expected


def test_operations_leave_their_operands_alone() -> None:
    x, y = Dual(2.0, {0: 1.0}), Dual(3.0, {0: 5.0, 1: 1.0})
    for result in (x + y, y + x, x - y, x * y, -x, x + 1, x * 2):
        assert result is not x
    assert (dict(x.parts), dict(y.parts)) == ({0: 1.0}, {0: 5.0, 1: 1.0})
