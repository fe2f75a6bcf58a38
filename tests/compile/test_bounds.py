"""Bounds compiled beside the kernel's results: no true error exceeds them, and they are of the size of rounding."""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.compile import bounds
from rttrr_pin.compile.build import build
from rttrr_pin.compile.constants import ConstantWithError, error_of, exactly
from rttrr_pin.compile.emit import EMITTERS
from rttrr_pin.compile.expression import Graph, Node, Op
from rttrr_pin.compile.regrouping import regroup
from rttrr_pin.compile.trace import TRACING, TRACING_WITH_ERRORS
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.scalars import SLACK, UNIT_ROUNDOFF
from rttrr_pin.exact import bounded_dynamics, enclose
from rttrr_pin.validation import Sampler
from support.high_precision import exact_dynamics
from support.serial_chains import random_chain
from support.slow import slow_after
from support.tolerances import ROUNDING
from support.trees import random_tree

FIVE = ("tau", "F", "N", "f", "n")
BOUNDS = tuple(name + "_bound" for name in FIVE)
STATES = 12

finite = st.floats(-1e6, 1e6, allow_subnormal=False).filter(lambda x: x == 0.0 or abs(x) > 1e-6)
errors = st.sampled_from((0.0, 2.0**-53, 1e-9, 0.25))


# Numbers that know their error


@given(finite, finite, errors, errors, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.sampled_from("+-*/"))
def test_a_known_number_s_error_covers_the_truth(x, y, e, d, at, by, operation) -> None:
    """Wherever within their errors the operands truly lie."""
    apply = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}[operation]
    assume(operation != "/" or abs(y) > 2 * d)
    result = apply(ConstantWithError(x, e), ConstantWithError(y, d))
    left, right = Fraction(x) + Fraction(e) * Fraction(at), Fraction(y) + Fraction(d) * Fraction(by)
    truth = apply(left, right)
    assert abs(Fraction(float(result)) - truth) <= Fraction(result.error) * Fraction(SLACK)
    assert float(result) == apply(x, y)


@given(finite, finite)
def test_exact_operations_have_no_error(x, y) -> None:
    assert (
        (ConstantWithError(x) * 2).error == 0.0
        and (0 * ConstantWithError(x)).error == 0.0
        and (ConstantWithError(x) - x).error == 0.0
    )
    exact = Fraction(x) + Fraction(y) == Fraction(x + y)
    assert (ConstantWithError(x) + y).error == abs(float(Fraction(x) + Fraction(y) - Fraction(x + y))) and exact == (
        not (x + ConstantWithError(y)).error
    )


def test_a_known_number_is_a_float_and_others_may_take_it_further() -> None:
    x = ConstantWithError(0.5, 0.25)
    assert isinstance(x, float) and x == 0.5 and abs(-x) == 0.5 and error_of(-x) == 0.25 and error_of(0.5) == 0.0
    assert (
        error_of(1 / ConstantWithError(0.5)) == 0.0
        and error_of(ConstantWithError(1.0, 0.5) / 2) == 0.25
        and (1 / x).error >= 2.0
    )
    assert (1 / ConstantWithError(0.25, 0.5)).error == np.inf  # may be zero
    assert error_of(1 - x) == 0.25 and error_of(abs(x)) == 0.25
    graph = Graph()
    node = TRACING_WITH_ERRORS.column(Node(graph, graph.input(0)))
    assert graph.op[(x * node).number] is Op.MUL and graph.op[(x + node).number] is Op.ADD


def test_a_zero_with_an_error_is_no_zero() -> None:
    """An entry 0 of a rounded rotation: its value vanishes, its error stays."""
    graph = Graph()
    x = graph.input(0)
    exact, rounded = graph.constant(0.0), graph.constant(ConstantWithError(0.0, 1e-15))
    assert graph.mul(exact, x) == exact
    assert graph.op[graph.mul(rounded, x)] is Op.MUL and graph.op[graph.add(rounded, x)] is Op.ADD
    assert graph.op[graph.mul(graph.constant(ConstantWithError(1.0, 1e-15)), x)] is Op.MUL
    assert graph.constant(ConstantWithError(0.0)) == exact != rounded


