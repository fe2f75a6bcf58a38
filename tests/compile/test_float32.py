"""Kernels in float32: within their bounds of the true values, the same bits in any batch, and nothing unreported."""

from __future__ import annotations

import copy
import pickle
import subprocess
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.compile import Kernel, bounds
from rttrr_pin.compile.bounds import with_bounds
from rttrr_pin.compile.cache import VARIABLE
from rttrr_pin.compile.constants import ConstantWithError, error_of
from rttrr_pin.compile.emit import EMITTERS, c, emitter
from rttrr_pin.compile.expression import FUSED, Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.float_type import FLOAT32, FLOAT64, FloatType
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import IN_FLOAT32
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import InputError, NumberError
from rttrr_pin.exact import enclose
from rttrr_pin.implementations import Batch
from rttrr_pin.implementations.allowance import SINGLE, default_allowance
from rttrr_pin.implementations.protocol import shape_of
from rttrr_pin.validation import Sampler
from support.serial_chains import random_chain
from support.slow import slow_after
from support.tolerances import SINCOS_ULPS, norm_error
from support.trees import extreme_tree, random_tree

FIVE = ("tau", "F", "N", "f", "n")
WITH_BOUNDS = (*FIVE, *(name + "_bound" for name in FIVE))
STATES = 40


def held(states: Batch) -> Batch:
    """The nearest states that float32 holds."""
    q, v, a = (x.astype(np.float32).astype(float) for x in (states.q, states.v, states.a))
    loads = tuple(
        Load(x.link, *(y.astype(np.float32).astype(float) for y in (x.f, x.n)), x.in_base) for x in states.loads
    )
    return Batch(states.model, q, v, a, loads)


def extreme(robot: Robot, seed: int, rows: int = STATES) -> Batch:
    """Each number of any size, its sign by chance, one in seven zero; rates and angles as far as their squares go."""
    rng = np.random.default_rng(seed)

    def numbers(count: int, most: float) -> np.ndarray:
        sizes = 10 ** rng.uniform(-46, most, (rows, count)) * rng.choice([-1, 1], (rows, count))
        return np.where(rng.random((rows, count)) < 1 / 7, 0.0, sizes)

    model = robot.model
    q, v, a = numbers(model.nq, 6), numbers(model.nv, 14), numbers(model.nv, 30)
    for at in model.quaternions:
        quaternion = rng.normal(size=(rows, 4))
        q[:, at : at + 4] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    return held(Batch(model, q, v, a, (Load(len(model.links) - 1, numbers(3, 30), numbers(3, 30)),)))


def computed(robot: Robot, states: Batch, quantities: tuple[str, ...], emitter: str | None = None) -> dict[str, Any]:
    """Values and bounds in float32; what overflows is infinite or no number."""
    names = (*quantities, *(name + "_bound" for name in quantities))
    kernel = robot.compile(names, emitter, dtype="float32")
    shapes = {name: shape_of(robot.model, name.removesuffix("_bound")) for name in names}
    out = {name: np.empty((len(states), *shape), np.float32) for name, shape in shapes.items()}
    with suppress(NumberError):
        kernel(states.q, states.v, states.a, payload=list(states.loads) or None, out=out)
    return out


def check(
    robot: Robot, states: Batch, quantities: tuple[str, ...] = FIVE, emitter: str | None = None, least: float = 1.0
) -> None:
    """No number is farther from the true one of the file's numbers than its bound; so many states do not overflow."""
    result = computed(robot, states, quantities, emitter)
    truth = enclose(robot.model, states.q, states.v, states.a, states.loads, "read")
    for name in quantities:
        value, bound = (result[key].astype(float) for key in (name, name + "_bound"))
        fine = np.isfinite(bound) & np.isfinite(value)
        assert fine.reshape(len(states), -1).all(axis=1).mean() >= least
        enclosure = getattr(truth, name)
        off = np.maximum(np.maximum(enclosure.lower - value, value - enclosure.upper), 0.0)
        assert (off <= bound)[fine].all(), name


