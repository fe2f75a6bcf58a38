"""CUDA C++, compiled for the CPU and run thread by thread: the bits of the kernels of this processor."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mpmath
import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot
from rttrr_pin.compile import QUANTITIES
from rttrr_pin.compile.build import straight_lines
from rttrr_pin.compile.emit import cuda_text, emitter
from rttrr_pin.compile.emit.cuda_driver import NONE
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.fields import Field, PayloadSlot
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import LARGEST
from support.cuda_on_cpu import OnCpu
from support.tolerances import ROUNDING
from support.trees import random_tree

STATES = 300
"""Two blocks and a part of a third."""

PLAIN = tuple(name for name in QUANTITIES if not name.endswith("_bound"))


@pytest.fixture(scope="module")
def tree() -> Robot:
    """A revolute, a continuous, a prismatic, a planar, a floating and a fixed joint, one that follows, and effects."""
    robot = rttrr_pin.load(random_tree(96, 6))
    assert any(joint.mimic for joint in robot.model.joints)
    return robot.with_joint_effects(
        {joint: JointEffects(0.1 * k, 0.2 * k, 0.3 * k) for k, joint in enumerate(robot.joint_names, start=1)}
    )


def drawn(fields: Sequence[Field], states: int = STATES) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [rng.uniform(-3, 3, (states, field.width)) for field in fields]


def empty(program: Program, states: int = STATES) -> list[np.ndarray]:
    return [np.full((states, field.width), 7.0) for field in program.outputs]


def of_llvm(program: Program, inputs: Sequence[np.ndarray]) -> list[np.ndarray]:
    """What the same program computes by LLVM."""
    how = emitter("llvm")
    outputs = empty(program, len(inputs[0]))
    how.load(how.emit(program), program.inputs, program.outputs).bind(inputs, outputs)(0, len(inputs[0]))
    return outputs


def check_same_bits(program: Program) -> None:
    inputs, outputs = drawn(program.inputs), empty(program)
    assert OnCpu(program)(STATES, [*inputs, *outputs]) == NONE
    for found, wanted in zip(outputs, of_llvm(program, inputs), strict=True):
        np.testing.assert_array_equal(found, wanted)


@pytest.fixture(scope="module")
def torques(rttrr: Robot) -> Program:
    return straight_lines(rttrr.model, ("tau",), (), fused=True)


@pytest.fixture(scope="module")
def kernel(torques: Program) -> OnCpu:
    return OnCpu(torques)


@pytest.fixture(scope="module")
def wanted(torques: Program) -> np.ndarray:
    return of_llvm(torques, drawn(torques.inputs))[0]


# ---- the same bits


@pytest.mark.parametrize("name", PLAIN)
def test_every_output_has_the_bits_of_the_kernel(rttrr: Robot, name: str) -> None:
    check_same_bits(straight_lines(rttrr.model, (name,), (), fused=True))


@pytest.mark.parametrize("outputs", [("tau", "tau_bound"), ("F", "N", "f", "n", "f_bound"), ("mass_matrix",)], ids=str)
def test_a_tree_has_the_bits_of_the_kernel(tree: Robot, outputs: tuple[str, ...]) -> None:
    check_same_bits(straight_lines(tree.model, outputs, (), fused=True))


def test_payloads_have_the_bits_of_the_kernel(tree: Robot) -> None:
    slots = (PayloadSlot(3), PayloadSlot(5, in_base=True))
    check_same_bits(straight_lines(tree.model, ("tau", "tau_bound"), slots, fused=True))


def test_what_does_not_fit_into_shared_memory_has_the_same_bits(tree: Robot) -> None:
    program = straight_lines(tree.model, ("regressor",), (), fused=True)
    assert cuda_text.shape(program.inputs, program.outputs, program.float_type).staged == program.inputs
    check_same_bits(program)
    wide = Program(*_many_inputs(200))
    assert cuda_text.shape(wide.inputs, wide.outputs, wide.float_type).staged == wide.outputs
    check_same_bits(wide)


def _many_inputs(width: int) -> tuple[Graph, tuple[Field, ...], tuple[Field, ...], tuple[int, ...]]:
    graph = Graph()
    total = graph.input(0)
    for k in range(1, width):
        total = graph.add(graph.mul(total, graph.constant(0.5)), graph.input(k))
    return graph, (Field("q", (width,)),), (Field("tau", (2,)),), (total, graph.neg(total))


def test_a_program_that_computes_nothing() -> None:
    graph = Graph()
    check_same_bits(Program(graph, (Field("q", (1,)),), (Field("tau", (2,)),), (graph.constant(-0.1), graph.input(0))))


# ---- any layout, any number of blocks, any order of threads

LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "rows": np.ascontiguousarray,
    "columns": np.asfortranarray,
    "every second row": lambda x: np.repeat(x, 2, axis=0)[::2],
    "every third column": lambda x: np.repeat(x, 3, axis=1)[:, ::3],
    "backwards": lambda x: x[::-1, ::-1].copy()[::-1, ::-1],
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same_bits(kernel: OnCpu, torques: Program, wanted: np.ndarray, layout: str) -> None:
    inputs = [LAYOUTS[layout](x) for x in drawn(torques.inputs)]
    out = LAYOUTS[layout](np.zeros((STATES, 5)))
    kernel(STATES, [*inputs, out])
    np.testing.assert_array_equal(out, wanted)


def test_one_row_for_all_states(kernel: OnCpu, torques: Program) -> None:
    q, v, a = drawn(torques.inputs)
    out = np.zeros((STATES, 5))
    kernel(STATES, [np.broadcast_to(q[3], q.shape), v, a, out])
    np.testing.assert_array_equal(out, of_llvm(torques, [np.tile(q[3], (STATES, 1)), v, a])[0])


@pytest.mark.parametrize("states", [0, 1, 31, 127, 128, 129, 256, 300])
@pytest.mark.parametrize("blocks", [1, 2, 5])
@pytest.mark.parametrize("backwards", [False, True])
def test_any_number_of_states_and_blocks_in_any_order_of_threads(
    kernel: OnCpu, torques: Program, wanted: np.ndarray, states: int, blocks: int, backwards: bool
) -> None:
    inputs, out = drawn(torques.inputs), np.full((STATES, 5), 7.0)
    assert kernel(states, [*inputs, out], blocks, backwards) == NONE
    np.testing.assert_array_equal(out[:states], wanted[:states])
    assert (out[states:] == 7.0).all()


@pytest.mark.parametrize("layout", ["rows", "columns"])
def test_results_may_lie_over_inputs(kernel: OnCpu, torques: Program, wanted: np.ndarray, layout: str) -> None:
    q, v, a = (LAYOUTS[layout](x) for x in drawn(torques.inputs))
    kernel(STATES, [q, v, a, a], blocks=2)
    np.testing.assert_array_equal(a, wanted)


def test_an_order_of_threads_that_matters_would_show(tree: Robot) -> None:
    """Inputs pass through shared memory and outputs do not: the next block's numbers must wait for the last thread."""
    program = straight_lines(tree.model, ("regressor",), (), fused=True)
    kernel, inputs = OnCpu(program), drawn(program.inputs)
    one, other = empty(program), empty(program)
    kernel(STATES, [*inputs, *one], blocks=1)
    kernel(STATES, [*inputs, *other], blocks=1, backwards=True)
    np.testing.assert_array_equal(one[0], other[0])