def test_equal_doubles_are_not_equal_numbers() -> None:
    """Two numbers may round to the same double with the same bound; only a number itself takes itself away."""
    graph = Graph()
    q = Node(graph, graph.input(0))
    x, twin = ConstantWithError(0.5, 1e-16), ConstantWithError(0.5, 1e-16)
    assert graph.is_constant((q * x - q * x).number, 0.0) and exactly(x - x, 0.0)
    assert not graph.is_constant((q * x - q * twin).number, 0.0)
    assert error_of(x - twin) == 2e-16 and error_of(x + (-twin)) == 2e-16


@given(finite, finite, errors, errors)
def test_the_same_computation_is_the_same_number(x, y, e, d) -> None:
    """In whatever order, and with whatever signs, it is written."""
    a, b = ConstantWithError(x, e), ConstantWithError(y, d)
    for one, other in ((a + b, b + a), (a - b, -(b - a)), (a * b, b * a), (-a * b, -(b * a)), (-a - b, -(a + b))):
        assert exactly(one - other, 0.0) and (float(one), error_of(one)) == (float(other), error_of(other))
    if e and x:  # what is exact is told apart by its value alone
        assert not exactly((a + b) - (ConstantWithError(x, e) + b), 0.0)
    assert exactly(1.0 * a - a, 0.0) and exactly(a * -1 + a, 0.0) and exactly(a + 0 - a, 0.0)


def test_the_sine_of_a_rounded_number_is_rounded() -> None:
    graph = Graph()
    for op, function in ((Op.SIN, math.sin), (Op.COS, math.cos)):
        for error in (0.0, 1e-9):
            x = ConstantWithError(0.9, error)
            value = graph.value[graph.function(op, graph.constant(x))]
            assert value == function(0.9) and error + UNIT_ROUNDOFF / 2 <= error_of(value) <= error + 1e-15
    assert graph.is_constant(graph.function(Op.COS, graph.constant(ConstantWithError(0.0))), 1.0)


# The kernel


def compiled(robot: Robot, emitter: str | None = None):
    return robot.compile((*FIVE, *BOUNDS), emitter)


def check(
    robot: Robot, sampling: str, seed: int, emitter: str | None = None, quantities: tuple[str, ...] = FIVE
) -> None:
    """Against 60 digits on the same doubles, component by component."""
    states = Sampler(robot.model, sampling, seed, RandomPayload(robot.link_names[-1])).draw(0, STATES)
    payload = [rttrr_pin.Wrench(x.f, x.n, robot.link_names[x.link]) for x in states.loads]
    kernel = robot.compile((*quantities, *(name + "_bound" for name in quantities)), emitter)
    result = kernel(states.q, states.v, states.a, payload=payload or None)
    with mpmath.workdps(60):
        for k in range(STATES):
            part = slice(k, k + 1)
            loads = [load.block(part) for load in states.loads]
            exact = exact_dynamics(robot.model, states.q[part], states.v[part], states.a[part], loads)
            for key in quantities:
                error = np.abs(result[key][k] - exact[key])
                assert (error <= result[key + "_bound"][k]).all(), (key, k)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", slow_after(2, range(6)))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_no_true_error_exceeds_its_bound_in_trees(seed: int, base: Any) -> None:
    check(rttrr_pin.load(random_tree(seed, 7), base=base, friction=True), "mixed", seed)


@pytest.mark.one_in(21)
@pytest.mark.parametrize("sampling", slow_after(2, ["uniform", "large-velocities", "corners", "zeros", "one-joint"]))
def test_no_true_error_exceeds_its_bound(robot: Robot, sampling: str) -> None:
    check(robot, sampling, 3)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", slow_after(2, range(12)))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_no_true_error_exceeds_its_bound_where_inertia_was_moved(seed: int, base: Any) -> None:
    """Asked for tau alone, the kernel computes with other inertias than the file's."""
    check(rttrr_pin.load(random_tree(seed, 7), base=base, friction=True), "mixed", seed, quantities=("tau",))


@pytest.mark.one_in(2)
def test_no_true_error_exceeds_its_bound_for_tau_alone(robot: Robot) -> None:
    check(robot, "uniform", 6, quantities=("tau",))


