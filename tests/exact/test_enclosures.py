"""Every enclosure holds the true value, is as narrow as doubles allow, and is of the parameters that it names."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.core.arrays import norm
from rttrr_pin.core.dynamics import evaluate
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.errors import InputError, NumberError, ShapeError
from rttrr_pin.exact import Enclosures, bounded_dynamics, enclose
from rttrr_pin.exact.enclosures import PRECISIONS, enclosing_doubles
from rttrr_pin.exact.intervals import interval, precision
from rttrr_pin.exact.parameters import exact_parameters
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.high_precision import exact_dynamics, mp_rotation
from support.serial_chains import EXAMPLES, random_chain
from support.tolerances import SIXTY_DIGITS
from support.trees import MUTATED, random_tree

ROWS = (4, RECORDED := 32)
"""States for which the recursion runs on balls as it stands, and for which its operations are recorded first."""


@pytest.fixture(autouse=True, scope="module")
def recorded_from_few() -> Iterator[None]:
    """So many states are enough here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rttrr_pin.exact.enclosures.STRAIGHT_LINE_FROM", RECORDED)
        yield


def certified(robot: Robot, states: Batch, parameters: Any = "doubles") -> Enclosures:
    return enclose(robot.model, states.q, states.v, states.a, states.loads, parameters)


def steps(lower: float, upper: float) -> int:
    """How many doubles lie between, the upper end counted; 3 stands for more."""
    count = 0
    while lower < upper and count < 3:
        lower, count = math.nextafter(lower, math.inf), count + 1
    return count


def check_narrow(enclosures: Enclosures) -> None:
    """One double, neighbours, or next to nothing against the vector or the largest of the quantity."""
    assert enclosures.tight.all()
    for key, ends in enclosures.items():
        size = np.maximum(abs(ends.lower), abs(ends.upper))
        vector = size if key == "tau" else np.linalg.norm(size, axis=-1, keepdims=True)
        largest = np.maximum(size.max(axis=tuple(range(1, size.ndim)), keepdims=True, initial=0.0), 1.0)
        near = np.nextafter(np.nextafter(ends.lower, np.inf), np.inf) >= ends.upper
        assert (near | (ends.upper - ends.lower <= np.maximum(2.0**-80 * vector, 2.0**-200 * largest))).all(), key


def check_against_60_digits(robot: Robot, sampling: str, seed: int, rows: int) -> None:
    states = Sampler(robot.model, sampling, seed, RandomPayload(robot.link_names[-1])).draw(0, rows)
    enclosures = certified(robot, states)
    check_narrow(enclosures)
    with mpmath.workdps(60):
        for k in range(min(rows, 6)):
            one = slice(k, k + 1)
            loads = [load.block(one) for load in states.loads]
            exact = exact_dynamics(robot.model, states.q[one], states.v[one], states.a[one], loads)
            for key, truth in exact.items():
                ends = getattr(enclosures, key)
                slack = SIXTY_DIGITS * max((abs(x) for x in truth.flat), default=0)
                assert (ends.lower[k] - slack <= truth).all() and (truth <= ends.upper[k] + slack).all(), (key, k)


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("sampling", ["mixed", "large-velocities"])
def test_enclosures_hold_what_60_digits_yield(robot: Robot, sampling: str, rows: int) -> None:
    check_against_60_digits(robot, sampling, 1, rows)


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_enclosures_hold_what_60_digits_yield_in_trees(seed: int, base: Any, rows: int) -> None:
    """Every joint type, followers, friction, quaternions."""
    check_against_60_digits(rttrr_pin.load(random_tree(seed, 9), base=base, friction=True), "mixed", seed, rows)


@pytest.mark.parametrize("name", ["rttrr", "any-axes"])
def test_an_enclosure_is_one_double_or_two_neighbours(name: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(name, name))
    enclosures = certified(robot, Sampler(robot.model).draw(0, 40))
    for _, ends in enclosures.items():
        assert (ends.lower <= ends.upper).all()
        assert (np.nextafter(ends.lower, np.inf) >= ends.upper).all()
        assert (ends.lower <= ends.mid).all() and (ends.mid <= ends.upper).all()