# ---- what is not finite


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", range(3))
def test_the_first_state_that_is_not_finite_is_named(
    kernel: OnCpu, torques: Program, wanted: np.ndarray, bad: float, place: int
) -> None:
    """Also of q[0] and q[1], on which no torque of this arm depends; other states are computed all the same."""
    for joint in range(5):
        inputs, out = drawn(torques.inputs), np.zeros((STATES, 5))
        inputs[place][[288, 131], joint] = bad
        assert kernel(STATES, [*inputs, out], backwards=bool(joint % 2)) == 131
        np.testing.assert_array_equal(np.delete(out, [131, 288], axis=0), np.delete(wanted, [131, 288], axis=0))


def test_overflow_and_the_sign_of_infinity_are_reported() -> None:
    graph = Graph()
    q = graph.input(0)
    made = Program(
        graph,
        (Field("q", (1,)),),
        (Field("tau", (2,)),),
        (graph.mul(q, q), graph.function(Op.SIGN, q)),
    )
    for value in (1e200, np.inf, -np.inf, np.nan):
        out = np.zeros((2, 2))
        assert OnCpu(made)(2, [np.array([[1.0], [value]]), out]) == 1
        assert out[0].tolist() == [1.0, 1.0]
    infinite = Program(graph, made.inputs, (Field("tau", (1,)),), (graph.constant(-np.inf),))
    out = np.zeros((1, 1))
    assert OnCpu(infinite)(1, [np.zeros((1, 1)), out]) == 0 and out[0, 0] == -np.inf


# ---- sines


def test_sines_and_cosines_of_hard_angles() -> None:
    graph = Graph()
    q = graph.input(0)
    made = Program(
        graph,
        (Field("q", (1,)),),
        (Field("tau", (2,)),),
        (graph.function(Op.SIN, q), graph.function(Op.COS, q)),
    )
    multiples = np.arange(-50, 50) * np.pi / 4
    angles = np.concatenate(
        [
            multiples,
            np.nextafter(multiples, np.inf),
            [0.0, -0.0, 5e-324, 1e-300, 1e-8, LARGEST, np.nextafter(LARGEST, np.inf), -1e6, 1e15, 1e22],
            np.array([14479, 14848, 45678, 57916, 83442, 58285, 59023]) * np.pi / 2,
        ]
    )[:, None]
    out = np.zeros((len(angles), 2))
    assert OnCpu(made)(len(angles), [angles, out]) == NONE
    np.testing.assert_array_equal(out, of_llvm(made, [angles])[0])
    with mpmath.workprec(2000):
        for (s, co), (x,) in zip(out, angles, strict=True):
            assert abs(s - mpmath.sin(x)) <= ROUNDING * abs(mpmath.sin(x)), x
            assert abs(co - mpmath.cos(x)) <= ROUNDING * abs(mpmath.cos(x)), x
