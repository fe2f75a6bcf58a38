"""Blocks of a trajectory: their numbers do not depend on their size, and what is wrong is an error or a finding."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.errors import InputError, ShapeError
from rttrr_pin.trajectories import Block, read_trajectory, trajectory
from support.logs import excitation, write_log


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def whole(blocks: list[Block]) -> dict[str, np.ndarray]:
    return {key: np.concatenate([getattr(own, key) for own in blocks]) for key in ("rows", "time", "q", "v", "a")}


@pytest.mark.parametrize("size", [1, 7, 4096, 10**6])
def test_arrays_come_back_in_blocks(arm: Robot, size: int) -> None:
    t = np.arange(0.0, 2.0, 1e-3)
    q, v, a = excitation(arm.model, t, 1)
    wrench = Wrench(np.outer(t, [1.0, 2.0, 3.0]), (0.0, 0.0, 1.0), link="tool")
    blocks = list(trajectory(arm, t, q, v, a, payload=wrench).blocks(size))
    got = whole(blocks)
    for key, x in {"time": t, "q": q, "v": v, "a": a}.items():
        assert np.array_equal(got[key], x)
    assert [own.start for own in blocks] == np.cumsum([0, *map(len, blocks)])[:-1].tolist()
    assert max(map(len, blocks)) <= size
    assert np.array_equal(np.concatenate([own.payload[0].f for own in blocks]), wrench.force)


def test_a_csv_gives_the_numbers_that_it_has(arm: Robot, tmp_path: Path) -> None:
    path = write_log(tmp_path / "x.csv", arm, seconds=1.0, columns="va", of_q=0.0)
    read = read_trajectory(path, arm)
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    got = whole(list(read.blocks(100)))
    assert np.array_equal(np.hstack([got["time"][:, None], got["q"], got["v"], got["a"]]), table[:, :16])
    assert np.array_equal(got["rows"], np.arange(2, len(table) + 2)) and not read.findings
    assert read.notes == ("columns not read: tau_joint_1, tau_joint_2, tau_joint_3, tau_joint_4, tau_joint_5",)


def test_arrays_of_other_lengths_are_refused(arm: Robot) -> None:
    with pytest.raises(ShapeError, match=r"q has shape \(3, 5\), expected \(2, 5\)"):
        trajectory(arm, [0.0, 1.0], np.zeros((3, 5)), np.zeros((2, 5)), np.zeros((2, 5)))
    with pytest.raises(InputError, match="row 1, column time: it goes back by 1"):
        list(trajectory(arm, [1.0, 0.0], *np.zeros((3, 2, 5))).blocks())