def test_recorded_or_not_the_enclosures_are_the_same(rttrr: Robot) -> None:
    states = Sampler(rttrr.model, payload=RandomPayload("tool")).draw(0, RECORDED)
    many = certified(rttrr, states)
    for k in range(RECORDED):
        one = slice(k, k + 1)
        loads = [load.block(one) for load in states.loads]
        few = enclose(rttrr.model, states.q[one], states.v[one], states.a[one], loads)
        for key, ends in few.items():
            np.testing.assert_array_equal(ends.lower, getattr(many, key).lower[one])
            np.testing.assert_array_equal(ends.upper, getattr(many, key).upper[one])


def rational(value: float, error: float = 0.0) -> Fraction:
    return Fraction(value)


def no_angle(q: Fraction) -> tuple[int, int]:
    assert q == 0
    return 0, 1


RATIONAL = Arithmetic(rational, rational, no_angle, sign=lambda x: Fraction((x > 0) - (x < 0)))
"""Exact wherever every angle is zero."""


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("name", ["rttrr", "any-axes", "tree"])
def test_rounding_is_outwards_and_least(name: str, rows: int) -> None:
    """At angles zero the recursion is rational: Fractions say whether a double is below, above, or the value itself."""
    robot = rttrr_pin.load(random_tree(4, 8, mimics=False) if name == "tree" else EXAMPLES.get(name, name))
    rng = np.random.default_rng(7)
    q = rng.normal(size=(rows, robot.model.nq))
    column = 0
    for joint in robot.model.moving:
        angular = {1: [0] if joint.type.rotates else [], 3: [2], 7: []}[joint.nq]
        q[:, [column + k for k in angular]] = 0.0
        if joint.nq == 7:
            q[:, column + 3 : column + 7] = (0.0, 0.6, 0.0, 0.8)  # not quite of length 1 in doubles: taken as it is
        column += joint.nq
    v, a = rng.normal(size=(2, rows, robot.model.nv)).round(1)
    enclosures = enclose(robot.model, q, v, a)
    for k in range(min(rows, 4)):
        result = evaluate(robot.model, RATIONAL, q[k : k + 1], v[k : k + 1], a[k : k + 1])
        exact = {"tau": result.tau} | {
            key: [x for vector in getattr(result, key) for x in vector] for key in LINK_QUANTITIES
        }
        for key, truths in exact.items():
            ends = getattr(enclosures, key)
            for low, high, truth in zip(ends.lower[k].flat, ends.upper[k].flat, truths, strict=True):
                assert Fraction(low) <= truth <= Fraction(high), key
                assert steps(low, high) <= (2 if Fraction(float(truth)) == truth else 1), key


@given(
    value=st.fractions() | st.floats(allow_nan=False, allow_infinity=False).map(Fraction),
    bits=st.integers(2, 200),
    width=st.sampled_from([Fraction(0), Fraction(1, 2**60), Fraction(1, 3), Fraction(10**9)]),
)
def test_a_ball_is_rounded_outwards(value: Fraction, bits: int, width: Fraction) -> None:
    """Also wide balls, and numbers that are not normal."""
    if abs(value) + width >= Fraction(1e308):
        return
    with precision(bits):
        x = interval(value) + arb(0, float(width))
        low, high = enclosing_doubles(x)
    assert Fraction(low) <= value <= Fraction(high)
    assert x >= low and x <= high  # of all that the ball holds


@pytest.mark.parametrize("value", [0.0, 1.0, -1.0, 5e-324, 1.7e308, -2.5])
def test_a_double_is_its_own_enclosure(value: float) -> None:
    assert enclosing_doubles(arb(value)) == (value, value)


