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
from rttrr_pin.compile.float_type import FLOAT32, FLOAT64, FloatType
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import LARGEST
from support.cuda_on_cpu import OnCpu
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


def drawn(program: Program, states: int = STATES) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [rng.uniform(-3, 3, (states, field.width)).astype(program.float_type.name) for field in program.inputs]


def empty(program: Program, states: int = STATES) -> list[np.ndarray]:
    return [np.full((states, field.width), 7.0, program.float_type.name) for field in program.outputs]


def of_llvm(program: Program, inputs: Sequence[np.ndarray]) -> list[np.ndarray]:
    """What the same program computes by LLVM."""
    how = emitter("llvm")
    outputs = empty(program, len(inputs[0]))
    how.load(how.emit(program), program.inputs, program.outputs).bind(inputs, outputs)(0, len(inputs[0]))
    return outputs


def check_same_bits(program: Program) -> None:
    inputs, outputs = drawn(program), empty(program)
    assert OnCpu(program)(STATES, [*inputs, *outputs]) == NONE
    for found, wanted in zip(outputs, of_llvm(program, inputs), strict=True):
        np.testing.assert_array_equal(found, wanted)


@pytest.fixture(scope="module")
def torques(rttrr: Robot) -> Program:
    return straight_lines(rttrr.model, ("tau",), (), True)


@pytest.fixture(scope="module")
def kernel(torques: Program) -> OnCpu:
    return OnCpu(torques)


@pytest.fixture(scope="module")
def wanted(torques: Program) -> np.ndarray:
    return of_llvm(torques, drawn(torques))[0]


# ---- the same bits


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", PLAIN)
def test_every_output_has_the_bits_of_the_kernel(rttrr: Robot, name: str) -> None:
    check_same_bits(straight_lines(rttrr.model, (name,), (), True))


@pytest.mark.one_in(4)
@pytest.mark.parametrize("float_type", [FLOAT64, FLOAT32], ids=lambda own: own.name)
@pytest.mark.parametrize("outputs", [("tau", "tau_bound"), ("F", "N", "f", "n", "f_bound"), ("mass_matrix",)], ids=str)
def test_a_tree_has_the_bits_of_the_kernel(tree: Robot, outputs: tuple[str, ...], float_type: FloatType) -> None:
    check_same_bits(straight_lines(tree.model, outputs, (), True, float_type))


@pytest.mark.parametrize("float_type", [FLOAT64, FLOAT32], ids=lambda own: own.name)
def test_payloads_have_the_bits_of_the_kernel(tree: Robot, float_type: FloatType) -> None:
    slots = (PayloadSlot(3), PayloadSlot(5, in_base=True))
    check_same_bits(straight_lines(tree.model, ("tau",), slots, True, float_type))


def wide(inputs: int, outputs: int) -> Program:
    """A program with so many inputs and outputs, each of which depends on all."""
    graph = Graph()
    total = graph.input(0)
    for k in range(1, inputs):
        total = graph.add(graph.mul(total, graph.constant(0.5)), graph.input(k))
    results = tuple(graph.mul(total, graph.constant(float(k))) for k in range(1, outputs + 1))
    return Program(graph, (Field("q", (inputs,)),), (Field("tau", (outputs,)),), results)


@pytest.mark.parametrize(("inputs", "outputs", "staged"), [(200, 2, "tau"), (2, 200, "q"), (200, 200, "")])
def test_what_does_not_fit_into_shared_memory_has_the_same_bits(inputs: int, outputs: int, staged: str) -> None:
    program = wide(inputs, outputs)
    shape = cuda_text.shape(program.inputs, program.outputs, program.float_type)
    assert [field.name for field in shape.staged] == list(filter(None, [staged]))
    check_same_bits(program)


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
    inputs = [LAYOUTS[layout](x) for x in drawn(torques)]
    out = LAYOUTS[layout](np.zeros((STATES, 5)))
    kernel(STATES, [*inputs, out])
    np.testing.assert_array_equal(out, wanted)


