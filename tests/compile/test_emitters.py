"""Every emitter: the reference's numbers, the same bits however a batch is cut or laid out, and nothing unreported."""

from __future__ import annotations

import math
import subprocess
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, Wrench
from rttrr_pin.compile.cache import VARIABLE
from rttrr_pin.compile.emit import EMITTERS, c, emitter
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import LARGEST
from rttrr_pin.compile.threads import PART
from rttrr_pin.errors import InputError, NumberError, UnknownNameError
from support.recursion import recursion
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

ANGLES = np.array(
    [k * np.pi / 2 for k in (-7, -4, -3, -2, -1, 1, 2, 3, 4, 5, 10, 1001, 83443)]
    + [0.0, -0.0, 1e-300, -1e-300, 5e-324, 1e-8, np.pi / 4, np.nextafter(np.pi / 4, 1), 3 * np.pi / 4, 1.0, -2.5]
    + [1e3, 1e5, LARGEST, np.nextafter(LARGEST, 0), np.nextafter(LARGEST, np.inf), -1e6, 1e6, 1e15, 1e22, -1e300]
)
"""Where sines are hard: near their zeros, tiny, at the ends of a quadrant, and huge."""

TREE = random_tree(96, 6)
"""A revolute, a continuous, a prismatic, a planar, a floating and a fixed joint, and one that follows another."""


