"""The running error bound holds, and is not vacuous."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.core.arrays import norm
from rttrr_pin.core.dynamics import bodies, dynamics
from rttrr_pin.core.scalars import UNIT_ROUNDOFF, columns
from rttrr_pin.exact import BOUNDED, Bounded, bounded_dynamics, enclose
from rttrr_pin.exact.rounding import coordinate_scalars
from rttrr_pin.validation import SAMPLINGS, Sampler
from support.high_precision import exact_dynamics, mp_arithmetic, mp_rotation
from support.implementations import evaluated
from support.recursion import recursion
from support.serial_chains import random_chain
from support.tolerances import ROUNDING
from support.trees import random_tree


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_no_true_error_exceeds_its_bound_in_trees(seed: int, base: Any) -> None:
    """Every joint type, followers and friction."""
    robot = rttrr_pin.load(random_tree(seed, 9), base=base, friction=True)
    check_bounds(robot, "mixed", seed)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_no_true_error_exceeds_its_bound(robot: Robot, sampling: str, seed: int) -> None:
    check_bounds(robot, sampling, seed)


def check_bounds(robot: Robot, sampling: str, seed: int) -> None:
    """Against 60 digits on the same doubles, component by component."""
    states = Sampler(robot.model, sampling, seed, RandomPayload(robot.link_names[-1])).draw(0, 12)
    values, bounds = bounded_dynamics(robot.model, states.q, states.v, states.a, states.loads)
    with mpmath.workdps(60):
        for k in range(12):
            part = slice(k, k + 1)
            loads = [load.block(part) for load in states.loads]
            exact = exact_dynamics(robot.model, states.q[part], states.v[part], states.a[part], loads)
            for key, truth in exact.items():
                error = np.abs(getattr(values, key)[k] - truth)
                assert (error <= getattr(bounds, key)[k]).all(), (key, k)


def test_one_state_is_computed_with_plain_floats() -> None:
    """NumPy's own floats give the same bits and take several times as long."""
    model = rttrr_pin.load(random_tree(3, 9), base="floating", friction=True).model
    state = Sampler(model, "mixed", 0).draw(0, 1)
    q = coordinate_scalars(model, state.q)
    v, a = ([Bounded(x, 0.0) for x in columns(y)] for y in (state.v, state.a))
    for x in dynamics(model, BOUNDED, q, v, a).scalars():
        assert {type(x.value), type(x.bound)} == {float} if isinstance(x, Bounded) else x == 0


@pytest.mark.parametrize("seed", [0, 1])
def test_values_are_the_bits_of_the_recursion(robot: Robot, seed: int) -> None:
    states = Sampler(robot.model, "mixed", seed).draw(0, 40)
    values, _ = bounded_dynamics(robot.model, states.q, states.v, states.a)
    plain = recursion(robot, states.q, states.v, states.a)
    for key, x in values.items():
        np.testing.assert_array_equal(x, getattr(plain, key))


def test_bounds_are_of_the_size_of_rounding(rttrr: Robot) -> None:
    """A bound that allowed a wrong third digit would be no gate."""
    states = Sampler(rttrr.model, "uniform", 0).draw(0, 500)
    values, bounds = bounded_dynamics(rttrr.model, states.q, states.v, states.a)
    for key, x in values.items():
        x_, b = x.reshape(500, -1), getattr(bounds, key).reshape(500, -1)
        assert (np.linalg.norm(b, axis=1) <= ROUNDING * np.linalg.norm(x_, axis=1)).all(), key
        assert b.max() > 0.0


RPY = [
    "0 0 0.3",
    "0.1 0.2 0.3",
    "1.5707963 0 0",
    "0.7 1.57079632 0.7",
    "3.14159265358979 1.5707963267949 0",
    "-2.9 3.1 -0.001",
    "1e-9 0 3",
]


@pytest.mark.parametrize("rpy", RPY)
def test_numbers_computed_from_the_file_lie_within_their_bounds(rpy: str) -> None:
    """Rotation matrices, turned tensors and axes against 60 digits; also entries that round to exactly zero."""
    tensor = [[0.3, 0.01, -0.02], [0.01, 0.2, 0.03], [-0.02, 0.03, 0.25]]
    names = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    entries = " ".join(f'{name}="{tensor[i][j]}"' for name, (i, j) in names.items())
    text = (
        f'<robot name="x"><link name="a"/><link name="b"><inertial><origin rpy="{rpy}"/><mass value="1"/><inertia {entries}/></inertial>'
        f'</link><joint name="j" type="prismatic"><parent link="a"/><child link="b"/><origin rpy="{rpy}"/><axis xyz="1 -2 0.3"/></joint></robot>'
    )
    body = bodies(rttrr_pin.load(text).model, BOUNDED)[0]
    with mpmath.workdps(60):
        R = mp_rotation(rpy.split())
        turned = R * mpmath.matrix([[mpmath.mpf(float(x)) for x in row] for row in tensor]) * R.T
        length = mpmath.sqrt(1 + 4 + mpmath.mpf(0.3) ** 2)
        pairs = [(s, R[i, j]) for i, row in enumerate(body.R.rows) for j, s in enumerate(row)]
        pairs += [(s, turned[i, j]) for i, row in enumerate(body.I.rows) for j, s in enumerate(row)]
        pairs += [(s, mpmath.mpf(x) / length) for s, x in zip(body.axis, (1, -2, 0.3), strict=True)]
        for scalar, truth in pairs:
            value, bound = (scalar.value, scalar.bound) if isinstance(scalar, Bounded) else (scalar, 0.0)
            assert abs(value - truth) <= bound


