"""Every joint type, followers, floating bases and drives: against Pinocchio, and against what their words mean."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, RttrrError
from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.errors import InputError, NumberError, ShapeError, UnknownNameError, UrdfError
from rttrr_pin.validation import Sampler, validate
from support.implementations import evaluated
from support.recursion import recursion
from support.serial_chains import inertial, joint, random_chain
from support.tolerances import ROUNDING, norm_error
from support.trees import TREE_TYPES, random_tree

SEEDS = range(12)


@pytest.mark.one_in(6)
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", SEEDS)
def test_random_trees_agree_with_pinocchio(seed: int, base: Any) -> None:
    """All joint types, branches, followers, massless frames, friction; 1,000 more in benchmarks/random_trees.py."""
    robot = rttrr_pin.load(random_tree(seed, 2 + 2 * seed), base=base, friction=True)
    result = validate(robot, "recursion", n_states=16, seed=seed, sampling="mixed")
    assert result.passed, result.worst


@pytest.mark.parametrize("kind", TREE_TYPES)
def test_each_joint_type_alone_and_below_itself(kind: str) -> None:
    for joints in (1, 3):
        robot = rttrr_pin.load(random_tree(joints, joints, (kind,), mimics=False))
        assert {joint.type for joint in robot.model.joints} == {JOINT_TYPES[kind]}
        assert validate(robot, "recursion", n_states=40, sampling="mixed").passed


@pytest.mark.parametrize("seed", SEEDS)
def test_order_is_pinocchios(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 20)).model
    names = pin.buildModelFromXML(model.urdf).names
    assert [joint.name for joint in model.joints if joint.nv] == list(names)[1:]


def following(multiplier: float = -1.5, offset: float = 0.3) -> tuple[Robot, Robot]:
    """A chain whose first joint follows its last, which sorts later; and the same with both free."""
    text = random_chain(7, ("revolute", "prismatic", "revolute"))
    mimic = f'<mimic joint="joint_3" multiplier="{multiplier}" offset="{offset}"/></joint>'
    return rttrr_pin.load(text.replace("</joint>", mimic, 1)), rttrr_pin.load(text)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_follower_moves_as_it_says_and_its_force_counts(seed: int) -> None:
    """By virtual work: the followed joint's tau takes the follower's, times the multiplier."""
    bound, free = following()
    assert bound.joint_names == ("joint_2", "joint_3")
    drawn = Sampler(bound.model, seed=seed).draw(0, 20)
    ours = bound.inverse_dynamics(drawn.q, drawn.v, drawn.a)
    full = [
        np.stack([-1.5 * x[:, 1] + shift, x[:, 0], x[:, 1]], axis=1)
        for x, shift in ((drawn.q, 0.3), (drawn.v, 0.0), (drawn.a, 0.0))
    ]
    theirs = free.inverse_dynamics(*full)
    assert norm_error(ours.n, theirs.n) <= ROUNDING
    expected = np.stack([theirs.tau[:, 1], theirs.tau[:, 2] - 1.5 * theirs.tau[:, 0]], axis=1)
    assert norm_error(ours.tau, expected) <= ROUNDING
    assert validate(bound, "recursion", n_states=200, seed=seed).passed


def test_pinocchio_itself_agrees_where_it_can_follow() -> None:
    """With `mimic=True`, for a follower that sorts after the followed joint."""
    text = random_chain(8, ("revolute", "prismatic", "revolute"))
    head, tail = text.rsplit("</joint>", 1)
    text = f'{head}<mimic joint="joint_1" multiplier="0.7" offset="-0.2"/></joint>{tail}'
    robot = rttrr_pin.load(text)
    model = pin.buildModelFromXML(text, mimic=True)
    data = model.createData()
    drawn = Sampler(robot.model).draw(0, 20)
    ours = recursion(robot, drawn.q, drawn.v, drawn.a)
    theirs = [pin.rnea(model, data, *state) for state in zip(drawn.q, drawn.v, drawn.a, strict=True)]
    assert norm_error(ours.tau, theirs) <= ROUNDING


def test_followers_of_followers_are_multiplied_out() -> None:
    text = random_chain(9, ("revolute", "revolute", "revolute"))
    first = text.replace("</joint>", '<mimic joint="joint_2" multiplier="2" offset="1"/></joint>', 1)
    head, joint_2, joint_3 = first.rsplit("</joint>", 2)
    robot = rttrr_pin.load(
        f'{head}<mimic joint="joint_3" multiplier="3" offset="4"/></joint>{joint_2}</joint>{joint_3}'
    )
    mimic = robot.model.joints[0].mimic
    assert mimic is not None
    assert (mimic.joint, mimic.multiplier, mimic.offset) == (2, 6.0, 9.0)
    assert robot.joint_names == ("joint_3",)


def followers(*multipliers: str, friction: str = "0") -> str:
    """A chain in which each joint but the last follows the next."""
    joints = random_chain(9, ("revolute",) * (len(multipliers) + 1)).split("</joint>")
    dynamics = f'<dynamics friction="{friction}"/>'
    for i, x in enumerate(multipliers):
        joints[i] += f'{dynamics}<mimic joint="joint_{i + 2}" multiplier="{x}"/>'
    return "</joint>".join(joints)


@pytest.mark.parametrize(
    "lost", [("1e-200", "-1e-200"), ("1e-155", "1e-155"), ("1e200", "1e200"), ("1e-310", "1", "1")]
)
def test_a_chain_whose_product_float64_does_not_hold_is_refused(lost: tuple[str, ...]) -> None:
    """It is neither zero nor infinite, nor has it lost digits; without mimic it can be read."""
    with pytest.raises(UrdfError, match="float64 does not hold to its precision"):
        rttrr_pin.load(followers(*lost))
    assert len(rttrr_pin.load(followers(*lost), mimic=False).joint_names) == len(lost) + 1


@pytest.mark.one_in(2)
@pytest.mark.parametrize("held", [("1e-60", "-1e60"), ("1e-200", "0", "1e-200"), ("1e-150", "1e-150"), ("-1e-300",)])
def test_what_a_chain_multiplies_is_exact(held: tuple[str, ...]) -> None:
    """Between the products of the parts may lie anything; friction keeps its sign through rates of 1e-300."""
    robot = rttrr_pin.load(followers(*held, friction="3"), friction=True)
    states = Sampler(robot.model, "mixed", 1).draw(0, 10)
    q, v, a = states.q, states.v * 1e-30, states.a
    got, exact = robot.compile(("tau", "tau_bound"), "numpy")(q, v, a), robot.enclose(q, v, a).tau
    assert (got["tau"] + got["tau_bound"] >= exact.lower).all() and (got["tau"] - got["tau_bound"] <= exact.upper).all()
    assert (got["tau_bound"] <= 1e-9 * np.abs(exact.upper).max(axis=-1, keepdims=True)).all()
    assert validate(robot, "recursion", n_states=20, sampling="mixed").passed
    product = float(np.prod([float(x) for x in held]))
    own = robot.inverse_dynamics(q, v, a).tau_joint
    assert product == 0.0 or (own != 0.0).any()


def test_a_circle_of_followers_is_an_error() -> None:
    text = random_chain(9, ("revolute", "revolute"))
    head, last = text.replace("</joint>", '<mimic joint="joint_2"/></joint>', 1).rsplit("</joint>", 1)
    with pytest.raises(UrdfError, match="follows itself through joint_1 -> joint_2 -> joint_1"):
        rttrr_pin.load(f'{head}<mimic joint="joint_1"/></joint>{last}')


@pytest.mark.parametrize("seed", [0, 1])
def test_a_floating_base_is_pinocchios_free_flyer(rttrr: Robot, seed: int) -> None:
    """Same q, v, tau, and the wrench on the base is what holds the whole robot."""
    robot = rttrr_pin.load("rttrr", base="floating")
    assert (robot.model.nq, robot.model.nv) == (12, 11)
    assert robot.link_names[0] == "base"
    model = pin.buildModelFromXML(rttrr.model.urdf, pin.JointModelFreeFlyer())
    data = model.createData()
    drawn = Sampler(robot.model, seed=seed).draw(0, 10)
    ours = recursion(robot, drawn.q, drawn.v, drawn.a)
    for k in range(10):
        assert norm_error(ours.tau[k], pin.rnea(model, data, drawn.q[k], drawn.v[k], drawn.a[k])) <= ROUNDING
    np.testing.assert_array_equal(ours.tau[:, :3], ours.f[:, 0])


def test_a_floating_base_at_rest_is_the_fixed_one(rttrr: Robot) -> None:
    floating = rttrr_pin.load("rttrr", base="floating")
    drawn = Sampler(rttrr.model).draw(0, 5)
    at_rest = np.tile([0, 0, 0, 0, 0, 0, 1.0], (5, 1))
    still = np.zeros((5, 6))
    one = floating.inverse_dynamics(
        np.hstack([at_rest, drawn.q]), np.hstack([still, drawn.v]), np.hstack([still, drawn.a])
    )
    other = rttrr.inverse_dynamics(drawn.q, drawn.v, drawn.a)
    assert norm_error(one.tau[:, 6:], other.tau) <= ROUNDING
    assert norm_error(one.n[:, 1:], other.n) <= ROUNDING


def test_free_fall_needs_no_force() -> None:
    """A floating body that accelerates by gravity, in its own axes: tau is zero."""
    robot = rttrr_pin.load("rttrr", base="floating")
    q = np.array([0, 0, 0, 0, 0, 0, 1.0, 0.1, 0, 0.1, 0.2, 0.3])
    a = np.r_[0, 0, -9.81, np.zeros(8)]
    assert np.abs(robot.inverse_dynamics(q, np.zeros(11), a).f).max() == 0.0


def test_dicts_name_the_slots_of_wide_joints() -> None:
    robot = rttrr_pin.load("rttrr", base="floating")
    rest = dict.fromkeys(robot.joint_names[1:], 0.1)
    q = rest | {"root_joint": [0, 0, 1, 0, 0, 0, 1]}
    v = rest | {"root_joint": [1, 2, 3, 4, 5, 6]}
    array = robot.inverse_dynamics(np.r_[0, 0, 1, 0, 0, 0, 1, [0.1] * 5], np.r_[1:7, [0.1] * 5], np.zeros(11))
    np.testing.assert_array_equal(robot.inverse_dynamics(q, v, np.zeros(11)).f, array.f)
    assert array.joints[:6] == tuple(f"root_joint.{slot}" for slot in ("x", "y", "z", "rx", "ry", "rz"))


BAD: dict[str, tuple[Any, type[RttrrError], str]] = {
    "length": (
        np.r_[0, 0, 0, 0, 0, 0, 2.0, np.zeros(5)],
        NumberError,
        "quaternion .* of length 2, expected 1: divide it",
    ),
    "float32": (np.r_[0, 0, 0, 0, 0, 0.6, np.float32(0.8), np.zeros(5)].astype(np.float32), NumberError, "of length 1"),
    "batch": (np.tile(np.r_[np.zeros(7), np.zeros(5)], (3, 1)), NumberError, r"q\[0\], joint 'root_joint'"),
    "short": (np.zeros(11), ShapeError, r"q has 11 values .* expected 12 \(root_joint.x, .*: pass one per coordinate"),
    "dict": (
        dict.fromkeys(("root_joint", *(f"joint_{i}" for i in range(1, 6))), 0.0),
        ShapeError,
        r"q\['root_joint'\] has shape \(\), expected \(..., 7\)",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_floating_coordinates(case: str) -> None:
    values, error, message = BAD[case]
    with pytest.raises(error, match=message):
        rttrr_pin.load("rttrr", base="floating").inverse_dynamics(values, np.zeros(11), np.zeros(11))


def test_base_is_fixed_or_floating() -> None:
    with pytest.raises(InputError, match="expected 'fixed'"):
        rttrr_pin.load("rttrr", base="free")  # type: ignore[arg-type]


def test_drives_add_to_tau_and_not_to_the_bearings(rttrr: Robot) -> None:
    effects = {"joint_2": JointEffects(armature=3.0, damping=2.0, friction=5.0), "joint_5": JointEffects(armature=0.1)}
    robot = rttrr.with_joint_effects(effects)
    drawn = Sampler(rttrr.model).draw(0, 30)
    drawn.v[0] = 0.0
    with_, without = (x.inverse_dynamics(drawn.q, drawn.v, drawn.a) for x in (robot, rttrr))
    own = np.zeros((30, 5))
    own[:, 1] = 3.0 * drawn.a[:, 1] + 2.0 * drawn.v[:, 1] + 5.0 * np.sign(drawn.v[:, 1])
    own[:, 4] = 0.1 * drawn.a[:, 4]
    assert norm_error(with_.tau_joint, own) <= ROUNDING
    assert norm_error(with_.tau - with_.tau_joint, without.tau) <= ROUNDING
    np.testing.assert_array_equal(with_.n, without.n)
    assert not without.tau_joint.any()
    assert validate(robot, "recursion", n_states=300).passed


def test_friction_of_the_file_is_an_option() -> None:
    text = random_chain(3, ("revolute", "prismatic")).replace(
        "</joint>", '<dynamics damping="2" friction="0.5"/></joint>'
    )
    without, with_ = (rttrr_pin.load(text, friction=choice) for choice in (False, True))
    v = np.array([0.3, -0.2])
    assert not without.inverse_dynamics([0, 0], v, [0, 0]).tau_joint.any()
    own = with_.inverse_dynamics([0, 0], v, [0, 0]).tau_joint
    assert norm_error(own, 2 * v + 0.5 * np.sign(v)) <= ROUNDING


def test_armature_is_in_pinocchios_torque_and_not_in_its_force(rttrr: Robot) -> None:
    """tau - S^T f = armature * a."""
    robot = rttrr.with_joint_effects({"joint_1": JointEffects(armature=0.7)})
    drawn = Sampler(rttrr.model).draw(0, 10)
    theirs = evaluated("pinocchio", robot.model, drawn.q, drawn.v, drawn.a).values
    assert norm_error(theirs["tau"][:, 0], theirs["n"][:, 0, 2] + 0.7 * drawn.a[:, 0]) <= ROUNDING


@pytest.mark.parametrize(
    ("effects", "error", "message"),
    [
        ({"joint_9": JointEffects()}, UnknownNameError, "no moving joint is called 'joint_9'"),
        ({"tool_joint": JointEffects()}, UnknownNameError, "tool_joint"),
        ({"joint_1": JointEffects(armature=-1.0)}, NumberError, "armature of joint 'joint_1' is -1.0"),
        ({"joint_1": JointEffects(friction=np.nan)}, NumberError, "friction of joint 'joint_1' is nan"),
    ],
    ids=str,
)
def test_bad_drives(rttrr: Robot, effects: dict[str, JointEffects], error: type[RttrrError], message: str) -> None:
    with pytest.raises(error, match=message):
        rttrr.with_joint_effects(effects)


def test_planar_joints_lie_in_the_plane_of_z() -> None:
    text = random_tree(1, 1, ("planar",), mimics=False)
    axis = text[text.index("<axis") : text.index("/>", text.index("<axis")) + 2]
    with pytest.raises(UrdfError, match=r"planar joint is not along \+z"):
        rttrr_pin.load(text.replace(axis, '<axis xyz="1 0 0"/>'))


def test_a_fixed_link_is_what_pinocchio_says_where_the_body_has_no_branch() -> None:
    """`computeSupportedForceByFrame`, which needs forwardKinematics and rnea before it."""
    robot = rttrr_pin.load(random_chain(3, ("revolute", "fixed", "fixed", "prismatic", "fixed", "revolute", "fixed")))
    model = pin.buildModelFromXML(robot.model.urdf)
    data = model.createData()
    drawn = Sampler(robot.model).draw(0, 10)
    ours = recursion(robot, drawn.q, drawn.v, drawn.a)
    for k in range(10):
        pin.forwardKinematics(model, data, drawn.q[k], drawn.v[k], drawn.a[k])
        pin.rnea(model, data, drawn.q[k], drawn.v[k], drawn.a[k])
        for i in (1, 2, 4, 6):
            frame = model.getFrameId(f"joint_{i + 1}", pin.FrameType.FIXED_JOINT)
            force = pin.computeSupportedForceByFrame(model, data, frame)
            assert norm_error(ours.f[k, i], force.linear) <= ROUNDING
            assert norm_error(ours.n[k, i], force.angular) <= ROUNDING


def test_a_sensor_beside_a_branch_carries_its_own_weight_alone() -> None:
    """Where Pinocchio's function adds the branch."""
    rng = np.random.default_rng(0)
    links = "".join(f'<link name="{name}">{inertial(rng)}</link>' for name in ("arm", "sensor", "branch"))
    joints = [
        joint(1, "revolute", "base", "arm", (0, 0, 0), (0, 0, 0)),
        joint(2, "fixed", "arm", "sensor", (0.1, 0, 0), (0, 0, 0)),
        joint(3, "revolute", "arm", "branch", (0, 0.1, 0), (0, 0, 0)),
    ]
    robot = rttrr_pin.load(f'<robot name="x"><link name="base"/>{links}{"".join(joints)}</robot>')
    mass = robot.model.links[robot.model.link_index("sensor")].mass
    result = robot.inverse_dynamics([0.3, 0.4], [0, 0], [0, 0])
    assert abs(np.linalg.norm(result.at("sensor")["f"]) - 9.81 * mass) <= ROUNDING * mass
    assert validate(robot, "recursion", n_states=50).passed


@pytest.mark.one_in(6)
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("multiplier", [1e-200, -1e-200, 1.5, 0.0])
@pytest.mark.parametrize("name", ["recursion", "kernel", "lagrange", "pinocchio", "mujoco"])
def test_a_followers_friction_has_the_sign_of_its_rate_though_that_underflows(
    name: str, multiplier: float, sign: float
) -> None:
    """By virtual work: |multiplier| friction sign(rate of the followed joint)."""
    model = following(multiplier)[0].with_joint_effects({"joint_1": JointEffects(friction=5.0)}).model
    v = np.array([[0.0, sign * 1e-200]])
    got = evaluated(name, model, np.zeros((1, 2)), v, np.zeros((1, 2)))
    assert got.tau_joint is not None
    assert got.tau_joint[0].tolist() == [0.0, sign * abs(multiplier) * 5.0]