def check_file(urdf: str, quantities: tuple[str, ...] = FIVE, count: int = 40) -> None:
    """Against the numbers of the file: rotations from its rpy, axes divided by their length, without rounding."""
    robot = rttrr_pin.load(urdf)
    states = Sampler(robot.model, "mixed", 2).draw(0, count)
    result = robot.compile((*quantities, *(name + "_bound" for name in quantities)))(states.q, states.v, states.a)
    truth = enclose(robot.model, states.q, states.v, states.a, (), "read")
    for name in quantities:
        enclosure = getattr(truth, name)
        off = np.maximum(np.maximum(enclosure.lower - result[name], result[name] - enclosure.upper), 0.0)
        assert (off <= result[name + "_bound"]).all(), name


@pytest.mark.one_in(2)
@pytest.mark.parametrize("quantities", [FIVE, ("tau",)], ids="-".join)
@pytest.mark.parametrize("seed", slow_after(2, range(12)))
def test_bounds_cover_what_reading_the_file_rounds(seed: int, quantities: tuple[str, ...]) -> None:
    check_file(random_tree(seed, 6), quantities)


def arm(axis: str, inertial: str, other: str = "") -> str:
    """One joint on a base, and what else there is."""
    return (
        '<robot name="r"><link name="base"/><joint name="j" type="continuous"><parent link="base"/><child link="a"/>'
        f'<axis xyz="{axis}"/></joint><link name="a">{inertial}</link>{other}</robot>'
    )


def inertial(xyz: str, mass: float, moment: float) -> str:
    return (
        f'<inertial><origin xyz="{xyz}"/><mass value="{mass}"/>'
        f'<inertia ixx="{moment}" ixy="0" ixz="0" iyy="{moment}" iyz="0" izz="{moment}"/></inertial>'
    )


def test_an_axis_whose_components_round_alike() -> None:
    """Their difference is no zero, though the doubles are equal."""
    check_file(arm("1.502 1.5020000000000002 0", inertial("1 1 0", 1, 0)))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("offset", ["0", "1", "0.9099999999999999"])
def test_a_follower_that_stands_still(offset: str) -> None:
    """Its angle is a number, and so are its sine and cosine, which are rounded."""
    follower = (
        '<joint name="k" type="continuous"><parent link="base"/><child link="b"/><axis xyz="1 0 0"/>'
        f'<mimic joint="j" multiplier="0" offset="{offset}"/></joint><link name="b">{inertial("0 0 1", 1, 1)}</link>'
    )
    urdf = arm("0 0 1", "", follower)
    check_file(urdf)
    robot = rttrr_pin.load(urdf)
    states = Sampler(robot.model).draw(0, 20)
    values, bounds_ = bounded_dynamics(robot.model, states.q, states.v, states.a)
    truth = enclose(robot.model, states.q, states.v, states.a, (), "read")
    assert ((truth.n.lower - bounds_.n <= values.n) & (values.n <= truth.n.upper + bounds_.n)).all()


def test_what_lies_on_an_axis_is_moved_with_errors_as_without() -> None:
    """A link merged over a fixed joint, with it on the axis: computed numbers, of which those off the axis are zero."""
    tip = '<joint name="f" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 0 0.5"/></joint>'
    urdf = arm("0 0 1", inertial("0 0 1", 0.1, 1), f'{tip}<link name="b">{inertial("0 0 0", 0.2, 1)}</link>')
    model = rttrr_pin.load(urdf).model
    plain, constants = (regroup(model, bodies(model, arithmetic))[1] for arithmetic in (TRACING, TRACING_WITH_ERRORS))
    for one, other in zip(plain, constants, strict=True):
        assert one.M == other.M == 0.0 and not any(one.r_C) and not any(other.r_C)
        for x, y in zip(one.I.rows, other.I.rows, strict=True):
            assert [*x] == [*y]
    check_file(urdf, ("tau",))


def test_tau_is_that_of_the_plain_kernel(rttrr: Robot) -> None:
    """Where no number of the robot is rounded but by moving inertia."""
    states = Sampler(rttrr.model, "mixed", 8).draw(0, 500)
    plain = rttrr.compile("tau")(states.q, states.v, states.a)
    result = rttrr.compile(("tau", "tau_bound"))(states.q, states.v, states.a)
    np.testing.assert_array_equal(plain, result["tau"])


