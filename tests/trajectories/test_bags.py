"""Bags: joints in any order and of several publishers, the only topic or the one that is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.errors import InputError, RttrrError, UnknownNameError
from rttrr_pin.trajectories import Trajectory, read_trajectory
from support.bags import NANO, Sent, path, state, write_bag
from support.logs import excitation

BEGIN = 1_764_345_600 * NANO

STEP = 4_000_000

COUNT = 200

T = np.arange(COUNT) * STEP / NANO


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def states(arm: Robot, begin: int = BEGIN, topic: str = "/joint_states", stamped: bool = True) -> list[Sent]:
    """In another order, with a joint that the robot has not, and a fixed one."""
    names = [*arm.joint_names[::-1], "gripper", "tool_joint"]
    q, v, _ = excitation(arm.model, T, 3)
    pad = np.zeros((COUNT, 2))
    q, v = np.hstack([q[:, ::-1], pad]), np.hstack([v[:, ::-1], pad])
    stamp = None if stamped else 0
    return [state(topic, begin + k * STEP, names, q[k], v[k], stamp) for k in range(COUNT)]


def arrays(motion: Trajectory) -> dict[str, np.ndarray]:
    blocks = list(motion.blocks(50))
    return {key: np.concatenate([getattr(own, key) for own in blocks]) for key in ("rows", "time", "q", "v", "a")}


@pytest.mark.parametrize("name", ["x.mcap", "x.db3", "x.bag"])
def test_joint_states_are_rows(arm: Robot, tmp_path: Path, name: str) -> None:
    motion = read_trajectory(write_bag(tmp_path / name, states(arm)), arm)
    got = arrays(motion)
    np.testing.assert_allclose(got["time"], T, rtol=1e-12)
    assert np.array_equal(got["rows"], np.arange(1, COUNT + 1))
    q, v, a = excitation(arm.model, T, 3)
    assert np.array_equal(got["q"], q)
    np.testing.assert_allclose(got["v"], v, atol=1e-5)  # of the spline that a is derived from
    np.testing.assert_allclose(got["a"], a, atol=0.01)
    assert motion.notes == ("time counts from 1764345600.000000000 s",)
    assert [(own.kind, own.column, own.count) for own in motion.findings] == [("unknown joint", "gripper", COUNT)]


def test_messages_without_stamps_have_the_time_at_which_they_were_written(arm: Robot, tmp_path: Path) -> None:
    motion = read_trajectory(write_bag(tmp_path / "x.mcap", states(arm, begin=0, stamped=False)), arm)
    np.testing.assert_allclose(arrays(motion)["time"], T, atol=1e-12)
    assert motion.notes == ("headers have no stamp: time is when messages were written",)


@pytest.mark.parametrize("apart", [STEP, 2 * STEP])
def test_several_publishers_are_taken_together(arm: Robot, tmp_path: Path, apart: int) -> None:
    """Two joints come later than the others, or half as often: a straight line, so that nothing is lost between two."""
    rate = np.array([0.1, 0.05, -0.02, 0.3, -0.2])
    first, second = list(arm.joint_names[1:4]), [arm.joint_names[4], arm.joint_names[0]]
    sent = [state("/js", BEGIN + k * STEP, first, rate[1:4] * T[k]) for k in range(COUNT)]
    for t in range(BEGIN + STEP // 3, BEGIN + COUNT * STEP, apart):
        sent.append(state("/js", t, second, rate[[4, 0]] * (t - BEGIN) / NANO))
    motion = read_trajectory(write_bag(tmp_path / "x.mcap", sorted(sent, key=lambda own: own[2])), arm)
    got = arrays(motion)
    np.testing.assert_allclose(got["q"], np.outer(got["time"], rate), atol=1e-9)
    assert len(got["time"]) >= COUNT - 3
    assert "joint_1, joint_5 come in messages of their own" in motion.notes[-1]
    (finding,) = motion.findings
    assert finding.kind == "incomplete" and finding.count == COUNT - len(got["time"])


def test_an_angle_between_two_messages_goes_the_shorter_way(arm: Robot, tmp_path: Path) -> None:
    first, second = list(arm.joint_names[1:]), [arm.joint_names[0]]
    angle = 3.0 + 0.5 * T
    sent = [state("/js", BEGIN + k * STEP, first, np.zeros(4)) for k in range(COUNT)]
    wrapped = np.angle(np.exp(1j * (angle + 0.5 * STEP / 2 / NANO)))
    sent += [state("/js", BEGIN + k * STEP + STEP // 2, second, wrapped[[k]]) for k in range(COUNT)]
    motion = read_trajectory(write_bag(tmp_path / "x.mcap", sorted(sent, key=lambda own: own[2])), arm)
    got = arrays(motion)
    np.testing.assert_allclose(got["q"][:, 0], 3.0 + 0.5 * got["time"], atol=1e-6)


def test_incomplete_messages_are_left_out_where_others_are_whole(arm: Robot, tmp_path: Path) -> None:
    sent = states(arm)
    sent[7] = state("/joint_states", sent[7][2], ["joint_1"], [0.0], [0.0])
    motion = read_trajectory(write_bag(tmp_path / "x.mcap", sent), arm)
    assert len(arrays(motion)["time"]) == COUNT - 1
    assert {own.kind: own.row for own in motion.findings}["incomplete"] == 8


def test_several_topics_are_listed_and_one_is_chosen_by_name(arm: Robot, tmp_path: Path) -> None:
    sent = sorted(states(arm, topic="/a") + states(arm, topic="/b"), key=lambda own: own[2])
    bag = write_bag(tmp_path / "x.mcap", sent)
    with pytest.raises(InputError, match=r"/a \(200 of JointState\), /b \(200 of JointState\): pass topic='/a'"):
        read_trajectory(bag, arm)
    assert len(arrays(read_trajectory(bag, arm, topic="/b"))["time"]) == COUNT
    with pytest.raises(UnknownNameError, match="no topic is called '/c'"):
        read_trajectory(bag, arm, topic="/c")


def test_joints_that_no_message_has_are_named(arm: Robot, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "x.mcap", [state("/js", BEGIN, ["joint_1", "joint_2"], [0.0, 0.0])])
    with pytest.raises(InputError, match="no message has a position of joint_3, joint_4, joint_5"):
        read_trajectory(bag, arm)
    bag = write_bag(tmp_path / "y.mcap", [state("/js", BEGIN, arm.joint_names, [0.0, 0.0])])
    with pytest.raises(InputError, match="message 1: 2 positions of 5 joints"):
        read_trajectory(bag, arm)


def test_points_of_trajectories_are_rows_until_the_next_one_begins(arm: Robot, tmp_path: Path) -> None:
    q, v, a = excitation(arm.model, T, 3)
    order = [2, 0, 1, 4, 3]
    names = [arm.joint_names[k] for k in order]

    def points(rows: range) -> list[tuple[int, np.ndarray, np.ndarray, np.ndarray]]:
        return [((k - rows[0]) * STEP, q[k, order], v[k, order], a[k, order]) for k in rows]

    sent = [
        path("/path", BEGIN, names, points(range(120))),
        path("/path", BEGIN + 80 * STEP, names, points(range(80, COUNT))),
    ]
    motion = read_trajectory(write_bag(tmp_path / "x.mcap", sent), arm)
    got = arrays(motion)
    np.testing.assert_allclose(got["time"], T, atol=1e-12)
    for key, x in {"q": q, "v": v, "a": a}.items():
        assert np.array_equal(got[key], x)
    assert {own.kind: own.count for own in motion.findings} == {"replaced": 40}
    assert next(motion.blocks()).errors is None


def test_bags_that_are_none_are_errors_of_ours(arm: Robot, tmp_path: Path) -> None:
    whole = write_bag(tmp_path / "x.mcap", states(arm)).read_bytes()
    for name in ("y.mcap", "y.bag", "y.db3"):
        for data in (b"", b"junk", whole[: len(whole) // 2], whole[:-40]):
            (tmp_path / name).write_bytes(data)
            with pytest.raises(RttrrError):
                list(read_trajectory(tmp_path / name, arm).blocks())
    with pytest.raises(RttrrError, match="does not exist"):
        read_trajectory(tmp_path / "none.mcap", arm)
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "metadata.yaml").write_text("rosbag2_bagfile_information: 3")
    with pytest.raises(RttrrError, match="cannot be read as a bag"):
        read_trajectory(tmp_path / "folder", arm)
    with pytest.raises(RttrrError, match="root_joint' has several coordinates"):
        read_trajectory(tmp_path / "x.mcap", rttrr_pin.load("rttrr", base="floating"))
    (tmp_path / "x.csv").write_text("time\n0\n")
    with pytest.raises(RttrrError, match="topic is for bags"):
        read_trajectory(tmp_path / "x.csv", arm, topic="/a")
