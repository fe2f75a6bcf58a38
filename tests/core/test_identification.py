"""Base parameters: their number and map exactly on RTTRR, against the regressor's rank and published counts elsewhere."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot
from rttrr_pin.compile.quantities import QUANTITIES, Motion
from rttrr_pin.core.dual import Dual
from rttrr_pin.core.identification import base_parameters, parameter_names
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.errors import InputError, ShapeError
from rttrr_pin.validation import Sampler
from support.robots import BUNDLED, driven
from support.tolerances import CONSUMER, ROUNDING, norm_error
from support.trees import random_tree

TREES = {f"tree_{seed}": random_tree(seed, 5, ("revolute", "continuous", "prismatic", "fixed")) for seed in range(5)}
TREES |= {f"any_{seed}": random_tree(seed, 4) for seed in range(3)}


class Rational:
    """A rational number; a double beside it, such as 0.0, is the number that it is."""

    def __init__(self, x: Any) -> None:
        self.x = x.x if isinstance(x, Rational) else Fraction(x)

    def __add__(self, other: Any) -> Any:
        return NotImplemented if isinstance(other, Dual) else Rational(self.x + Rational(other).x)

    def __mul__(self, other: Any) -> Any:
        return NotImplemented if isinstance(other, Dual) else Rational(self.x * Rational(other).x)

    def __neg__(self) -> Rational:
        return Rational(-self.x)

    def __sub__(self, other: Any) -> Any:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Any:
        return (-self).__add__(other)

    __radd__, __rmul__ = __add__, __mul__


def half_angle(angle: Any) -> tuple[Rational, Rational]:
    """The sine and cosine of an angle whose half has the tangent t: rational where t is."""
    t = Rational(angle).x
    return Rational(2 * t / (1 + t * t)), Rational((1 - t * t) / (1 + t * t))


RATIONAL = Arithmetic(
    number=lambda value, error: Rational(value), column=Rational, sincos=half_angle, sign=lambda x: Rational(1)
)
"""Rational numbers; an angle is given by the tangent of its half. RTTRR's rotations and axes are exact in them."""


def exact_rows(robot: Robot, states: int) -> list[list[Fraction]]:
    """The regressor at rational states, no digit lost."""
    rng = np.random.default_rng(1)
    model, rows = robot.model, []
    for _ in range(states):
        q, v, a = ([Rational(Fraction(int(x), 16)) for x in rng.integers(-40, 40, model.nv)] for _ in range(3))
        numbers = QUANTITIES["regressor"].scalars(Motion(model, RATIONAL, q, v, a))
        width = len(numbers) // model.nv
        rows += [[Rational(x).x for x in numbers[k : k + width]] for k in range(0, len(numbers), width)]
    return rows


def reduced(rows: list[list[Fraction]]) -> tuple[list[int], list[list[Fraction]]]:
    """Gauss-Jordan: the columns that do not depend on those before, and the rows by which they make all."""
    pivots: list[int] = []
    for column in range(len(rows[0])):
        at = len(pivots)
        k = next((k for k in range(at, len(rows)) if rows[k][column]), None)
        if k is None:
            continue
        rows[at], rows[k] = rows[k], rows[at]
        rows[at] = [x / rows[at][column] for x in rows[at]]
        for other in range(len(rows)):
            if other != at and (factor := rows[other][column]):
                rows[other] = [x - factor * y for x, y in zip(rows[other], rows[at], strict=True)]
        pivots.append(column)
    return pivots, rows[: len(pivots)]