@pytest.mark.one_in(3)
@pytest.mark.parametrize("emitter", sorted(EMITTERS))
def test_every_emitter_computes_bounds(emitter: str) -> None:
    check(rttrr_pin.load(random_chain(1, ("revolute", "prismatic", "continuous"))), "uniform", 0, emitter)


def test_bounds_are_of_the_size_of_rounding(rttrr: Robot) -> None:
    """A bound that allowed a wrong third digit would be no gate."""
    states = Sampler(rttrr.model, "uniform", 0).draw(0, 500)
    result = compiled(rttrr)(states.q, states.v, states.a)
    for name in FIVE:
        x, bound = (result[key].reshape(500, -1) for key in (name, name + "_bound"))
        assert (np.linalg.norm(bound, axis=1) <= ROUNDING * np.linalg.norm(x, axis=1)).all(), name
        assert bound.max() > 0.0


@pytest.mark.parametrize("what", ["rounding", "inherited"])
def test_a_bound_without_one_of_its_parts_is_exceeded(monkeypatch, what: str) -> None:
    """The check can fail: leave out the rounding of each operation, or what operands pass on."""
    if what == "rounding":
        monkeypatch.setattr(bounds._Bounder, "_is_exact", lambda self, z, args: True)
    else:
        monkeypatch.setattr(bounds._Bounder, "_inherited", lambda self, op, args: self._constant(0.0))
    robot = rttrr_pin.load("rttrr")  # no rotations of the file's, whose error would be bound enough
    with pytest.raises(AssertionError):
        check(robot, "uniform", 1, "numpy" if what == "rounding" else "c")


@pytest.mark.one_in(4)
def test_values_lie_within_their_bounds_of_the_plain_kernel_s(robot: Robot) -> None:
    """Rotations from the file have an error even where they are 0 or 1, so what is folded may differ."""
    states = Sampler(robot.model, "uniform", 7).draw(0, 100)
    plain = robot.compile(FIVE)(states.q, states.v, states.a)
    result = compiled(robot)(states.q, states.v, states.a)
    for name in FIVE:
        assert (np.abs(plain[name] - result[name]) <= 2 * result[name + "_bound"]).all(), name


def test_bounds_leave_the_bits_of_the_values(rttrr: Robot) -> None:
    """Where no number of the robot is rounded, the values are those of the plain kernel."""
    states = Sampler(rttrr.model, "mixed", 7).draw(0, 500)
    plain = rttrr.compile(FIVE)(states.q, states.v, states.a)
    result = compiled(rttrr)(states.q, states.v, states.a)
    for name in FIVE:
        np.testing.assert_array_equal(plain[name], result[name])


def test_the_operations_of_the_values_are_those_of_the_plain_kernel(robot: Robot) -> None:
    """Bounds come beside the program, and do not change it."""
    plain, bounded = build(robot.model, FIVE), build(robot.model, (*FIVE, *BOUNDS))
    values = bounded.results[: sum(field.width for field in plain.outputs)]
    count = lambda graph, nodes: [
        [graph.op[x] for x in graph.reachable(nodes)].count(op) for op in (Op.MUL, Op.ADD, Op.SUB)
    ]
    mine, theirs = count(bounded.graph, values), count(plain.graph, plain.results)
    assert mine[0] == theirs[0] and sum(mine[1:]) == sum(theirs[1:])


def test_a_bound_alone_can_be_asked_for(rttrr: Robot) -> None:
    states = Sampler(rttrr.model, "uniform", 0).draw(0, 5)
    both = rttrr.compile(("tau", "tau_bound"))(states.q, states.v, states.a)
    alone = rttrr.compile("tau_bound")(states.q, states.v, states.a)
    assert alone.shape == (5, 5)
    np.testing.assert_allclose(alone, both["tau_bound"], rtol=ROUNDING)


def test_quantities_that_follow_have_bounds_too(rttrr: Robot) -> None:
    q = np.random.default_rng(0).uniform(-1, 1, 5)
    result = rttrr.compile(("mass_matrix", "mass_matrix_bound"))(q)
    assert result["mass_matrix_bound"].shape == (5, 5)
    assert (result["mass_matrix_bound"] <= ROUNDING * np.abs(result["mass_matrix"]).max()).all()
