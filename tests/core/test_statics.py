"""Jacobians, and wrenches at any point of any link: against Pinocchio, and against the recursion's own payloads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.errors import InputError, ShapeError, UnknownNameError
from rttrr_pin.validation import Sampler
from support.pinocchio_states import pin_model, pin_q
from support.recursion import recursion
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

STATES = 4
POINT = (0.3, -0.2, 0.7)
FORCE, MOMENT = (10.0, -20.0, 30.0), (1.0, 2.0, -3.0)


def drawn(robot: Robot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    states = Sampler(robot.model, "mixed", 3).draw(0, STATES)
    return states.q, states.v, states.a


@pytest.mark.one_in(3)
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", range(3))
def test_jacobians_and_placements_are_pinocchios(seed: int, base: Any) -> None:
    robot = rttrr_pin.load(random_tree(seed, 6, mimics=False), base=base)
    model = pin_model(robot)
    data = model.createData()
    q = drawn(robot)[0]
    parts = robot.compile(("link_jacobians", "link_placements"))(q)
    for k in range(STATES):
        pin.computeJointJacobians(model, data, pin_q(robot, q[k]))
        pin.updateFramePlacements(model, data)
        for i, link in enumerate(robot.link_names):
            frame = model.getFrameId(link, pin.FrameType.BODY)
            J = pin.getFrameJacobian(model, data, frame, pin.LOCAL)
            assert norm_error(parts["link_jacobians"][k, i], J) <= ROUNDING
            placed = np.array(data.oMf[frame].homogeneous)[:3]
            assert norm_error(parts["link_placements"][k, i], placed) <= ROUNDING
            tip = pin.SE3(np.eye(3), np.array(POINT)).inverse().action @ J
            assert norm_error(robot.jacobian(q[k], link, POINT), tip) <= ROUNDING


@pytest.mark.one_in(2)
@pytest.mark.parametrize("axes", ["link", "base"])
@pytest.mark.parametrize("seed", range(3))
def test_a_wrench_takes_what_the_recursion_says_of_a_payload(seed: int, axes: Any) -> None:
    """At the link's origin the same; elsewhere, with the moment of the force about the origin; followers too."""
    robot = rttrr_pin.load(random_tree(seed, 6))
    q, v, a = drawn(robot)
    for link in robot.link_names:
        wrench = Wrench(FORCE, MOMENT, link, axes)
        without, with_it = (recursion(robot, q, v, a, payload).tau for payload in (None, wrench))
        size = np.linalg.norm(without) + np.linalg.norm(with_it) + np.linalg.norm([*FORCE, *MOMENT])
        assert np.linalg.norm(without + robot.wrench_torque(q, wrench) - with_it) <= ROUNDING * size
    R = robot.compile("link_placements")(q)[:, -1, :, :3]
    arm = R @ np.array(POINT) if axes == "base" else np.array(POINT)
    moved = Wrench(FORCE, np.array(MOMENT) + np.cross(arm, FORCE), link, axes)
    at_point = robot.wrench_torque(q, wrench, POINT)
    size = np.linalg.norm(robot.jacobian(q, link)) * np.linalg.norm([*FORCE, *MOMENT])
    assert np.linalg.norm(at_point - robot.wrench_torque(q, moved)) <= ROUNDING * size


@pytest.mark.parametrize("axes", ["link", "base"])
def test_torques_of_six_joints_tell_the_wrench(axes: Any) -> None:
    robot = rttrr_pin.load(random_tree(11, 7, ("revolute",), mimics=False))
    q = drawn(robot)[0]
    link = max(robot.link_names, key=lambda name: len(list(robot.model.path(robot.model.link_index(name)))))
    depth = len(list(robot.model.path(robot.model.link_index(link))))
    tau = robot.wrench_torque(q, Wrench(FORCE, MOMENT, link, axes), POINT)
    told = robot.wrench_from_torque(q, tau, link, POINT, axes)
    assert (told.rank == min(6, depth)).all()
    true = np.array([*FORCE, *MOMENT])
    found = np.concatenate([told.force, told.moment], axis=-1)
    sigma = np.linalg.svd(robot.jacobian(q, link, POINT, axes), compute_uv=False)
    condition = (sigma[:, 0] / sigma[:, min(6, depth) - 1]).max()
    seen = np.einsum("kij,j->ki", told.resolution, true)
    assert np.linalg.norm(found - seen) <= ROUNDING * condition * np.linalg.norm(seen)
    assert np.linalg.norm(told.residual) <= ROUNDING * np.linalg.norm(tau)


def test_what_the_joints_do_not_feel_is_told(rttrr: Robot) -> None:
    """Five joints cannot tell six components; what is found takes the same torques, and is no larger."""
    q = drawn(rttrr)[0]
    tau = rttrr.wrench_torque(q, Wrench(FORCE, MOMENT))
    told = rttrr.wrench_from_torque(q, tau)
    assert (told.rank == 5).all()
    assert norm_error(rttrr.wrench_torque(q, Wrench(told.force, told.moment)), tau) <= ROUNDING
    assert (np.linalg.norm(np.hstack([told.force, told.moment]), axis=1) <= np.linalg.norm([*FORCE, *MOMENT])).all()
    assert told.resolution.trace(axis1=-2, axis2=-1) == pytest.approx(told.rank)
    assert not np.allclose(told.resolution, np.eye(6))
    folded = rttrr.wrench_from_torque(np.zeros(5), np.zeros(5), "link_1")
    assert folded.rank == 1
    assert not folded.force.any()


def test_a_torque_that_no_wrench_explains_stays_as_residual(rttrr: Robot) -> None:
    told = rttrr.wrench_from_torque(np.full(5, 0.3), dict.fromkeys(rttrr.joint_names, 1.0), "link_1")
    np.testing.assert_allclose(told.residual, [0.0, 1.0, 1.0, 1.0, 1.0], rtol=0.0, atol=ROUNDING)


def test_batches_broadcast(rttrr: Robot) -> None:
    q = np.full((4, 1, 5), 0.2)
    assert rttrr.jacobian(q, point=np.ones((3, 3))).shape == (4, 3, 6, 5)
    torque = rttrr.wrench_torque(q, Wrench(np.ones((3, 3))))
    assert torque.shape == (4, 3, 5)
    told = rttrr.wrench_from_torque(q, torque)
    assert (told.force.shape, told.rank.shape, told.residual.shape) == ((4, 3, 3), (4, 1), (4, 3, 5))


def test_altered_robots_have_jacobians_too(rttrr: Robot) -> None:
    locked = rttrr.with_locked({"joint_2": 0.2}).with_payload_body(1.0)
    q = np.array([0.1, 0.3, 0.4, 0.5])
    whole = rttrr.jacobian([0.1, 0.2, 0.3, 0.4, 0.5], rttrr.link_names[-1])
    assert norm_error(locked.jacobian(q), np.delete(whole, 1, axis=-1)) <= ROUNDING


def test_what_it_refuses(rttrr: Robot) -> None:
    q = np.zeros(5)
    with pytest.raises(InputError, match="expected 'link' or 'base'"):
        rttrr.jacobian(q, expressed_in="world")  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match="no link"):
        rttrr.jacobian(q, "hand")
    with pytest.raises(ShapeError, match="point has 2 values"):
        rttrr.jacobian(q, point=(0, 0))
    with pytest.raises(ShapeError, match="tau has 4 values"):
        rttrr.wrench_from_torque(q, np.zeros(4))
    with pytest.raises(InputError, match="tolerance"):
        rttrr.wrench_from_torque(q, q, tolerance=-1.0)
