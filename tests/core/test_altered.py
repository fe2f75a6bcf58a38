"""Robots that carry a body, and robots with locked joints: against Pinocchio's own, and against the robot before."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, Wrench, validate
from rttrr_pin.compile.constants import error_of
from rttrr_pin.compile.trace import TRACING_WITH_ERRORS
from rttrr_pin.core.dynamics import body_of
from rttrr_pin.core.joint import Joint, Lock
from rttrr_pin.core.joints import FIXED, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.errors import InputError, NumberError, ShapeError, UnknownNameError
from rttrr_pin.urdf.altered import with_fixed
from rttrr_pin.validation import Sampler
from support.pinocchio_states import pin_model, pin_q
from support.recursion import recursion
from support.serial_chains import random_chain
from support.tolerances import EPS, ROUNDING, norm_error
from support.trees import TREE_TYPES, random_tree

STATES = 3
SEEDS = range(4)
ONE_AXIS = ("revolute", "continuous", "prismatic", "fixed")
MODES = ("doubles", "read", "text")
OTHERS = ("pinocchio", "mujoco", "lagrange")
"""The kernel is compared with exact arithmetic below."""
TENSOR = np.array([[0.4, 0.02, -0.01], [0.02, 0.5, 0.03], [-0.01, 0.03, 0.3]])
BODY: dict[str, Any] = {"mass": 2.5, "com": (0.1, -0.2, 0.3), "inertia": TENSOR}


def tree(seed: int, mimics: bool, base: Any = "fixed", types: tuple[str, ...] = TREE_TYPES) -> Robot:
    return rttrr_pin.load(random_tree(seed, 6, types, mimics), base=base)


def drawn(robot: Robot, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    states = Sampler(robot.model, "mixed", seed).draw(0, STATES)
    return states.q.copy(), states.v.copy(), states.a.copy()


# A body that is carried


@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_payload_body_is_one_that_is_appended_in_pinocchio(seed: int, base: Any) -> None:
    robot = tree(seed, mimics=False, base=base)
    link = robot.link_names[np.random.default_rng(seed).integers(len(robot.link_names))]
    loaded = robot.with_payload_body(link=link, **BODY)
    model = pin_model(robot)
    frame = model.frames[model.getFrameId(link, pin.FrameType.BODY)]
    model.appendBodyToJoint(
        frame.parentJoint, pin.Inertia(BODY["mass"], np.array(BODY["com"]), TENSOR), frame.placement
    )
    data = model.createData()
    q, v, a = drawn(robot)
    theirs = np.array([pin.rnea(model, data, pin_q(robot, q[k]), v[k], a[k]) for k in range(STATES)])
    assert norm_error(recursion(loaded, q, v, a).tau, theirs) <= ROUNDING
    assert norm_error(loaded.compile("tau", "numpy")(q, v, a), theirs) <= ROUNDING


@pytest.mark.parametrize("seed", SEEDS)
def test_it_is_held_by_what_moves_it(seed: int) -> None:
    """Its joint tells what the gripper holds; other links feel it through their joints alone."""
    robot = tree(seed, mimics=True)
    link = robot.link_names[-1]
    loaded = robot.with_payload_body(link=link, **BODY)
    q, v, a = drawn(robot)
    with_it, without = recursion(loaded, q, v, a), recursion(robot, q, v, a)
    held = with_it.at("payload")
    assert norm_error(held["f"], held["F"]) <= ROUNDING
    assert norm_error(held["n"], held["N"] + np.cross(BODY["com"], held["F"])) <= ROUNDING
    assert norm_error(with_it.F[:, :-1], without.F) <= ROUNDING
    as_wrench = recursion(robot, q, v, a, Wrench(held["f"], held["n"], link))
    assert norm_error(with_it.tau, as_wrench.tau) <= ROUNDING


@pytest.mark.parametrize("reference", OTHERS)
def test_other_programs_read_it(reference: str) -> None:
    robot = rttrr_pin.load("rttrr").with_payload_body(**BODY).with_payload_body(0.5, (0, 0, 0.1), name="camera")
    assert validate(robot, "recursion", reference, n_states=20, sampling="mixed").passed


@pytest.mark.parametrize("mode", MODES)
def test_its_numbers_are_exact(mode: Any) -> None:
    robot = tree(3, mimics=True).with_payload_body(**BODY, link="link_0")
    states = drawn(robot)
    result = robot.compile(("tau", "tau_bound"))(*states)
    tau = robot.enclose(*states, parameters=mode).tau
    assert (result["tau"] >= tau.lower - result["tau_bound"]).all()
    assert (result["tau"] <= tau.upper + result["tau_bound"]).all()


def test_what_it_refuses(rttrr: Robot) -> None:
    with pytest.raises(NumberError, match="mass is -1"):
        rttrr.with_payload_body(-1.0)
    with pytest.raises(NumberError, match="mass is nan"):
        rttrr.with_payload_body(np.nan)
    with pytest.raises(InputError, match="not symmetric"):
        rttrr.with_payload_body(1.0, inertia=np.triu(np.ones((3, 3))))
    with pytest.raises(ShapeError, match="com has 2 values"):
        rttrr.with_payload_body(1.0, com=(0, 0))
    with pytest.raises(UnknownNameError, match="no link"):
        rttrr.with_payload_body(1.0, link="hand")
    with pytest.raises(InputError, match="2 times"):
        rttrr.with_payload_body(1.0).with_payload_body(1.0)


# Locked joints


def some_joints(robot: Robot, seed: int) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Half of the joints with coordinates to lock them at; which of q, and which of v, stay."""
    rng = np.random.default_rng(seed)
    moving = robot.model.moving
    names = [str(x) for x in rng.permutation([joint.name for joint in moving if joint.name != "root_joint"])]
    chosen = set(names[: max(1, len(names) // 2)])
    q = drawn(robot, seed + 100)[0][0]
    locked, stays_q, stays_v, at = {}, [], [], 0
    for joint in moving:
        if joint.name in chosen:
            locked[joint.name] = q[at : at + joint.nq] if joint.nq > 1 else q[at]
        stays_q += [joint.name not in chosen] * joint.nq
        stays_v += [joint.name not in chosen] * joint.nv
        at += joint.nq
    return locked, np.array(stays_q, dtype=bool), np.array(stays_v, dtype=bool)


def whole(robot: Robot, locked: dict[str, np.ndarray], seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States of the whole robot in which those joints stand still there."""
    q, v, a = drawn(robot, seed)
    at_q = at_v = 0
    for joint in robot.model.moving:
        if joint.name in locked:
            q[:, at_q : at_q + joint.nq] = locked[joint.name]
            v[:, at_v : at_v + joint.nv] = a[:, at_v : at_v + joint.nv] = 0.0
        at_q, at_v = at_q + joint.nq, at_v + joint.nv
    return q, v, a


@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", SEEDS)
def test_locked_joints_are_those_of_pinocchios_reduced_model(seed: int, base: Any) -> None:
    robot = tree(seed, mimics=False, base=base)
    locked, stays_q, stays_v = some_joints(robot, seed)
    q, v, a = whole(robot, locked, seed)
    model = pin_model(robot)
    reduced = pin.buildReducedModel(model, [model.getJointId(name) for name in locked], pin_q(robot, q[0]))
    data = reduced.createData()
    ours = robot.with_locked(locked)
    q, v, a = q[:, stays_q], v[:, stays_v], a[:, stays_v]
    assert ours.model.nv == reduced.nv
    theirs = np.array([pin.rnea(reduced, data, pin_q(ours, q[k]), v[k], a[k]) for k in range(STATES)])
    if ours.model.nv:
        assert norm_error(recursion(ours, q, v, a).tau, theirs) <= ROUNDING
        assert norm_error(ours.compile("tau", "numpy")(q, v, a), theirs) <= ROUNDING


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_locked_robot_is_exactly_the_whole_one_at_rest_there(seed: int, mode: Any) -> None:
    """The same enclosures to the last bit, of joints of every type and of those that follow; by text too."""
    robot = tree(seed, mimics=True)
    locked, stays_q, stays_v = some_joints(robot, seed)
    q, v, a = whole(robot, locked, seed)
    all_of_it = robot.enclose(q, v, a, parameters=mode)
    ours = robot.with_locked(locked).enclose(q[:, stays_q], v[:, stays_v], a[:, stays_v], parameters=mode)
    for key, enclosure in ours.items():
        other = getattr(all_of_it, key)
        lower, upper = (x[:, stays_v] if key == "tau" else x for x in (other.lower, other.upper))
        tight = (
            (ours.tight & all_of_it.tight)[:, None] if key == "tau" else (ours.tight & all_of_it.tight)[:, None, None]
        )
        assert ((enclosure.lower <= upper) & (lower <= enclosure.upper)).all()
        assert (np.where(tight, np.nextafter(enclosure.lower, np.inf) >= lower, True)).all()


@pytest.mark.one_in(12)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", SEEDS)
def test_the_kernels_bounds_hold_for_locked_joints(seed: int, mode: Any) -> None:
    robot = tree(seed, mimics=True)
    locked, *_ = some_joints(robot, seed)
    ours = robot.with_locked(locked)
    states = drawn(ours)
    exact = ours.enclose(*states, parameters=mode)
    names = ("tau", "F", "N", "f", "n")
    for outputs in (names, ("tau",)):  # alone, with inertia that is moved between links
        result = ours.compile((*outputs, *(f"{name}_bound" for name in outputs)))(*states)
        for name in outputs:
            own, value, bound = getattr(exact, name), result[name], result[f"{name}_bound"]
            assert (value + bound >= own.lower).all()
            assert (value - bound <= own.upper).all()


@pytest.mark.one_in(4)
@pytest.mark.parametrize("reference", OTHERS)
@pytest.mark.parametrize("seed", [1, 2])
def test_other_programs_read_locked_robots(reference: str, seed: int) -> None:
    """The verdict is as for any robot: within rounding."""
    robot = rttrr_pin.load(random_chain(seed, ("revolute", "prismatic", "revolute", "continuous", "revolute")))
    ours = robot.with_locked({"joint_1": 0.7, "joint_2": -0.3, "joint_4": 2.0})
    assert ours.joint_names == ("joint_3", "joint_5")
    assert validate(ours, "recursion", reference, n_states=50, sampling="mixed").passed


def posed(seed: int, others: bool = False) -> tuple[Robot, Robot, dict[str, Any]]:
    """A floating tree, the same with its base locked at a drawn pose, and other joints if wished; and where."""
    robot = tree(seed, mimics=True, base="floating", types=ONE_AXIS if seed % 2 else TREE_TYPES)
    locked = {"root_joint": drawn(robot, seed)[0][0, :7]}
    if others:
        locked |= {joint.name: drawn(robot, seed)[0][0, 7] for joint in robot.model.moving[1:2] if joint.nq == 1}
    return robot, robot.with_locked(locked), locked


@pytest.mark.one_in(8)
@pytest.mark.parametrize("others", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_locked_base_is_a_fixed_one_at_that_pose(seed: int, others: bool) -> None:
    """The floating robot at zero rates there, and Pinocchio's reduced model; its text reads as the same."""
    robot, ours, locked = posed(seed, others)
    assert not ours.model.floating and "root_joint" not in ours.joint_names
    q, v, a = drawn(ours)
    free = np.array([joint.name not in locked for joint in robot.model.moving for _ in range(joint.nv)])
    free_q = np.array([joint.name not in locked for joint in robot.model.moving for _ in range(joint.nq)])
    Q, V, A = (np.zeros((STATES, n)) for n in (robot.model.nq, robot.model.nv, robot.model.nv))
    Q[:, ~free_q] = np.concatenate([np.atleast_1d(x) for x in locked.values()])
    Q[:, free_q], V[:, free], A[:, free] = q, v, a
    fixed, floating = ours.inverse_dynamics(q, v, a), recursion(robot, Q, V, A)
    assert norm_error(fixed.tau, floating.tau[:, free]) <= ROUNDING if free.any() else True
    for name in ("F", "N", "f", "n"):
        assert norm_error(getattr(fixed, name), getattr(floating, name)) <= ROUNDING
    again = rttrr_pin.load(ours.model.urdf)
    assert (again.link_names, again.joint_names) == (ours.link_names, ours.joint_names)
    assert norm_error(recursion(again, q, v, a).n, fixed.n) <= ROUNDING


@pytest.mark.parametrize("seed", SEEDS)
def test_a_locked_base_is_that_of_pinocchios_reduced_model(seed: int) -> None:
    robot = tree(seed, mimics=False, base="floating")
    pose = drawn(robot, seed)[0][0]
    model, ours = pin_model(robot), robot.with_locked({"root_joint": pose[:7]})
    reduced = pin.buildReducedModel(model, [model.getJointId("root_joint")], pin_q(robot, pose))
    data, (q, v, a) = reduced.createData(), drawn(ours)
    theirs = np.array([pin.rnea(reduced, data, pin_q(ours, q[k]), v[k], a[k]) for k in range(STATES)])
    assert ours.model.nv == reduced.nv
    if ours.model.nv:
        assert norm_error(recursion(ours, q, v, a).tau, theirs) <= ROUNDING


@pytest.mark.parametrize("mode", MODES)
def test_a_locked_base_is_as_exact_as_its_doubles(mode: Any) -> None:
    robot, ours, locked = posed(1)
    q, v, a = drawn(ours)
    pose, still = np.tile(locked["root_joint"], (STATES, 1)), np.zeros((STATES, 6))
    whole_of_it = robot.enclose(np.hstack([pose, q]), np.hstack([still, v]), np.hstack([still, a]), parameters=mode)
    exact = ours.enclose(q, v, a, parameters=mode)
    np.testing.assert_array_equal(exact.n.lower, whole_of_it.n.lower)
    np.testing.assert_array_equal(exact.n.upper, whole_of_it.n.upper)
    bounds = ours.compile(("n", "n_bound"))(q, v, a)
    assert (np.abs(bounds["n"] - exact.n.lower) <= bounds["n_bound"] + (exact.n.upper - exact.n.lower)).all()


@pytest.mark.one_in(2)
@pytest.mark.parametrize("reference", OTHERS)
def test_other_programs_read_a_locked_base(reference: str) -> None:
    robot = rttrr_pin.load(random_chain(3, ("revolute", "prismatic", "continuous")), base="floating")
    pose = drawn(robot)[0][0, :7]
    ours = robot.with_locked({"root_joint": pose}).with_payload_body(**BODY)
    assert validate(ours, "recursion", reference, n_states=50, sampling="mixed").passed
    assert validate(ours.with_locked({"joint_2": 0.1}), "recursion", reference, n_states=20, sampling="mixed").passed


def test_its_text_reads_as_the_same_robot() -> None:
    robot = rttrr_pin.load("rttrr").with_locked({"joint_2": 0.2, "joint_5": 1.0}).with_payload_body(**BODY)
    again = rttrr_pin.load(robot.model.urdf)
    assert again.joint_names == robot.joint_names
    q, v, a = drawn(robot)
    assert norm_error(recursion(again, q, v, a).tau, recursion(robot, q, v, a).tau) <= ROUNDING


def test_joints_are_locked_one_after_the_other_or_at_once(rttrr: Robot) -> None:
    at_once = rttrr.with_locked({"joint_2": 0.2, "joint_4": -1.0})
    in_turn = rttrr.with_locked({"joint_4": -1.0}).with_locked({"joint_2": 0.2})
    q, v, a = drawn(at_once)
    for one, other in zip(
        at_once.inverse_dynamics(q, v, a).items(), in_turn.inverse_dynamics(q, v, a).items(), strict=True
    ):
        np.testing.assert_array_equal(one[1], other[1])


def test_all_joints_may_be_locked(rttrr: Robot) -> None:
    still = rttrr.with_locked(dict.fromkeys(rttrr.joint_names, 0.5))
    result, moving = still.inverse_dynamics([], [], []), rttrr.inverse_dynamics([0.5] * 5, [0] * 5, [0] * 5)
    assert result.tau.shape == (0,)
    assert norm_error(result.n, moving.n) <= ROUNDING


def test_armature_of_a_locked_joint_counts_no_more(rttrr: Robot) -> None:
    driven = rttrr.with_joint_effects({"joint_1": JointEffects(1.0, 2.0, 3.0), "joint_3": JointEffects(0.5)})
    ours = driven.with_locked({"joint_1": 0.1})
    assert ours.inverse_dynamics([0] * 4, [1] * 4, [1] * 4).tau_joint.tolist() == [0, 0.5, 0, 0]
    assert ours.model.joints[0].effects == JointEffects()


def test_a_locked_placement_knows_how_it_is_rounded() -> None:
    """Sine and cosine of the angle bring their error into the kernel's bounds, as an rpy of the file does."""
    joint = rttrr_pin.load(random_chain(1, ("revolute",))).with_locked({"joint_1": 0.7}).model.joints[0]
    plain = replace(joint, lock=replace(joint.lock, joint=replace(joint.lock.joint, rotated=False)))  # type: ignore[type-var]
    for one in (joint, plain):
        body = body_of(one, Link("x"), TRACING_WITH_ERRORS)
        assert all(error_of(x) > EPS / 2 for row in body.R.rows for x in row)  # type: ignore[arg-type]
    about_x = Joint("x", REVOLUTE)
    locked = body_of(Joint("x", FIXED, lock=Lock(about_x, (0.7,))), Link("x"), TRACING_WITH_ERRORS)
    assert all(error_of(x) > 0.0 for x in (*locked.R.rows[1],)[1:])  # type: ignore[arg-type]


def test_a_robot_of_numbers_and_one_of_an_object_can_be_altered(rttrr: Robot) -> None:
    model = rttrr.model
    numbers = Robot(Model(model.name, model.root, model.links, model.joints))
    built = rttrr_pin.load(pin.buildModelFromXML(model.urdf))
    q, v, a = drawn(rttrr.with_locked({"joint_2": 0.2}))
    altered = [
        robot.with_locked({"joint_2": 0.2}).with_payload_body(**BODY, link=robot.link_names[4])
        for robot in (rttrr, numbers, built)
    ]
    taus = [recursion(robot, q, v, a).tau for robot in altered]
    assert norm_error(taus[1], taus[0]) <= ROUNDING
    assert norm_error(taus[2], taus[0]) <= ROUNDING
    assert validate(altered[2], "recursion", n_states=20).passed


def test_altered_robots_can_be_pickled(rttrr: Robot) -> None:
    robot = rttrr.with_locked({"joint_2": 0.2}).with_payload_body(**BODY)
    q, v, a = drawn(robot)
    copy = pickle.loads(pickle.dumps(robot))
    np.testing.assert_array_equal(copy.inverse_dynamics(q, v, a).tau, robot.inverse_dynamics(q, v, a).tau)


def test_a_text_with_a_default_namespace_keeps_it() -> None:
    robot = rttrr_pin.load("rttrr")
    document = robot.model.document
    spaced = replace(document, text=document.text.replace("<robot ", '<robot xmlns="urdf" ', 1))  # type: ignore[type-var]
    model = pin.buildModelFromXML(with_fixed(spaced, robot.with_locked({"joint_2": 0.2}).model).text)
    assert list(model.names)[1:] == ["joint_1", "joint_3", "joint_4", "joint_5"]


def test_what_cannot_be_locked(rttrr: Robot) -> None:
    with pytest.raises(UnknownNameError, match="no moving joint is called 'elbow'"):
        rttrr.with_locked({"elbow": 0.0})
    with pytest.raises(NumberError, match="finite"):
        rttrr.with_locked({"joint_1": np.inf})
    with pytest.raises(ShapeError, match="one state"):
        rttrr.with_locked({"joint_1": [0.0, 1.0]})
    with pytest.raises(NumberError, match="divide it by its length"):  # as other programs read it, it is another turn
        rttrr_pin.load("rttrr", base="floating").with_locked({"root_joint": [0, 0, 0, 0, 0, 0, 1 + 1e-13]})
    text = random_chain(7, ("revolute", "revolute"))
    follower = rttrr_pin.load(text.replace("</joint>", '<mimic joint="joint_2"/></joint>', 1))
    with pytest.raises(UnknownNameError, match="follows 'joint_2': lock that one"):
        follower.with_locked({"joint_1": 0.0})
    assert rttrr.with_locked({}).joint_names == rttrr.joint_names
    assert [joint.type for joint in follower.with_locked({"joint_2": 0.0}).model.joints] == [FIXED, FIXED]