@pytest.fixture(scope="module", autouse=True)
def no_cache() -> Iterator[None]:
    """What another run compiled proves nothing."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, "")
        yield


@pytest.fixture(scope="module", params=EMITTERS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def tree() -> Robot:
    robot = rttrr_pin.load(TREE)
    return robot.with_joint_effects(
        {joint: JointEffects(0.1 * k, 0.2 * k, 0.3 * k) for k, joint in enumerate(robot.joint_names, start=1)}
    )


def states(robot: Robot, rows: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Some states, quaternions made to be of length 1."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-3, 3, (rows, robot.model.nq))
    at = 0
    for joint in robot.model.moving:
        if joint.nq == joint.nv + 1:
            q[:, at + 3 : at + 7] /= np.linalg.norm(q[:, at + 3 : at + 7], axis=1, keepdims=True)
        at += joint.nq
    v, a = rng.uniform(-2, 2, (2, rows, robot.model.nv))
    return q, v, a


def program(outputs: Callable[[Graph, Sequence[int]], Sequence[int]], inputs: int = 1) -> Program:
    """A program by hand."""
    graph = Graph()
    results = tuple(outputs(graph, [graph.input(k) for k in range(inputs)]))
    return Program(graph, (Field("q", (inputs,)),), (Field("tau", (len(results),)),), results)


def ran(name: str, made: Program, q: np.ndarray) -> tuple[np.ndarray, bool]:
    """What an emitter computes for the rows of q, and whether it says that a number is not finite."""
    how = emitter(name)
    x = np.atleast_2d(q)
    out = np.full((len(x), made.outputs[0].width), 7.0)
    bad = how.load(how.emit(made), made.inputs, made.outputs).bind([x], [out])(0, len(x))
    return out, bad


# ---- the numbers


def test_the_rttrr_arm(rttrr: Robot, name: str) -> None:
    q, v, a = states(rttrr, 300)
    tau = rttrr.compile(emitter=name)(q, v, a)
    for k, state in enumerate(zip(q, v, a, strict=True)):
        assert norm_error(tau[k], recursion(rttrr, *state).tau) <= ROUNDING


def test_payloads_in_both_axes(rttrr: Robot, name: str) -> None:
    q, v, a = states(rttrr, 5)
    loads = [
        Wrench((1.0, -2.0, 3.0), (0.1, 0.2, -0.3), link="link_5"),
        Wrench((-30.0, 20.0, 1.0), (3.0, 2.0, 1.0), link="link_3", expressed_in="base"),
    ]
    tau = rttrr.compile(emitter=name)(q, v, a, payload=loads)
    assert norm_error(tau, recursion(rttrr, q, v, a, loads).tau) <= ROUNDING
    assert norm_error(tau, recursion(rttrr, q, v, a).tau) > ROUNDING


def test_a_tree_of_every_joint_type_with_followers_and_drives(tree: Robot, name: str) -> None:
    assert {joint.type.name for joint in tree.model.joints} == {
        "revolute", "continuous", "prismatic", "planar", "floating", "fixed"
    }  # fmt: skip
    assert any(joint.mimic for joint in tree.model.joints)
    q, v, a = states(tree, 100)
    v[3:6] = 0.0  # at rest there is no friction
    tau = tree.compile(emitter=name)(q, v, a)
    for k, state in enumerate(zip(q, v, a, strict=True)):
        assert norm_error(tau[k], recursion(tree, *state).tau) <= ROUNDING


def test_several_outputs(rttrr: Robot, name: str) -> None:
    q, v, _ = states(rttrr, 3)
    found = rttrr.compile(("nonlinear_effects", "mass_matrix"), emitter=name)(q, v)
    assert norm_error(found["nonlinear_effects"], rttrr.nonlinear_effects(q, v)) <= ROUNDING
    assert norm_error(found["mass_matrix"], rttrr.mass_matrix(q)) <= ROUNDING


def test_sines_and_cosines_of_hard_angles(name: str) -> None:
    """To a relative error, so that the range reduction shows."""
    made = program(lambda graph, q: [graph.function(Op.SIN, q[0]), graph.function(Op.COS, q[0])])
    found, bad = ran(name, made, ANGLES[:, None])
    assert not bad
    with mpmath.workprec(2000):
        for (s, c), q in zip(found, ANGLES, strict=True):
            assert abs(s - mpmath.sin(q)) <= ROUNDING * abs(mpmath.sin(q)), q
            assert abs(c - mpmath.cos(q)) <= ROUNDING * abs(mpmath.cos(q)), q


def test_sines_next_to_their_zeros(name: str) -> None:
    """The float64 nearest to k pi/2, where what is left is smaller than what the parts of pi/2 rounded off."""
    k = np.array([2, 4, 14479, 14848, 28958, 45678, 57916, 59024, 83442, 58285, 59023])
    made = program(lambda graph, q: [graph.function(Op.SIN, q[0]), graph.function(Op.COS, q[0])])
    found, _ = ran(name, made, (k * np.pi / 2)[:, None])
    with mpmath.workprec(300):
        for q, n, (s, c) in zip(k * np.pi / 2, k, found, strict=True):
            small, exact = (c, mpmath.cos(q)) if n % 2 else (s, mpmath.sin(q))
            assert abs(small - exact) <= ROUNDING * abs(exact), n


def test_a_robot_at_hard_angles(rttrr: Robot, name: str) -> None:
    _, v, a = states(rttrr, len(ANGLES))
    bounded = ANGLES[np.abs(ANGLES) < 1e16]  # joint 3 moves along an axis: no torque of a robot overflows there
    q = np.stack([np.roll(bounded, k) for k in range(5)], axis=1)
    tau = rttrr.compile(emitter=name)(q, v[: len(q)], a[: len(q)])
    for k, state in enumerate(zip(q, v, a, strict=False)):
        assert norm_error(tau[k], recursion(rttrr, *state).tau) <= ROUNDING


def test_programs_that_compute_little(name: str) -> None:
    """Outputs that are inputs, constants, sines, one node twice; an angle of an angle; signs; nothing at all."""

    def outputs(graph: Graph, q: Sequence[int]) -> list[int]:
        s = graph.function(Op.SIN, q[0])
        nested = graph.function(Op.COS, graph.add(s, graph.function(Op.COS, graph.mul(q[1], s))))
        sign = graph.function(Op.SIGN, q[2])
        return [q[1], graph.constant(-0.5), s, s, nested, sign, graph.neg(sign), graph.sub(graph.constant(-3.0), q[0])]

    q = np.array([[0.3, 2.0, -1.5], [1e7, 0.1, 0.0], [-2.0, 0.2, 1e-300]])
    found, bad = ran(name, program(outputs, 3), q)
    s = np.sin(q[:, 0])
    wanted = [
        q[:, 1], np.full(3, -0.5), s, s, np.cos(s + np.cos(q[:, 1] * s)), np.sign(q[:, 2]), -np.sign(q[:, 2]), -3 - q[:, 0]
    ]  # fmt: skip
    assert not bad
    assert norm_error(found, np.transpose(wanted)) <= ROUNDING
    found, bad = ran(name, program(lambda graph, q: [graph.constant(2.0), q[0]]), np.array([[5.0]]))
    assert found.tolist() == [[2.0, 5.0]] and not bad


def test_angles_of_every_kind_near_and_far(name: str) -> None:
    """An input, a sum, a constant, and one with a sine in it; needed alone, as outputs and by others."""

    def outputs(graph: Graph, q: Sequence[int]) -> list[int]:
        both = graph.add(q[0], graph.mul(q[1], graph.constant(3.0)))
        inner = graph.function(Op.COS, both)
        fixed = graph.add(graph.constant(0.7), graph.constant(0.0))
        nested = graph.function(Op.SIN, graph.mul(inner, graph.constant(5.0)))
        alone = graph.function(Op.SIN, q[1])
        return [
            inner,
            nested,
            alone,
            graph.mul(graph.function(Op.SIN, fixed), alone),
            graph.function(Op.SIN, both),
            both,
        ]

    q = np.random.default_rng(3).uniform(-3, 3, (37, 2))
    q[::5] *= 1e6
    q[3] = 3e5, 0.1
    found, bad = ran(name, program(outputs, 2), q)
    both = q[:, 0] + q[:, 1] * 3.0
    fused = np.array([float(Fraction(x) + Fraction(y) * 3) for x, y in q])
    assert not bad
    for angle in (both, fused):  # emitters differ in whether the sum is rounded once
        inner, alone = np.cos(angle), np.sin(q[:, 1])
        wanted = np.transpose([inner, np.sin(5.0 * inner), alone, np.sin(0.7) * alone, np.sin(angle), angle])
        if norm_error(found, wanted) <= ROUNDING:
            return
    raise AssertionError(found - wanted)


def test_a_robot_that_cannot_move(name: str) -> None:
    robot = rttrr_pin.load(random_tree(0, 2, types=("fixed",)))
    nothing = np.zeros((3, 0))
    assert robot.compile(emitter=name)(nothing, nothing, nothing).shape == (3, 0)


# ---- the same bits


@pytest.mark.parametrize("rows", [1, 2, 7, 63, 64, 65, 200])
def test_a_state_has_the_same_bits_in_any_block(rttrr: Robot, name: str, rows: int) -> None:
    """Alone, in a block of any length, first or last, beside angles that take the other way."""
    kernel = rttrr.compile(emitter=name)
    q, v, a = states(rttrr, 200)
    q[3::17] *= 1e6
    together = kernel(q, v, a)
    for start in range(0, 200 - rows + 1, max(1, rows // 2)):
        part = slice(start, start + rows)
        np.testing.assert_array_equal(kernel(q[part], v[part], a[part]), together[part])


def test_a_neighbour_that_is_nan_changes_nothing(name: str) -> None:
    made = program(lambda graph, q: [graph.mul(graph.function(Op.SIN, q[0]), graph.function(Op.COS, q[1]))], 2)
    q = np.random.default_rng(0).uniform(-3, 3, (100, 2))
    alone, bad = ran(name, made, q)
    assert not bad
    q[[0, 5, 64]] = np.array([[np.nan], [np.inf], [1e9]])
    beside, bad = ran(name, made, q)
    assert bad
    kept = np.delete(np.arange(100), [0, 5, 64])
    np.testing.assert_array_equal(beside[kept], alone[kept])
    assert np.isnan(beside[[0, 5]]).all() and np.isfinite(beside[64]).all()


def test_threads_change_no_bit(rttrr: Robot, name: str) -> None:
    kernel = rttrr.compile(emitter=name)
    q, v, a = states(rttrr, 2 * PART + 77)
    one = kernel(q, v, a, threads=1)
    np.testing.assert_array_equal(kernel(q, v, a, threads=3), one)
    np.testing.assert_array_equal(kernel(q[PART - 9 :], v[PART - 9 :], a[PART - 9 :], threads=2), one[PART - 9 :])


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "transposed": np.asfortranarray,
    "every second row": lambda x: np.repeat(x, 2, axis=0)[::2],
    "every third column": lambda x: np.repeat(x, 3, axis=1)[:, ::3],
    "backwards": lambda x: x[::-1, ::-1].copy()[::-1, ::-1],
    "a list": lambda x: x.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same_bits(rttrr: Robot, name: str, layout: str) -> None:
    kernel = rttrr.compile(emitter=name)
    arrays = states(rttrr, 130)
    np.testing.assert_array_equal(kernel(*(LAYOUTS[layout](x) for x in arrays)), kernel(*arrays))


def test_results_go_where_they_are_wanted(rttrr: Robot, name: str) -> None:
    """Into strided memory, and over the inputs."""
    kernel = rttrr.compile(emitter=name)
    q, v, a = states(rttrr, 70)
    wanted = kernel(q, v, a)
    wide = np.full((70, 10), 7.0)
    for out in (wide[:, ::2], np.empty((5, 70)).T):
        assert kernel(q, v, a, out=out) is out
        np.testing.assert_array_equal(out, wanted)
    assert (wide[:, 1::2] == 7.0).all()
    kernel(q, v, a, out=a)
    np.testing.assert_array_equal(a, wanted)


def test_float32_is_widened(rttrr: Robot, name: str) -> None:
    kernel = rttrr.compile(emitter=name)
    q, v, a = (x.astype(np.float32) for x in states(rttrr, 70))
    wanted = kernel(*(x.astype(float) for x in (q, v, a)))
    np.testing.assert_array_equal(kernel(q, v, a), wanted)
    np.testing.assert_array_equal(kernel(np.asfortranarray(q), v[::1], a.astype(float)), wanted)


@pytest.mark.parametrize("batch", [(0,), (2, 0), (), (1,), (2, 3)], ids=str)
def test_batches_of_any_shape(rttrr: Robot, name: str, batch: tuple[int, ...]) -> None:
    q, v, a = np.random.default_rng(1).uniform(-1, 1, (3, *batch, 5))
    tau = rttrr.compile(emitter=name)(q, v, a)
    assert tau.shape == (*batch, 5)
    assert norm_error(tau, recursion(rttrr, q, v, a).tau) <= ROUNDING


def test_leading_axes_broadcast(rttrr: Robot, name: str) -> None:
    kernel = rttrr.compile(emitter=name)
    q, v, a = states(rttrr, 70)
    np.testing.assert_array_equal(kernel(q[3], v, a[5]), kernel(np.tile(q[3], (70, 1)), v, np.tile(a[5], (70, 1))))


# ---- what is reported


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("row", [0, 63, 69])
def test_what_is_not_finite_is_reported(rttrr: Robot, name: str, bad: float, place: int, row: int) -> None:
    """Also q[0] and q[1], on which no torque of this arm depends."""
    for joint in range(5):
        arrays = states(rttrr, 70)
        arrays[place][row, joint] = bad
        with pytest.raises(NumberError) as caught:
            rttrr.compile(emitter=name)(*arrays)
        assert caught.value.joint == f"joint_{joint + 1}"
        assert caught.value.index == (row, joint)


def test_overflow_is_reported(rttrr: Robot, name: str) -> None:
    q, v, a = states(rttrr, 70)
    v[66] = 1e200
    with pytest.raises(NumberError, match="tau overflows in state 66"):
        rttrr.compile(emitter=name)(q, v, a)


def test_a_rate_that_only_friction_reads_is_looked_at(name: str, request: pytest.FixtureRequest) -> None:
    """The sign of infinity is 1, and 1 is finite."""
    made = program(lambda graph, q: [graph.function(Op.SIGN, q[0])])
    for bad in (np.nan, np.inf, -np.inf):
        found, reported = ran(name, made, np.array([[1.0], [bad]]))
        assert found[0] == 1.0
        assert found[1] == np.sign(bad) or np.isnan(found[1])
        assert reported


def test_a_robot_whose_numbers_overflow(name: str) -> None:
    """Its program has constants that are infinite: that is reported at the call, and breaks no compiler."""
    made = program(lambda graph, q: [graph.add(graph.constant(sign * math.inf), q[0]) for sign in (1, -1)])
    found, bad = ran(name, made, np.array([[1.0]]))
    assert bad and found.tolist() == [[math.inf, -math.inf]]


# ---- C for others


def in_c(text: str, main: str, folder: Path) -> str:
    """What a C program prints; the text must pass as strict C99."""
    path = folder / "main.c"
    path.write_text(f"{text}\n#include <stdio.h>\nint main(void) {{ {main} return 0; }}\n")
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror", "-O1"]
    subprocess.run([*c.compiler(), *strict, "-o", str(folder / "main"), str(path), "-lm"], check=True)
    return subprocess.run([str(folder / "main")], check=True, capture_output=True, text=True).stdout


def test_the_source_is_a_program_of_its_own(rttrr: Robot, tmp_path: Path) -> None:
    q, v, a = states(rttrr, 1)
    given = ", ".join(
        f"{name}[5] = {{{', '.join(map(repr, x[0].tolist()))}}}" for name, x in zip("qva", (q, v, a), strict=True)
    )
    text = rttrr.compile().source()
    printed = in_c(
        text, f'double {given}; rttrr_tau(q, v, a, a); for (int i = 0; i < 5; ++i) printf("%.17g ", a[i]);', tmp_path
    )
    np.testing.assert_array_equal(np.array(printed.split(), dtype=float), rttrr.compile(emitter="c")(q, v, a)[0])
    head = text[: text.index("*/")]
    for said in (
        "void rttrr_tau(const double *q, const double *v, const double *a, double *tau);",
        "q[5] [rad or m]: joint_1, ",
    ):
        assert said in head
    assert f"{rttrr.compile().program.operations}." in head
    assert max(map(len, head.splitlines())) <= 120


def test_source_of_several_outputs(tree: Robot, tmp_path: Path) -> None:
    text = tree.compile(("F", "n", "mass_matrix")).source("c")
    nv, links = tree.model.nv, len(tree.model.links)
    assert "double *F, double *n, double *mass_matrix) {\n" in text
    assert f"mass_matrix[{nv * nv}] [kg m^2, kg m or kg], {nv} x {nv} row by row" in text
    assert f"F[{3 * links}] [N], {links} x 3 row by row" in text
    in_c(text, "", tmp_path)


def test_names_that_c_would_not_take(tmp_path: Path) -> None:
    """A robot's name cannot leave the comment or the identifier."""
    nasty = "9 */ int x; /*\\\n\u00e9"
    robot = rttrr_pin.load(random_tree(1, 2, types=("revolute",), mimics=False))
    made = robot.compile().program
    text = c.emitter().source(made, nasty, {"q": [nasty, "??/"]})
    assert "void robot_9____int_x________tau(" in text
    assert text.count("*/") == 1 and text.isascii()
    in_c(text, "", tmp_path)


