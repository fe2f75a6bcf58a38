"""Trajectories that are made: at rest at each pose, with v and a that are derivatives, within the limits of RTTRR."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.errors import RttrrError, UnknownNameError
from rttrr_pin.trajectories import Trajectory, named, pick_and_place, rest_to_rest, trajectory


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def arrays(motion: Trajectory) -> dict[str, np.ndarray]:
    blocks = list(motion.blocks())
    return {key: np.concatenate([getattr(own, key) for own in blocks]) for key in ("time", "q", "v", "a")}


def test_it_is_at_rest_at_each_pose_and_v_and_a_are_derivatives(arm: Robot) -> None:
    poses = np.random.default_rng(0).uniform(-0.1, 0.1, (4, 5))
    motion = rest_to_rest(arm, poses, [0.5, 1.0, 0.25], 400.0)
    got = arrays(motion)
    assert motion.n_rows == len(got["time"]) == 701
    at = np.searchsorted(got["time"], [0.0, 0.5, 1.5, 1.75])
    np.testing.assert_allclose(got["q"][at], poses, atol=1e-15)
    assert np.abs(got["v"][at]).max() < 1e-12 and np.abs(got["a"][at]).max() < 1e-9
    rate = np.gradient(got["q"], got["time"], axis=0)[1:-1]
    np.testing.assert_allclose(rate, got["v"][1:-1], atol=1e-3)
    within = np.setdiff1d(np.arange(1, 700), at)  # at a pose the jerk jumps
    np.testing.assert_allclose(np.gradient(got["v"], got["time"], axis=0)[within], got["a"][within], atol=0.05)
    by_name = [dict(zip(arm.joint_names, pose, strict=True)) for pose in poses]
    assert np.array_equal(arrays(rest_to_rest(arm, by_name, [0.5, 1.0, 0.25], 400.0))["q"], got["q"])


def test_an_end_between_two_rows_has_one_of_its_own(arm: Robot) -> None:
    got = arrays(rest_to_rest(arm, [np.zeros(5), np.full(5, 0.1)], 0.2501, 1000.0))
    assert got["time"][-1] == 0.2501 and np.array_equal(got["q"][-1], np.full(5, 0.1)) and len(got["time"]) == 252


def test_the_arm_carries_what_it_picked_and_stays_within_its_limits(arm: Robot) -> None:
    motion = pick_and_place(mass=2.0, cycles=2)
    blocks = list(motion.blocks(1000))
    assert not motion.findings and motion.model.name == "rttrr"
    force = np.concatenate([own.payload[0].f for own in blocks])
    carried = force.any(axis=1)
    assert np.count_nonzero(np.diff(carried)) == 4
    for own in blocks:  # the same as a robot that carries a body, where it does
        held = own.payload[0].f.any(axis=1)
        body = arm.with_payload_body(2.0, (0.0, 0.0, 0.05), np.eye(3) * 2.0 * 0.01 / 6, link="tool")
        wrench = Wrench(own.payload[0].f, own.payload[0].n, link="tool")
        tau = arm.inverse_dynamics(own.q, own.v, own.a, payload=wrench).tau
        np.testing.assert_allclose(tau[held], body.inverse_dynamics(own.q, own.v, own.a).tau[held], atol=1e-10)
        np.testing.assert_allclose(tau[~held], arm.inverse_dynamics(own.q, own.v, own.a).tau[~held], atol=1e-12)
        limits = np.array([joint.limits.effort for joint in arm.model.moving])
        assert (np.abs(tau) < limits).all()


def test_a_name_or_a_file(arm: Robot) -> None:
    assert named("pick-and-place", arm).n_rows == 7401
    with pytest.raises(UnknownNameError, match="no kind of trajectory is called"):
        named("pick-and-throw", arm)
    with pytest.raises(RttrrError, match="cutoff is for files"):
        named("pick-and-place", arm, cutoff=3.0)


def test_what_cannot_be_made_is_refused(arm: Robot) -> None:
    poses = np.zeros((2, 5))
    for poses_, durations, rate, message in (
        (poses[:1], 1.0, 100.0, "two or more"),
        (poses, [1.0, 1.0], 100.0, "expected 1 positive times"),
        (poses, -1.0, 100.0, "expected 1 positive times"),
        (poses, 1.0, 0.0, "rate is 0.0"),
        (np.zeros((2, 4)), 1.0, 100.0, "4 values on its last axis"),
    ):
        with pytest.raises(RttrrError, match=message):
            rest_to_rest(arm, poses_, durations, rate)
    with pytest.raises(RttrrError, match="has several coordinates"):
        rest_to_rest(rttrr_pin.load("trr", base="floating"), np.zeros((2, 10)), 1.0)
    with pytest.raises(RttrrError, match="is a trajectory of RTTRR, and 'trr' has other joints"):
        pick_and_place(rttrr_pin.load("trr"))


def test_one_row_is_a_trajectory(arm: Robot) -> None:
    (block,) = trajectory(arm, [0.0], *np.zeros((3, 1, 5))).blocks()
    assert len(block) == 1