def test_precision_rises_where_terms_cancel() -> None:
    """1e36 N in link axes against 1e36 N in base axes, over two joints that turn back: the sum is the weight."""
    robot = rttrr_pin.load(
        '<robot name="x"><link name="o"/><link name="a"/><link name="b"><inertial><mass value="2"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
        '<joint name="i" type="revolute"><parent link="o"/><child link="a"/><axis xyz="0 1 0"/></joint>'
        '<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 -1 0"/></joint></robot>'
    )
    huge = 1e36
    loads = [Wrench((0, 0, huge), link="b"), Wrench((0, 0, -huge), link="b", expressed_in="base")]
    easy = robot.enclose((0.7, 0.7), (0, 0), (0, 0))
    hard = robot.enclose((0.7, 0.7), (0, 0), (0, 0), loads)
    assert int(easy.bits) == PRECISIONS[0] < int(hard.bits)
    assert hard.tight
    weight = Fraction(9.81) * 2
    low, high = hard.f.lower[1, 2], hard.f.upper[1, 2]
    assert Fraction(low) <= weight <= Fraction(high) and steps(low, high) <= 2


def test_what_is_zero_by_rotations_is_narrow_too() -> None:
    """Some components vanish by sines and cosines of rpy, which balls cannot prove: more bits make them small enough."""
    robot = rttrr_pin.load(random_tree(0, 9), friction=True)
    enclosures = certified(robot, Sampler(robot.model, "mixed", 0).draw(0, 60), "read")
    check_narrow(enclosures)
    assert PRECISIONS[0] in enclosures.bits and enclosures.bits.max() > PRECISIONS[0]


def test_a_state_of_low_precision_does_not_hold_back_the_others(rttrr: Robot) -> None:
    """In one batch each state has the bits that it needs."""
    wrench = Wrench(np.array([[0.0, 0, 0], [1e60, 0, 0]]), expressed_in="base")
    back = Wrench(np.array([[0.0, 0, 0], [-1e60, 0, 0]]), expressed_in="base")
    enclosures = rttrr.enclose(np.ones((2, 5)), np.ones((2, 5)), np.ones((2, 5)), [wrench, back])
    assert enclosures.bits[0] == PRECISIONS[0] < enclosures.bits[1]
    np.testing.assert_array_equal(enclosures.tau.lower[0], enclosures.tau.lower[1])


# The numbers

PENDULUM = (
    '<robot name="pendulum"><link name="o"/><link name="a"><inertial><origin xyz="0.3 0 0"/><mass value="0.1"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.7" iyz="0" izz="0.7"/></inertial></link>'
    '<joint name="j" type="revolute"><parent link="o"/><child link="a"/><axis xyz="{axis}"/></joint></robot>'
)


@pytest.mark.parametrize("parameters", ["doubles", "read", "text"])
@pytest.mark.parametrize("rows", ROWS)
def test_a_pendulum_by_hand(parameters: Any, rows: int) -> None:
    """tau = (I + m r^2) a - m r g at q = 0. Both terms are nearly equal: what is left is what decimals were rounded by."""
    robot = rttrr_pin.load(PENDULUM.format(axis="0 1 0"))
    truths = {}
    acceleration = 0.0
    for kind, value in (("text", Fraction), ("doubles", lambda x: Fraction(float(x)))):
        r, m, I = (value(x) for x in ("0.3", "0.1", "0.7"))
        moment, weight = I + m * r * r, m * r * Fraction(9.81)
        acceleration = acceleration or float(weight / moment)
        truths[kind] = moment * Fraction(acceleration) - weight
    enclosures = robot.enclose(np.zeros((rows, 1)), np.zeros(1), [acceleration], parameters=parameters)
    low, high = enclosures.tau.lower[-1, 0], enclosures.tau.upper[-1, 0]
    inside = {kind: Fraction(low) <= truth <= Fraction(high) for kind, truth in truths.items()}
    assert inside == {"text": parameters == "text", "doubles": parameters != "text"}
    assert steps(low, high) == 1


@pytest.mark.parametrize(
    ("axis", "unit"),
    [("0 3 4", (0, "3/5", "4/5")), ("0.1 0.2 -0.2", ("1/3", "2/3", "-2/3")), ("0 -2 0", (0, -1, 0))],
)
def test_an_axis_of_rational_length_is_divided_exactly(axis: str, unit: tuple[Any, ...]) -> None:
    """No root is taken, and nothing is rounded."""

    def no_root(square: Fraction) -> Fraction:
        raise AssertionError(square)

    (body,) = exact_parameters(rttrr_pin.load(PENDULUM.format(axis=axis)).model, "text").bodies(RATIONAL, no_root)
    assert list(body.axis) == [Fraction(x) for x in unit]