def ordinary(robot: Robot, sampling: str, seed: int) -> Batch:
    return held(Sampler(robot.model, sampling, seed, RandomPayload(robot.link_names[-1])).draw(0, STATES))


# Values and bounds


@pytest.mark.one_in(8)
@pytest.mark.parametrize("sampling", slow_after(2, ["uniform", "mixed", "large-velocities", "corners", "zeros"]))
def test_no_true_error_exceeds_its_bound(robot: Robot, sampling: str) -> None:
    check(robot, ordinary(robot, sampling, 3))


@pytest.mark.one_in(2)
@pytest.mark.parametrize("seed", slow_after(2, range(6)))
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("quantities", [FIVE, ("tau",)], ids="-".join)
def test_no_true_error_exceeds_its_bound_in_trees(seed: int, base: Any, quantities: tuple[str, ...]) -> None:
    """Of all joints and followers, with friction and a payload; asked for tau alone, with inertia moved."""
    robot = rttrr_pin.load(random_tree(seed, 6), base=base, friction=True)
    check(robot, ordinary(robot, "mixed", seed), quantities, "numpy")


@pytest.mark.one_in(2)
@pytest.mark.parametrize("seed", slow_after(2, range(6)))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_no_true_error_exceeds_its_bound_where_numbers_have_any_size(seed: int, base: Any) -> None:
    """Denormal, zero, beyond the range of the polynomials, up to where squares overflow."""
    robot = rttrr_pin.load(random_tree(seed, 4), base=base, friction=True)
    check(robot, extreme(robot, seed), FIVE, "numpy", least=0.5)


@pytest.mark.one_in(2)
@pytest.mark.parametrize("seed", slow_after(1, range(4)))
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("orders", [12.0, 30.0])
def test_no_true_error_exceeds_its_bound_where_a_robot_s_numbers_have_any_size(
    seed: int, base: Any, orders: float
) -> None:
    """Most of them lose all digits to rounding, or vanish, or do not fit into float32."""
    robot = rttrr_pin.load(extreme_tree(seed, 4, orders), base=base, friction=True)
    for states in (ordinary(robot, "mixed", seed), extreme(robot, seed)):
        check(robot, states, FIVE, "numpy", least=0.0)


@pytest.mark.parametrize("name", EMITTERS)
def test_every_emitter_keeps_its_bounds(name: str) -> None:
    robot = rttrr_pin.load(random_chain(1, ("revolute", "prismatic", "continuous")))
    check(robot, ordinary(robot, "uniform", 0), emitter=name)
    check(robot, extreme(robot, 1), emitter=name, least=0.5)


@pytest.mark.parametrize("what", ["rounding", "numbers"])
def test_a_bound_without_one_of_its_parts_is_exceeded(monkeypatch: pytest.MonkeyPatch, what: str) -> None:
    """The check can fail: leave out what operations round, or what rounding the robot's numbers does."""
    monkeypatch.setenv(VARIABLE, "")
    if what == "rounding":
        monkeypatch.setattr(bounds._Bounder, "_is_exact", lambda self, z, args: True)
    else:
        monkeypatch.setattr(bounds._Bounder, "_units", lambda self, error: 0.0)
    robot = rttrr_pin.load("rttrr")
    with pytest.raises(AssertionError):
        check(robot, ordinary(robot, "uniform", 1), ("tau",) if what == "rounding" else ("F",), "numpy")


@pytest.mark.one_in(3)
def test_bounds_are_tighter_than_what_a_program_in_float32_is_allowed(robot: Robot) -> None:
    """By far for robots whose axes are x, y, z; less where each rotation of the file is rounded."""
    states = ordinary(robot, "uniform", 5)
    result = computed(robot, states, FIVE)
    allowed = default_allowance(states, SINGLE)
    for name in FIVE:
        bound = result[name + "_bound"].astype(float)
        bound = bound if name == "tau" else np.linalg.norm(bound, axis=-1)
        assert (bound <= 4 * allowed[name]).all(), name
        assert bound.sum() <= allowed[name].sum(), name