@pytest.mark.one_in(2)
@pytest.mark.parametrize("name", ["rttrr", "trr"])
def test_basis_and_map_are_the_exact_ones(name: str) -> None:
    robot = rttrr_pin.load(name)
    pivots, rows = reduced(exact_rows(robot, 2 * 10 * len(robot.link_names) // robot.model.nv))
    base = robot.base_parameters()
    assert base.independent == tuple(pivots)
    exact = np.array([[float(x) for x in row] for row in rows])
    np.testing.assert_allclose(base.map, exact, rtol=0.0, atol=CONSUMER)
    np.testing.assert_array_equal(base.map == 0.0, exact == 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("effects", [False, True])
@pytest.mark.parametrize("name", [*BUNDLED, *TREES])
def test_they_are_as_many_as_the_regressors_rank_and_give_the_same_forces(name: str, effects: bool) -> None:
    robot = driven(rttrr_pin.load(TREES.get(name, name)))
    base = robot.base_parameters(effects)
    count = 3 * len(base.names) // max(robot.model.nv, 1) + 1
    drawn = Sampler(robot.model, "mixed", 7).draw(0, count)
    Y = robot.regressor(drawn.q, drawn.v, drawn.a, effects)
    norms = np.linalg.norm(Y.reshape(-1, len(base.names)), axis=0)
    kept = base.regressor(Y).reshape(-1, base.rank)
    assert np.linalg.matrix_rank(kept / norms[list(base.independent)], tol=CONSUMER) == base.rank
    assert base.farthest_dependent < base.tolerance < base.nearest_independent
    pi = robot.inertial_parameters(effects)
    result = robot.inverse_dynamics(drawn.q, drawn.v, drawn.a)
    tau = result.tau if effects else result.tau - result.tau_joint
    size = np.abs(base.regressor(Y)) @ np.abs(base.of(pi)) + np.abs(Y) @ np.abs(pi)
    assert np.linalg.norm(base.regressor(Y) @ base.of(pi) - tau) <= CONSUMER * np.linalg.norm(size)


def test_a_six_axis_arm_has_the_published_number() -> None:
    """Gautier and Khalil count 36 for the PUMA 560's geometry: axes that meet or are parallel, an offset wrist."""
    turns = ("0 0 0", "-1.5707963267948966 0 0", "0 0 0", "-1.5707963267948966 0 0", "1.5707963267948966 0 0",
             "-1.5707963267948966 0 0")  # fmt: skip
    places = ("0 0 0", "0 0.2 0", "0.43 0 -0.09", "0.02 0.43 0", "0 0 0", "0 0 0")
    links = "".join(f'<link name="link_{k}"/>' for k in range(7))
    joints = "".join(
        f'<joint name="joint_{k}" type="continuous"><parent link="link_{k - 1}"/><child link="link_{k}"/>'
        f'<origin xyz="{place}" rpy="{turn}"/><axis xyz="0 0 1"/></joint>'
        for k, (place, turn) in enumerate(zip(places, turns, strict=True), 1)
    )
    robot = rttrr_pin.load(f'<robot name="puma">{links}{joints}</robot>')
    assert robot.base_parameters().rank == 36
    # Armature of the first joint is no other than inertia about its axis; those of others are new, as friction is.
    effects = robot.base_parameters(joint_effects=True)
    assert effects.rank - 36 in (12 + 4, 12 + 5)


def test_one_pendulum_by_hand() -> None:
    """About y under gravity along z: m c_x, m c_z and I_yy; armature is I_yy again."""
    robot = rttrr_pin.load(
        '<robot name="pendulum"><link name="base"/><link name="bob"/><joint name="pivot" type="continuous">'
        '<parent link="base"/><child link="bob"/><axis xyz="0 1 0"/></joint></robot>'
    )
    base = robot.base_parameters(joint_effects=True)
    assert base.expressions == (
        "m c_x of bob", "m c_z of bob", "I_yy of bob + armature of pivot", "damping of pivot", "friction of pivot"
    )  # fmt: skip
    assert base.summary().startswith("5 base parameters of 13; ")
    assert base.to_dict()["independent"] == [1, 3, 6, 11, 12]


def test_columns_that_motion_never_reaches_are_zero_in_the_map() -> None:
    robot = rttrr_pin.load(TREES["tree_1"])
    base = robot.base_parameters()
    drawn = Sampler(robot.model, "mixed", 1).draw(0, 9)
    Y = robot.regressor(drawn.q, drawn.v, drawn.a)
    still = ~Y.any(axis=(0, 1))
    assert not base.map[:, still].any()


def test_the_condition_number_tells_a_poor_trajectory(rttrr: Robot) -> None:
    base = rttrr.base_parameters()
    drawn = Sampler(rttrr.model, "mixed", 0).draw(0, 200)
    Y = rttrr.regressor(drawn.q, drawn.v, drawn.a)
    W = base.regressor(Y).reshape(-1, base.rank)
    assert base.condition(Y) == pytest.approx(np.linalg.cond(W))
    assert 1.0 <= base.condition(Y, scaled=True) < base.condition(Y) < CONSUMER**-1
    at_rest = rttrr.regressor(drawn.q, np.zeros((200, 5)), np.zeros((200, 5)))
    assert base.condition(at_rest) == np.inf
    assert base.condition(Y[:1]) == np.inf


def test_what_a_trajectory_hardly_tells_is_said_in_words(rttrr: Robot) -> None:
    """Joints that move alike but for a ten-thousandth, and one that stands still."""
    base = rttrr.base_parameters(joint_effects=True)
    q, v, a = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 300, 5))
    assert base.advice(rttrr.regressor(q, v, a, joint_effects=True)) == ()
    v[:, 2] = a[:, 2] * (1 + 1e-4 * q[:, 2])  # its rate is nearly its acceleration
    (one,) = base.advice(rttrr.regressor(q, v, a, joint_effects=True))
    assert "armature of joint_3 and damping of joint_3" in one or "damping of joint_3 and armature of joint_3" in one
    v[:, 2] = a[:, 2] = 0.0
    told = base.advice(rttrr.regressor(q, v, a, joint_effects=True))
    assert any(line.startswith("damping of joint_3 does not show: let joint_3 run") for line in told)
    assert "add states" in base.advice(rttrr.regressor(q[:1], v[:1], a[:1], joint_effects=True))[-1]


def test_a_rank_in_doubt_names_the_parameters_that_decide_it() -> None:
    Y = np.zeros((4, 1, 3))
    Y[:, 0] = [[1, 0, 1], [0, 1, 1], [0, 0, 3e-9], [0, 0, 0]]
    names = ("m of a", "m of b", "m of c")
    kept, dropped = base_parameters(names, Y, 1e-9), base_parameters(names, Y, 1e-8)
    assert (kept.rank, dropped.rank) == (3, 2)
    assert "m of c is nearly dependent" in kept.summary() and "above that" in kept.summary()
    assert "m of c is dependent" in dropped.summary() and "below that" in dropped.summary()
    assert "dependent on those" not in base_parameters(names, Y, 1e-15).summary()


@pytest.mark.slow
def test_columns_of_armature_and_friction_are_what_the_joints_take() -> None:
    """Of followers too, by virtual work."""
    for text in TREES.values():
        robot = driven(rttrr_pin.load(text))
        drawn = Sampler(robot.model, "mixed", 2).draw(0, 9)
        states = drawn.q, drawn.v, drawn.a
        width = 10 * len(robot.link_names)
        own = robot.regressor(*states, joint_effects=True)[..., width:] @ robot.inertial_parameters(True)[width:]
        assert norm_error(own, robot.inverse_dynamics(*states).tau_joint) <= ROUNDING
        np.testing.assert_array_equal(
            robot.regressor(*states, joint_effects=True)[..., :width], robot.regressor(*states)
        )
        assert len(parameter_names(robot.model, True)) == len(robot.inertial_parameters(True))


def test_a_robot_without_joints_has_none() -> None:
    base = rttrr_pin.load(random_tree(1, 2, ("fixed",))).base_parameters(joint_effects=True)
    assert (base.rank, base.expressions) == (0, ())


def test_what_it_refuses(rttrr: Robot) -> None:
    with pytest.raises(InputError, match="tolerance is 0"):
        rttrr.base_parameters(tolerance=0.0)
    base = rttrr.base_parameters()
    wrong: Any = rttrr.inertial_parameters(joint_effects=True)
    with pytest.raises(ShapeError, match="pass joint_effects"):
        base.of(wrong)
    with pytest.raises(InputError, match="tolerance"):
        rttrr.base_parameters(tolerance=np.nan)


def test_effects_do_not_move_the_inertial_basis(rttrr: Robot) -> None:
    driven_too = rttrr.with_joint_effects({"joint_1": JointEffects(2.0, 1.0, 0.5)})
    assert driven_too.base_parameters().independent == rttrr.base_parameters().independent


@cache
def independent(name: str) -> tuple[int, ...]:
    """Parameters of the base of the robot, and of its joints."""
    return rttrr_pin.load(TREES.get(name, name)).base_parameters(joint_effects=True).independent


@pytest.mark.one_in(9)
@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1e6, 1e30])
@pytest.mark.parametrize("name", ["rttrr", "tree_2"])
def test_a_robot_of_any_size_has_the_same_basis(name: str, scale: float) -> None:
    model = rttrr_pin.load(TREES.get(name, name)).model
    joints = tuple(replace(joint, p=joint.p * scale) for joint in model.joints)
    base = Robot(replace(model, joints=joints, document=None)).base_parameters(joint_effects=True)
    assert base.independent == independent(name)
    assert base.farthest_dependent < base.tolerance**1.2
    assert base.nearest_independent > base.tolerance**0.5