@pytest.mark.parametrize("rows", ROWS)
def test_rotations_axes_and_turned_tensors_are_not_rounded(rows: int) -> None:
    """Against 60 digits from the file's doubles; the model's own numbers, which were rounded, miss that value."""
    rpy, axis = "0.7 -1.1 2.3", (1.0, -2.0, 0.3)
    tensor = [[0.3, 0.01, -0.02], [0.01, 0.2, 0.03], [-0.02, 0.03, 0.25]]
    text = (
        f'<robot name="x"><link name="o"/><link name="a"><inertial><origin rpy="{rpy}"/><mass value="0.1"/><inertia ixx="0.3" ixy="0.01"'
        f' ixz="-0.02" iyy="0.2" iyz="0.03" izz="0.25"/></inertial></link><joint name="j" type="revolute"><parent link="o"/>'
        f'<child link="a"/><origin rpy="{rpy}"/><axis xyz="1 -2 0.3"/></joint></robot>'
    )
    robot = rttrr_pin.load(text)
    with mpmath.workdps(60):
        R = mp_rotation(rpy.split())
        I = R * mpmath.matrix([[mpmath.mpf(x) for x in row] for row in tensor]) * R.T
        u = mpmath.matrix([mpmath.mpf(x) for x in axis])
        u /= mpmath.sqrt(sum(x * x for x in u))
        N = I * u * mpmath.mpf(0.3)
        F = R.T * mpmath.matrix([0, 0, mpmath.mpf(9.81)]) * mpmath.mpf(0.1)
        found = {
            parameters: robot.enclose(np.zeros((rows, 1)), [0.0], [0.3], parameters=parameters)
            for parameters in ("read", "doubles")
        }
        inside = {
            parameters: [
                mpmath.mpf(ends.lower[0, 0, k]) <= truth[k] <= mpmath.mpf(ends.upper[0, 0, k])
                for truth, ends in ((F, enclosures.F), (N, enclosures.N))
                for k in range(3)
            ]
            for parameters, enclosures in found.items()
        }
    assert all(inside["read"])
    assert not all(inside["doubles"])


@pytest.mark.parametrize("rows", ROWS)
def test_where_every_number_is_a_double_all_say_the_same(rows: int) -> None:
    text = PENDULUM.format(axis="0 1 0").replace("0.3", "0.25").replace("0.1", "0.125").replace("0.7", "0.75")
    robot = rttrr_pin.load(text)
    states = Sampler(robot.model).draw(0, rows)
    of_doubles, *others = (certified(robot, states, parameters) for parameters in ("doubles", "read", "text"))
    for other in others:
        for key, ends in of_doubles.items():
            np.testing.assert_array_equal(ends.lower, getattr(other, key).lower)
            np.testing.assert_array_equal(ends.upper, getattr(other, key).upper)


@pytest.mark.parametrize("seed", range(3))
def test_numbers_of_the_file_are_within_rounding_of_the_models(seed: int) -> None:
    """The bound on our rounding counts from the file's doubles: every joint type, chains of followers, damping."""
    robot = rttrr_pin.load(random_tree(seed, 9), base="floating", friction=True)
    states = Sampler(robot.model, "mixed", seed).draw(0, 20)
    values, bounds = bounded_dynamics(robot.model, states.q, states.v, states.a)
    for parameters in ("read", "doubles"):
        for key, ends in certified(robot, states, parameters).items():
            x, b = getattr(values, key), getattr(bounds, key)
            assert (ends.lower <= x + b).all() and (x - b <= ends.upper).all(), (parameters, key)