def test_one_row_for_all_states(kernel: OnCpu, torques: Program) -> None:
    q, v, a = drawn(torques)
    out = np.zeros((STATES, 5))
    kernel(STATES, [np.broadcast_to(q[3], q.shape), v, a, out])
    np.testing.assert_array_equal(out, of_llvm(torques, [np.tile(q[3], (STATES, 1)), v, a])[0])


@pytest.mark.parametrize("states", [0, 1, 31, 127, 128, 129, 256, 300])
@pytest.mark.parametrize("blocks", [1, 2, 5])
@pytest.mark.parametrize("backwards", [False, True])
def test_any_number_of_states_and_blocks_in_any_order_of_threads(
    kernel: OnCpu, torques: Program, wanted: np.ndarray, states: int, blocks: int, backwards: bool
) -> None:
    inputs, out = drawn(torques), np.full((STATES, 5), 7.0)
    assert kernel(states, [*inputs, out], blocks, backwards) == NONE
    np.testing.assert_array_equal(out[:states], wanted[:states])
    assert (out[states:] == 7.0).all()


@pytest.mark.parametrize("layout", ["rows", "columns"])
def test_results_may_lie_over_inputs(kernel: OnCpu, torques: Program, wanted: np.ndarray, layout: str) -> None:
    q, v, a = (LAYOUTS[layout](x) for x in drawn(torques))
    kernel(STATES, [q, v, a, a], blocks=2)
    np.testing.assert_array_equal(a, wanted)


@pytest.mark.parametrize(("inputs", "outputs"), [(200, 2), (2, 200), (3, 4)])
def test_numbers_in_shared_memory_wait_for_the_last_thread(inputs: int, outputs: int) -> None:
    """Also where only what is read, or only what is written, passes through it."""
    program = wide(inputs, outputs)
    kernel, arrays, results = OnCpu(program), drawn(program), [empty(program) for _ in range(2)]
    for out, backwards in zip(results, (False, True), strict=True):
        kernel(STATES, [*arrays, *out], blocks=1, backwards=backwards)
    np.testing.assert_array_equal(results[0][0], results[1][0])


# ---- what is not finite


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", range(3))
def test_the_first_state_that_is_not_finite_is_named(
    kernel: OnCpu, torques: Program, wanted: np.ndarray, bad: float, place: int
) -> None:
    """Also of q[0] and q[1], on which no torque of this arm depends; other states are computed all the same."""
    for joint in range(5):
        inputs, out = drawn(torques), np.zeros((STATES, 5))
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


@pytest.mark.parametrize("float_type", [FLOAT64, FLOAT32], ids=lambda own: own.name)
def test_sines_and_cosines_of_hard_angles(float_type: FloatType) -> None:
    graph = Graph()
    q = graph.input(0)
    results = (graph.function(Op.SIN, q), graph.function(Op.COS, q))
    made = Program(graph, (Field("q", (1,)),), (Field("tau", (2,)),), results, float_type)
    multiples = np.arange(-50, 50) * np.pi / 4
    hard = [0.0, -0.0, 5e-324, 1e-300, 1e-8, LARGEST, np.nextafter(LARGEST, np.inf), -1e6, 1e15, 1e22]
    near_zeros = np.array([14479, 14848, 45678, 57916, 83442, 58285, 59023]) * np.pi / 2
    angles = np.concatenate([multiples, np.nextafter(multiples, np.inf), hard, near_zeros])[:, None]
    angles = angles.astype(float_type.name)
    out = np.zeros((len(angles), 2), float_type.name)
    assert OnCpu(made)(len(angles), [angles, out]) == NONE
    np.testing.assert_array_equal(out, of_llvm(made, [angles])[0])
    allowed = 2 * float_type.sine_ulps * float_type.unit_roundoff
    with mpmath.workprec(2000):
        for (s, c), (x,) in zip(out.astype(float), angles.astype(float), strict=True):
            assert abs(s - mpmath.sin(x)) <= allowed * abs(mpmath.sin(x)), x
            assert abs(c - mpmath.cos(x)) <= allowed * abs(mpmath.cos(x)), x