@pytest.mark.one_in(3)
def test_values_are_those_of_the_kernel_in_float64_but_for_rounding(robot: Robot) -> None:
    states = ordinary(robot, "uniform", 6)
    result, double = (
        computed(robot, states, FIVE),
        robot.compile(FIVE)(states.q, states.v, states.a, list(states.loads)),
    )
    for name in FIVE:
        assert result[name].dtype == np.float32
        assert norm_error(result[name], double[name]) <= 1e-5


# Operations: any program, any numbers


def nearest(x: Fraction) -> Fraction:
    """The float32 nearest to a number, half to even, below the normal ones too."""
    if not x:
        return x
    size = abs(x)
    exponent = size.numerator.bit_length() - size.denominator.bit_length()
    exponent -= size < Fraction(2) ** exponent
    unit = Fraction(2) ** (max(exponent, -126) - 23)
    return round(x / unit) * unit


EXACTLY: dict[Op, Callable[..., Fraction]] = {
    Op.ADD: lambda x, y: x + y,
    Op.SUB: lambda x, y: x - y,
    Op.MUL: lambda x, y: x * y,
    Op.NEG: lambda x: -x,
    Op.ABS: abs,
    Op.FMA: lambda x, y, z: x * y + z,
    Op.FMS: lambda x, y, z: x * y - z,
    Op.FNMA: lambda x, y, z: z - x * y,
}


def in_float32(program: Program, inputs: list[Fraction]) -> list[Fraction]:
    """The results, each operation rounded once."""
    graph, values = program.graph, {}
    for x in program.order:
        op, args = graph.op[x], graph.args[x]
        if op is Op.CONSTANT:
            values[x] = nearest(Fraction(float(graph.value[x])))
        elif op is Op.INPUT:
            values[x] = inputs[args[0]]
        else:
            values[x] = nearest(EXACTLY[op](*(values[y] for y in args)))
    return [values[x] for x in program.results]


def reals(least: int, most: int) -> st.SearchStrategy[float]:
    """Numbers of float32 of sizes 2^least and up, and zero."""
    sizes = st.builds(lambda m, e: float(np.float32(m * 2.0**e)), st.floats(1.0, 2.0), st.integers(least, most))
    return st.one_of(st.just(0.0), st.builds(lambda x, sign: x * sign, sizes, st.sampled_from([-1.0, 1.0])))


places = st.integers(0, 10**6)
steps = st.lists(st.tuples(st.sampled_from(list(EXACTLY)), places, places, places), min_size=1, max_size=10)
constants = st.one_of(
    st.builds(ConstantWithError, st.floats(-1e3, 1e3), st.sampled_from([0.0, 1e-17, 1e-9])),
    st.builds(ConstantWithError, st.floats(-1e-30, 1e-30), st.sampled_from([0.0, 1e-47])),
    st.builds(ConstantWithError, st.sampled_from([0.5, -0.25, 2.0, 1.0 + 2.0**-30, 2.0**-40, 2.0**-149])),
)


def check_operations(steps, inputs, numbers, side: int) -> None:
    """The true values lie within the bounds of a random program, in rational arithmetic."""
    graph = Graph()
    nodes = [*(graph.input(k) for k in range(len(inputs))), *(graph.constant(x) for x in numbers)]
    # A number with an error truly is at one end of it.
    true = [*map(Fraction, inputs), *(Fraction(float(x)) + side * Fraction(error_of(x)) for x in numbers)]
    for op, *chosen in steps:
        count = 1 if op in (Op.NEG, Op.ABS) else 3 if op in FUSED else 2
        chosen = [place % len(nodes) for place in chosen[:count]]
        true.append(EXACTLY[op](*(true[k] for k in chosen)))
        nodes.append(graph.apply(op, [nodes[k] for k in chosen]))
    outputs = Field("x", (len(nodes),)), Field("x_bound", (len(nodes),))
    program = Program(graph, (Field("q", (len(inputs),)),), outputs[:1], tuple(nodes), FLOAT32)
    found = in_float32(with_bounds(program, outputs, fused=True), [Fraction(x) for x in inputs])
    for value, bound, truth in zip(found[: len(nodes)], found[len(nodes) :], true, strict=True):
        assert abs(value - truth) <= bound