def test_a_chain_of_followers_is_multiplied_out_exactly() -> None:
    """0.1 times 0.7 is 0.07 in decimals."""
    chain = (
        random_chain(9, ("revolute", "revolute", "prismatic"))
        .replace("</joint>", '<mimic joint="joint_2" multiplier="0.1"/></joint>', 1)
        .rsplit("</joint>", 2)
    )
    text = f'{chain[0]}<mimic joint="joint_3" multiplier="0.7" offset="0.3"/></joint>{chain[1]}</joint>{chain[2]}'
    direct = text.replace('joint="joint_2" multiplier="0.1"', 'joint="joint_3" multiplier="0.07" offset="0.03"')
    assert direct != text
    q, v, a = np.full((3, 1), 0.4)
    one, other = (rttrr_pin.load(x).enclose(q, v, a, parameters="text") for x in (text, direct))
    for key, ends in one.items():
        np.testing.assert_array_equal(ends.lower, getattr(other, key).lower)


def test_drives_of_the_file_are_its_decimals_and_others_are_doubles() -> None:
    text = PENDULUM.format(axis="0 1 0").replace("</joint>", '<dynamics damping="0.1" friction="0.3"/></joint>')
    robot = rttrr_pin.load(text, friction=True)
    loaded, bare = (x.enclose([0.0], [1.0], [0.0], parameters="text") for x in (robot, rttrr_pin.load(text)))
    weight = -Fraction("0.1") * Fraction("0.3") * Fraction(9.81)
    for enclosures, effects in ((loaded, Fraction("0.4")), (bare, 0)):
        assert Fraction(enclosures.tau.lower[0]) <= weight + effects <= Fraction(enclosures.tau.upper[0])
    geared = robot.with_joint_effects({"j": rttrr_pin.JointEffects(armature=0.1, damping=0.2, friction=0.3)})
    tau = geared.enclose([0.0], [1.0], [0.0], parameters="text").tau
    assert Fraction(tau.lower[0]) <= weight + Fraction(0.2) + Fraction("0.3") <= Fraction(tau.upper[0])


def test_a_robot_without_a_file_has_no_decimals(rttrr: Robot) -> None:
    bare = Robot(replace(rttrr.model, document=None))
    with pytest.raises(InputError, match="was made from numbers and has no file.*pass parameters='doubles'"):
        bare.enclose(np.zeros(5), np.zeros(5), np.zeros(5), parameters="text")


def altered(model: Model, what: str) -> Model:
    links, joints = list(model.links), list(model.joints)
    if what == "mass":
        links[2] = replace(links[2], mass=links[2].mass * 2)
    elif what == "tensor":
        links[2] = replace(links[2], inertia=links[2].inertia * 2)
    elif what == "com":
        links[2] = Link(links[2].name, links[2].mass, links[2].com + 0.1, links[2].inertia, links[2].rotated)
    elif what == "axis":
        joints[2] = replace(joints[2], axis=-joints[2].axis)
    elif what == "R":
        joints[2] = replace(joints[2], R=joints[2].R @ np.diag([-1.0, -1.0, 1.0]))
    elif what == "name":
        joints[2] = replace(joints[2], name="other")
    else:
        joints[2] = replace(joints[2], p=joints[2].p + 0.1)
    return replace(model, links=tuple(links), joints=tuple(joints))


@pytest.mark.parametrize("name", ["rttrr", "any-axes"])
@pytest.mark.parametrize("what", ["mass", "tensor", "com", "axis", "R", "p", "name"])
def test_a_model_that_was_altered_is_not_its_file(name: str, what: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(name, name))
    zeros = np.zeros(robot.model.nv)
    kind = "joint" if what in ("axis", "R", "p", "name") else "link"
    with pytest.raises(InputError, match=f"{kind} .* is not what its file says.*altered since"):
        Robot(altered(robot.model, what)).enclose(zeros, zeros, zeros, parameters="text")


def test_a_mimic_that_was_altered_is_not_its_file() -> None:
    model = rttrr_pin.load(random_tree(*MUTATED)).model
    joints = list(model.joints)
    k, follower = next((k, joint) for k, joint in enumerate(joints) if joint.mimic)
    joints[k] = replace(follower, mimic=replace(follower.mimic, offset=0.25))
    with pytest.raises(InputError, match=f"joint {follower.name!r} .* is not what its file says"):
        exact_parameters(replace(model, joints=tuple(joints)), "read")


# Inputs and shapes