def test_numbers_are_written_to_the_last_bit() -> None:
    for x in (0.1, 1e-300, 5e-324, 1.7976931348623157e308, -2.0, 1 / 3):
        assert float(c.number(x)) == x
    assert [c.number(x) for x in (math.inf, -math.inf, math.nan)] == ["INFINITY", "-INFINITY", "NAN"]


@pytest.mark.parametrize("other", [name for name in EMITTERS if name != "c"])
def test_only_c_is_source_for_readers(rttrr: Robot, other: str) -> None:
    with pytest.raises(InputError, match="take emitter='c' or 'cuda'"):
        rttrr.compile().source(other)


def test_emitters_have_names(rttrr: Robot) -> None:
    assert all(emitter(name).name == name for name in EMITTERS)
    with pytest.raises(UnknownNameError, match="no emitter is called 'fortran'"):
        rttrr.compile().source("fortran")


def test_without_a_c_compiler_the_source_is_there_all_the_same(
    rttrr: Robot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    robot = rttrr.with_joint_effects({})
    assert "#include <math.h>" in robot.compile(emitter="c").source()
    with pytest.raises(InputError, match="install gcc, or take another emitter"):
        robot.compile(emitter="c")(*states(robot, 1))


def test_a_c_compiler_that_fails_is_named(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "cc -no-such-option")
    with pytest.raises(InputError, match=r"cc -no-such-option .* failed: .*set CC to another"):
        rttrr.with_joint_effects({}).compile(emitter="c")(*states(rttrr, 1))


@pytest.mark.parametrize("name", ["c", "numpy"])
def test_what_is_kept_on_disk_is_text_without_addresses(rttrr: Robot, name: str) -> None:
    how, made = emitter(name), rttrr.compile().program
    assert how.emit(made) == how.emit(made)
    assert how.emit(made).decode().isascii()