@settings(max_examples=100)
@given(
    steps=steps,
    inputs=st.lists(reals(-149, 20), min_size=3, max_size=3),
    numbers=st.lists(constants, min_size=2, max_size=2),
)
@pytest.mark.parametrize("side", [-1, 1])
def test_the_bound_of_any_program_covers_what_rounding_does(steps, inputs, numbers, side: int) -> None:
    check_operations(steps, inputs, numbers, side)


# Sine and cosine


def sincos(angles: np.ndarray, float_type: FloatType) -> np.ndarray:
    """By machine code, (N, 2)."""
    graph = Graph()
    q = graph.input(0)
    results = (graph.function(Op.SIN, q), graph.function(Op.COS, q))
    program = Program(graph, (Field("q", (1,)),), (Field("sincos", (2,)),), results, float_type)
    how = emitter("llvm")
    out = np.empty((len(angles), 2), float_type.name)
    how.load(how.emit(program), program.inputs, program.outputs).bind([angles[:, None]], [out])(0, len(angles))
    return out


def test_sine_and_cosine_are_within_a_unit_in_the_last_place() -> None:
    """Of any bits; next to multiples of pi/2, where they vanish; beside the limit, beyond it, and denormal."""
    rng = np.random.default_rng(0)
    bits = rng.integers(0, 2**31 - 2**23, 200_000, dtype=np.uint32)
    multiples = (np.arange(1, 90_000) * (np.pi / 2)).astype(np.float32)
    limit = (np.float32(IN_FLOAT32.largest).view(np.uint32) + np.arange(-50, 50)).astype(np.uint32).view(np.float32)
    turns = rng.uniform(-7, 7, 100_000).astype(np.float32)
    x = np.r_[bits.view(np.float32), multiples, np.nextafter(multiples, 0), limit, turns, 1e-45, 1e-38, 3e38]
    x = np.r_[x, -x].astype(np.float32)
    found, true = sincos(x, FLOAT32), sincos(x.astype(float), FLOAT64)  # of float64 within 2^-29 of such a unit
    assert (np.abs(found - true) <= SINCOS_ULPS * np.spacing(np.abs(true).astype(np.float32))).all()
    assert np.abs(found).max() <= 1.0
    np.testing.assert_array_equal(found[: len(x) // 2] * [-1, 1], found[len(x) // 2 :])
    assert sincos(np.zeros(1, np.float32), FLOAT32).tolist() == [[0.0, 1.0]]
    assert np.isnan(sincos(np.array([np.inf, -np.inf, np.nan], np.float32), FLOAT32)).all()


# The same bits


@pytest.fixture(scope="module", params=EMITTERS)
def kernel(rttrr: Robot, request: pytest.FixtureRequest) -> Kernel:
    return rttrr.compile("tau", request.param, dtype="float32")


def some(rows: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    q, v, a = np.random.default_rng(seed).uniform(-3, 3, (3, rows, 5)).astype(np.float32)
    q[3::17] *= 1e6  # beyond the polynomials
    return q, v, a


LAYOUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "columns": np.asfortranarray,
    "every second row": lambda x: np.repeat(x, 2, axis=0)[::2],
    "every third column": lambda x: np.repeat(x, 3, axis=1)[:, ::3],
    "backwards": lambda x: x[::-1, ::-1].copy()[::-1, ::-1],
    "float64": lambda x: x.astype(float),
    "columns of float64": lambda x: np.asfortranarray(x.astype(float)),
    "other byte order": lambda x: x.astype(x.dtype.newbyteorder()),
    "lists": lambda x: x.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("rows", [1, 3, 70, 200])
def test_the_layout_does_not_change_a_bit(kernel: Kernel, layout: str, rows: int) -> None:
    arrays = some(rows)
    expected = kernel(*arrays)
    assert expected.dtype == np.float32
    other = [LAYOUTS[layout](x) for x in arrays]
    np.testing.assert_array_equal(kernel(*other), expected)
    np.testing.assert_array_equal(kernel(arrays[0], other[1], arrays[2]), expected)
    for out in (
        np.empty((rows, 5), np.float32),
        np.empty((5, rows), np.float32).T,
        np.ones((rows, 9), np.float32)[:, ::2],
    ):
        assert kernel(*other, out=out) is out
        np.testing.assert_array_equal(out, expected)


@pytest.mark.parametrize("rows", [1, 2, 7, 63, 64, 65])
def test_a_state_has_the_same_bits_in_any_block(kernel: Kernel, rows: int) -> None:
    arrays = some(200)
    together = kernel(*arrays)
    for start in range(0, 200 - rows + 1, max(1, rows // 2)):
        np.testing.assert_array_equal(
            kernel(*(x[start : start + rows] for x in arrays)), together[start : start + rows]
        )
    np.testing.assert_array_equal(kernel(*(x[5] for x in arrays)), together[5])
    np.testing.assert_array_equal(kernel(*arrays, out=arrays[2]), together)


def test_threads_change_no_bit(kernel: Kernel) -> None:
    arrays = some(20_000)
    np.testing.assert_array_equal(kernel(*arrays, threads=3), kernel(*arrays, threads=1))


def test_a_payload_has_the_same_bits_at_any_call(kernel: Kernel) -> None:
    """Also at the second one, which the entry for single states takes."""
    load = Wrench((0.1, 20.0, -3.0), (1.0, 1 / 3, 0.2))
    q, v, a = (x[0] for x in some(1))
    first = kernel(q, v, a, payload=load)
    wide = [np.stack([x] * 3) for x in (q, v, a)]
    np.testing.assert_array_equal(kernel(q, v, a, payload=load), first)
    np.testing.assert_array_equal(kernel(*wide, payload=load)[1], first)
    assert (first != kernel(q, v, a)).any()


def test_several_outputs(rttrr: Robot) -> None:
    arrays = some(70)
    both = rttrr.compile(("tau", "f"), dtype="float32")
    result, single = both(*arrays), both(*(x[9] for x in arrays))
    assert {name: (x.shape, x.dtype.name) for name, x in result.items()} == {
        "tau": ((70, 5), "float32"),
        "f": ((70, 6, 3), "float32"),
    }
    for name in result:
        np.testing.assert_array_equal(single[name], result[name][9])


def test_a_program_of_calls_keeps_to_what_such_programs_are_allowed() -> None:
    robot = rttrr_pin.load(random_tree(5, 7), friction=True)
    states = held(Sampler(robot.model, "mixed", 0).draw(0, 70))
    truth = enclose(robot.model, states.q, states.v, states.a, (), "read")
    allowed = default_allowance(states, SINGLE)
    for name in ("llvm", "numpy"):
        result = Kernel(robot.model, FIVE, name, 1, "float32")(states.q, states.v, states.a)
        for key in FIVE:
            off = result[key] - getattr(truth, key).mid
            assert result[key].dtype == np.float32
            assert ((np.abs(off) if key == "tau" else np.linalg.norm(off, axis=-1)) <= allowed[key]).all(), key


# The type, said and refused


@pytest.mark.parametrize("dtype", ["float32", "f4", np.float32, np.dtype(np.float32), "single"])
def test_the_type_has_many_names_and_one_kernel(rttrr: Robot, dtype: Any) -> None:
    kernel = rttrr.compile("tau", dtype=dtype)
    assert kernel is rttrr.compile("tau", dtype="float32") is not rttrr.compile("tau")
    assert kernel.dtype == np.float32 and rttrr.compile("tau").dtype == np.float64
    assert rttrr.compile("tau", dtype=float) is rttrr.compile("tau")
    assert "in float32 by" in repr(kernel)


@pytest.mark.parametrize("dtype", ["float16", "int32", np.longdouble, ">f4", "nonsense", None, 7])
def test_other_types_are_refused(rttrr: Robot, dtype: Any) -> None:
    with pytest.raises(InputError, match="pass 'float64' or 'float32'"):
        rttrr.compile("tau", dtype=dtype)


def test_out_must_have_the_type(kernel: Kernel) -> None:
    arrays = some(2)
    with pytest.raises(
        InputError, match=r"array of float64: expected a float32 array, such as np.empty\(\(2, 5\), np.float32\)"
    ):
        kernel(*arrays, out=np.empty((2, 5)))


def test_copies_compute_in_the_same_type(kernel: Kernel) -> None:
    arrays = some(9)
    for other in (copy.deepcopy(kernel), pickle.loads(pickle.dumps(kernel))):
        assert other.dtype == np.float32
        np.testing.assert_array_equal(other(*arrays), kernel(*arrays))


def test_kernels_of_both_types_are_kept_apart(rttrr: Robot, folder: Path) -> None:
    """On disk."""
    arrays = some(9)
    results = [Kernel(rttrr.model, "tau", dtype=dtype)(*arrays) for dtype in ("float64", "float32") * 2]
    assert len(list(folder.iterdir())) == 2
    np.testing.assert_array_equal(results[0], results[2])
    np.testing.assert_array_equal(results[1], results[3])
    assert [x.dtype.name for x in results[:2]] == ["float64", "float32"] and (results[0] != results[1]).any()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("row", [0, 69])
def test_what_is_not_finite_is_named(kernel: Kernel, bad: float, row: int) -> None:
    """Also q[0] and q[1], on which no torque of this arm depends."""
    for place, joint in ((0, 0), (0, 4), (1, 2), (2, 3)):
        arrays = some(70)
        arrays[place][row, joint] = bad
        with pytest.raises(NumberError) as caught:
            kernel(*arrays)
        assert caught.value.index == (row, joint) and caught.value.joint == f"joint_{joint + 1}"


@pytest.mark.parametrize("size", [1e25, 1e200])
def test_overflow_is_named(kernel: Kernel, size: float) -> None:
    """Of squares, and of numbers that float32 does not hold."""
    q, v, a = (x.astype(float) for x in some(70))
    v[66] = size
    with pytest.raises(NumberError, match="tau overflows in state 66"):
        kernel(q, v, a)


def test_quaternions_need_the_length_that_float32_gives_them() -> None:
    robot = rttrr_pin.load("rttrr", base="floating")
    q, v, a = (x[0] for x in (lambda s: (s.q, s.v, s.a))(Sampler(robot.model, "uniform", 0).draw(0, 1)))
    single = robot.compile("tau", dtype="float32")
    with pytest.raises(NumberError, match="has a quaternion"):
        robot.compile("tau")(q.astype(np.float32), v, a)
    np.testing.assert_array_equal(single(q, v, a), single(q.astype(np.float32).tolist(), v, a))
    q[3] += 1e-3
    with pytest.raises(NumberError, match="has a quaternion"):
        single(q, v, a)


# C


def test_the_source_in_c_has_its_bits(rttrr: Robot, tmp_path: Path) -> None:
    q, v, a = some(1)
    text = rttrr.compile(dtype="float32").source()
    assert "void rttrr_tau(const float *q, const float *v, const float *a, float *tau);" in text
    assert "double" not in text
    given = ", ".join(
        f"{n}[5] = {{{', '.join(map(repr, x[0].tolist()))}}}" for n, x in zip("qva", (q, v, a), strict=True)
    )
    main = f'float {given}; rttrr_tau(q, v, a, a); for (int i = 0; i < 5; ++i) printf("%.9g ", (double)a[i]);'
    path = tmp_path / "main.c"
    path.write_text(f"{text}\n#include <stdio.h>\nint main(void) {{ {main} return 0; }}\n")
    strict = [
        "-std=c99",
        "-pedantic",
        "-Wall",
        "-Wextra",
        "-Wno-unused-parameter",
        "-Wdouble-promotion",
        "-Werror",
        "-O1",
    ]
    subprocess.run([*c.compiler(), *strict, "-o", str(tmp_path / "main"), str(path), "-lm"], check=True)
    printed = subprocess.run([str(tmp_path / "main")], check=True, capture_output=True, text=True).stdout
    expected = rttrr.compile(emitter="c", dtype="float32")(q, v, a)[0]
    np.testing.assert_array_equal(np.array(printed.split(), dtype=np.float32), expected)