def test_shapes_follow_the_batch(rttrr: Robot) -> None:
    q = np.zeros((2, 1, 5))
    payload = Wrench(np.ones((3, 3)))
    enclosures = rttrr.enclose(q, np.zeros(5), np.zeros(5), payload)
    plain = rttrr.inverse_dynamics(q, np.zeros(5), np.zeros(5), payload)
    for key, x in plain.items():
        ends = getattr(enclosures, key)
        assert ends.lower.shape == ends.upper.shape == ends.mid.shape == x.shape
    assert enclosures.bits.shape == enclosures.tight.shape == (2, 3)
    assert (enclosures.links, enclosures.joints) == (plain.links, plain.joints)
    one = enclosures[1]
    np.testing.assert_array_equal(one.f.lower, enclosures.f.lower[1])
    assert rttrr.enclose(np.zeros((0, 5)), np.zeros(5), np.zeros(5)).f.lower.shape == (0, 6, 3)


def test_dicts_by_joint_name_are_taken(rttrr: Robot) -> None:
    by_name = dict(zip(rttrr.joint_names, (0.1, 0.2, 0.3, 0.4, 0.5), strict=True))
    named, plain = (rttrr.enclose(q, np.zeros(5), np.zeros(5)) for q in (by_name, (0.1, 0.2, 0.3, 0.4, 0.5)))
    np.testing.assert_array_equal(named.n.lower, plain.n.lower)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("which", range(3))
def test_numbers_that_are_none_are_refused(rttrr: Robot, bad: float, which: int) -> None:
    arrays = [np.zeros(5) for _ in "qva"]
    arrays[which][3] = bad
    with pytest.raises(NumberError, match=f"{'qva'[which]}.3., joint 'joint_4', is {bad}"):
        rttrr.enclose(*arrays)


def test_bad_arguments_are_refused(rttrr: Robot) -> None:
    with pytest.raises(ShapeError, match="expected 5"):
        rttrr.enclose(np.zeros(4), np.zeros(5), np.zeros(5))
    with pytest.raises(InputError, match="parameters is 'decimals': expected 'doubles' or 'read' or 'text'"):
        rttrr.enclose(np.zeros(5), np.zeros(5), np.zeros(5), parameters="decimals")  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [1e200, -1e300])
def test_a_result_beyond_float64_is_refused(rttrr: Robot, size: float) -> None:
    with pytest.raises(NumberError, match="overflows in state 0"):
        rttrr.enclose(np.full(5, 0.3), np.full(5, size), np.zeros(5))


def test_a_load_of_the_batch_goes_with_its_state(rttrr: Robot) -> None:
    forces = np.array([[1.0, 2.0, 3.0], [-4.0, 0.0, 5.0]])
    zeros = np.zeros((2, 5))
    both = enclose(rttrr.model, zeros, zeros, zeros, [Load(5, forces, np.zeros(3))])
    for k in range(2):
        one = enclose(rttrr.model, zeros[k], zeros[k], zeros[k], [Load(5, forces[k], np.zeros(3))])
        np.testing.assert_array_equal(one.f.lower, both.f.lower[k])


@pytest.mark.parametrize("parameters", ["doubles", "read", "text"])
def test_a_result_says_whose_numbers_it_encloses(rttrr: Robot, parameters: Any) -> None:
    zeros = [[0.0] * 5] * 2
    result = rttrr.enclose(zeros, zeros, zeros, parameters=parameters)
    assert result.parameters == result[0].parameters == result.to_dict()["parameters"] == parameters


@pytest.mark.parametrize("power", [-250, -100, 100, 200])
def test_enclosures_are_narrow_at_any_size(rttrr: Robot, power: int) -> None:
    """Each is narrow beside the norm of its own vector, however large or small that is."""
    states = Sampler(rttrr.model).draw(0, 3)
    result = enclose(
        rttrr.model.with_gravity(np.array([0.1, 0.2, -9.8]) * 10.0**power), states.q, 0 * states.v, 0 * states.a
    )
    assert result.tight.all()
    for key, x in result.items():
        if key in ("F", "f", "n"):
            assert (norm(x.upper - x.lower) <= 2.0**-50 * norm(x.mid)).all()
