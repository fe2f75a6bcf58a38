"""What is drawn is what the API says, in world axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.core.joints import CONTINUOUS, PLANAR
from rttrr_pin.core.payload import loads_of
from rttrr_pin.implementations import Batch, make_implementation
from rttrr_pin.viewing.evaluation import Evaluator
from rttrr_pin.viewing.scene import arrows, placement
from rttrr_pin.viewing.skeleton import skeleton
from rttrr_pin.viewing.states import State
from support.pinocchio_states import pin_model
from support.tolerances import ROUNDING
from support.viewed import random_state, tree

SEEDS = range(6)


def pin_q(robot: Robot, q: np.ndarray) -> np.ndarray:
    """Pinocchio's coordinates, where joints that follow others have some of their own."""
    model, own, out, at = robot.model, {}, [], 0
    for i in model.independent:
        own[i] = q[at : at + model.joints[i].nq].tolist()
        at += model.joints[i].nq
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None:
            own[i] = [joint.mimic.multiplier * own[joint.mimic.joint][0] + joint.mimic.offset]
        if joint.nq:
            x = own[i]
            out += [*x[:-1], np.cos(x[-1]), np.sin(x[-1])] if joint.type in (CONTINUOUS, PLANAR) else x
    return np.array(out)


def numbers_of(robot: Robot, state: State) -> dict[str, np.ndarray]:
    """By the reference recursion, which needs no compiler."""
    batch = Batch(robot.model, state.q[None], state.v[None], state.a[None], state.loads)
    return {key: x[0] for key, x in make_implementation("recursion", robot.model).evaluate(batch).values.items()}


def close(x: np.ndarray, y: np.ndarray) -> bool:
    return bool(np.linalg.norm(x - y) <= ROUNDING * (1.0 + np.linalg.norm(y)))


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_links_are_where_pinocchio_has_them(seed: int, floating: bool) -> None:
    """Also those that follow others, float, or are fixed."""
    robot = tree(seed, floating=floating)
    state = random_state(robot, seed)
    where = placement(robot.model, state.q)
    model = pin_model(robot)
    data = model.createData()
    pin.forwardKinematics(model, data, pin_q(robot, state.q))
    pin.updateFramePlacements(model, data)
    for i, name in enumerate(robot.link_names):
        frame = data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
        assert close(where.R[i], frame.rotation)
        assert close(where.p[i], frame.translation)
        assert close(where.com[i], frame.act(robot.model.links[i].com))


@pytest.mark.parametrize("seed", SEEDS)
def test_forces_and_moments_at_each_link_balance(seed: int) -> None:
    """What the parent exerts, less what the children get and what the payload takes, is the net force and moment."""
    robot = tree(seed)
    model = robot.model
    leaf = robot.link_names[model.leaves()[0]]
    loads = (Wrench((1, -2, 3), (0.3, 0.2, -0.1), leaf, "base"), Wrench((4, 5, 6), (1, 0, 2), robot.link_names[0]))
    state = replace(random_state(robot, seed), loads=loads_of(model, loads))
    where = placement(model, state.q)
    drawn = arrows(where, numbers_of(robot, state), state.loads)
    force, moment = (np.array(drawn[key].vector) for key in ("f", "n"))
    about = where.com  # of link i: moments about its centre of mass
    moment = moment + np.cross(where.p - about, drawn["f"].vector)
    for i, joint in enumerate(model.joints):
        if joint.parent >= 0:
            force[joint.parent] -= drawn["f"].vector[i]
            moment[joint.parent] -= drawn["n"].vector[i] + np.cross(
                where.p[i] - about[joint.parent], drawn["f"].vector[i]
            )
    for k, load in enumerate(state.loads):
        force[load.link] -= drawn["payload f"].vector[k]
        arm = where.p[load.link] - about[load.link]
        moment[load.link] -= drawn["payload n"].vector[k] + np.cross(arm, drawn["payload f"].vector[k])
    assert close(force, drawn["F"].vector)
    assert close(moment, drawn["N"].vector)
    assert (drawn["F"].at == where.com).all() and (drawn["f"].at == where.p).all()


def test_numbers_of_the_robot_have_the_bits_of_the_api() -> None:
    robot = tree(1, joints=2)
    state = replace(random_state(robot), loads=loads_of(robot.model, Wrench((1, 2, 3), link=robot.link_names[0])))
    (values,) = Evaluator(robot)(state).values.values()
    wanted = robot.inverse_dynamics(state.q, state.v, state.a, list(state.loads))
    for key, x in wanted.items():
        assert (values[key] == x).all()


def test_a_number_that_is_none_has_no_arrow() -> None:
    robot = rttrr_pin.load("rttrr")
    where = placement(robot.model, random_state(robot).q)
    f = np.ones((len(robot.link_names), 3))
    f[2, 1] = np.nan
    drawn = arrows(where, {"f": f})
    assert set(drawn) == {"f", "payload f", "payload n"}
    assert not drawn["f"].vector[2].any() and np.isfinite(drawn["f"].vector).all() and drawn["f"].vector[1].any()


@pytest.mark.parametrize("seed", SEEDS)
def test_bones_go_from_joint_to_joint(seed: int) -> None:
    robot = tree(seed, floating=True)
    where = placement(robot.model, random_state(robot, seed).q)
    lines = skeleton(robot.model, where, 1.0)
    for i, joint in enumerate(robot.model.joints):
        if joint.parent >= 0:
            assert close(lines.bones.at[i], where.p[joint.parent])
            assert close(lines.bones.at[i] + lines.bones.vector[i], where.p[i])
    turning = [i for i, joint in enumerate(robot.model.joints) if joint.type.has_direction]
    middles = lines.axes.at + lines.axes.vector / 2.0
    assert close(middles, where.p[turning])
    for k, i in enumerate(turning):
        axis = where.R[i] @ robot.model.joints[i].axis
        assert close(np.cross(lines.axes.vector[k], axis), np.zeros(3))