def test_a_zero_that_was_rounded_is_not_exact() -> None:
    """R[0, 1] of this rpy rounds to 0, and is not."""
    text = (
        '<robot name="x"><link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        '</inertial></link><joint name="j" type="prismatic"><parent link="a"/><child link="b"/><origin rpy="0.7 1.57079632 0.7"/>'
        '<axis xyz="0 1 0"/></joint></robot>'
    )
    robot = rttrr_pin.load(text, gravity=(-9.81, 0, 0))
    zero = np.zeros((1, 1))
    values, bounds = bounded_dynamics(robot.model, zero, zero, zero)
    with mpmath.workdps(60):
        truth = 9.81 * mp_rotation(["0.7", "1.57079632", "0.7"])[0, 1]
        assert abs(values.tau[0, 0] - truth) <= bounds.tau[0, 0]
    assert bounds.tau[0, 0] > 0.0


def test_a_chain_of_followers_is_rounded_once_and_bounded() -> None:
    """0.1 times 0.7 is not 0.07 in binary."""
    head, joint_2, joint_3 = (
        random_chain(9, ("revolute",) * 3)
        .replace("</joint>", '<mimic joint="joint_2" multiplier="0.1"/></joint>', 1)
        .rsplit("</joint>", 2)
    )
    robot = rttrr_pin.load(
        f'{head}<mimic joint="joint_3" multiplier="0.7" offset="0.3"/></joint>{joint_2}</joint>{joint_3}'
    )
    mimic = robot.model.joints[0].mimic
    assert mimic is not None
    assert mimic.rounded
    for rounded, exact in (
        (mimic.multiplier, Fraction(0.1) * Fraction(0.7)),
        (mimic.offset, Fraction(0.1) * Fraction(0.3)),
    ):
        assert abs(Fraction(rounded) - exact) <= Fraction(UNIT_ROUNDOFF) * abs(exact)


def _readable(robot: Robot, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    values, bounds = bounded_dynamics(robot.model, q, v, a)
    return values.tau, bounds.tau


def _compiled(robot: Robot, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    result = robot.compile(("tau", "tau_bound"))(q, v, a)
    return result["tau"], result["tau_bound"]


@pytest.mark.parametrize("by", [_readable, _compiled])
def test_a_quaternion_that_is_not_quite_of_unit_length_is_within_the_bound(by) -> None:
    """What is bounded is the distance from the motion of the unit quaternion; inputs may be off by 5e-13."""
    robot = rttrr_pin.load("rttrr", base="floating")
    states = Sampler(robot.model, seed=3).draw(0, 4)
    q = states.q.copy()
    q[:, 3:7] *= 1 + 4e-13
    values, bounds = by(robot, q, states.v, states.a)
    with mpmath.workdps(60):
        for k in range(4):
            unit = [mpmath.mpf(float(x)) for x in q[k]]
            length = mpmath.sqrt(sum(x * x for x in unit[3:7]))
            unit[3:7] = [x / length for x in unit[3:7]]
            v, a = ([mpmath.mpf(float(x)) for x in y[k]] for y in (states.v, states.a))
            truth = dynamics(robot.model, mp_arithmetic(), unit, v, a).tau
            error = np.abs(values[k] - np.array(truth, dtype=object))
            assert (error <= bounds[k]).all()
            assert error.max() > ROUNDING  # which the rounding of exact coordinates would not explain


@pytest.mark.parametrize("power", [-300, -200, -160])
def test_what_underflows_is_within_its_bound(rttrr: Robot, power: int) -> None:
    """Rates whose products are below all of float64, on the recursion, the kernel and Lagrange's equations."""
    states = Sampler(rttrr.model).draw(0, 8)
    model = rttrr.model.with_gravity(np.zeros(3))
    q, v, a = states.q, states.v * 10.0**power, states.a * 10.0 ** (2 * power)
    enclosures = enclose(model, q, v, a)
    for name in ("recursion", "kernel", "lagrange"):
        got = evaluated(name, model, q, v, a)
        assert got.allowance is not None
        for key, x in got.values.items():
            true = getattr(enclosures, key)
            off = np.maximum(true.lower - x, x - true.upper).clip(0.0)
            assert ((off if key == "tau" else norm(off)) <= got.allowance[key]).all(), (name, key)
