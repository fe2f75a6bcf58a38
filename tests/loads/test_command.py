"""The command `loads`: exit codes, what it prints and refuses, one sentence for each error."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.cli import main

NAMES = [f"joint_{k}" for k in range(1, 6)]
HEADER = ",".join(["time", *(f"{key}_{name}" for key in "qva" for name in NAMES)])


def write(path: Path, amplitude: float = 0.1, rows: int = 60) -> None:
    t = np.linspace(0.0, 1.0, rows)[:, None] + np.zeros(5)
    q, v, a = amplitude * np.sin(t), amplitude * np.cos(t), -amplitude * np.sin(t)
    lines = (",".join(map(repr, row)) for row in np.hstack([t[:, :1], q + 0.1, v, a]).tolist())
    path.write_text("\n".join([HEADER, *lines]) + "\n")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.urdf").write_text(rttrr_pin.load("rttrr").model.urdf)
    (tmp_path / "no_joint.urdf").write_text('<robot name="x"><link name="base"/></robot>')
    write(tmp_path / "run.csv", 0.05)
    write(tmp_path / "fast.csv", 9.0)
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "junk.csv").write_bytes(bytes(range(256)) * 20)
    (tmp_path / "lacking.csv").write_text("time,q_joint_1\n0,0\n1,0\n")
    (tmp_path / "gears.toml").write_text("[joint_1]\nratio = 100\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_within_the_limits_exits_0_and_beyond_them_1(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["loads", "arm.urdf", "run.csv"]) == 0
    assert capsys.readouterr().out.startswith("PASS within the limits; least margin ")
    assert main(["loads", "arm.urdf", "fast.csv"]) == 1
    assert capsys.readouterr().out.startswith("FAIL ")


def test_files_and_json_are_those_of_the_function(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--quantities", "tau, power", "-o", "loads.csv", "--load-cases", "cases.csv"]
    assert main(["loads", "arm.urdf", "run.csv", *words, "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    robot = rttrr_pin.load("arm.urdf")
    report = rttrr_pin.compute_loads(robot, "run.csv", quantities=("tau", "power"), output="own.csv")
    own = json.loads(json.dumps(report.to_dict()))
    for key in ("joints", "bearings", "states", "history"):
        assert data[key] == own[key]
    assert (desk / "loads.csv").read_text() == (desk / "own.csv").read_text()
    assert data["outputs"] == ["loads.csv", "cases.csv"] and (desk / "cases.csv").exists()


def test_a_body_and_a_wrench_are_carried(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def rms(*words: str) -> float:
        assert main(["loads", "arm.urdf", "run.csv", "--json", "-", *words]) in (0, 1)
        joints = json.loads(capsys.readouterr().out)["joints"]
        return float(joints[1]["tau"]["rms"])

    alone = rms()
    body = ("--payload-mass", "2", "--payload-com", "0,0,0.1", "--payload-inertia", "0.01,0,0,0.01,0,0.01")
    assert rms(*body) == pytest.approx(alone + 2 * 9.81, rel=0.02)
    assert rms("--payload", "0,0,19.62,0,0,0", "--payload-axes", "base") == pytest.approx(alone + 19.62, rel=1e-6)


REFUSED = {
    "no such file": (["no.csv"], "no.csv"),
    "no kind of file": (["arm.urdf"], "urdf"),
    "empty": (["empty.csv"], "empty"),
    "junk": (["junk.csv"], "junk.csv"),
    "joints that are not there": (["lacking.csv"], "lacking.csv"),
    "an input as output": (["run.csv", "-o", "run.csv"], "--output run.csv would overwrite the input"),
    "ratings as output": (["run.csv", "--ratings", "gears.toml", "--json", "gears.toml"], "would overwrite the input"),
    "two outputs in one": (["run.csv", "-o", "x.csv", "--json", "x.csv"], "both go to x.csv"),
    "no kind of output": (["run.csv", "-o", "x.xlsx"], "no kind of output is called '.xlsx'"),
    "no quantity": (["run.csv", "--quantities", "torque"], "no quantity is called 'torque'"),
    "a convention of nothing": (["run.csv", "-o", "x.csv", "--convention", "mujoco"], "--convention 'mujoco' says how"),
    "a convention that is none": (["run.csv", "--convention", "x"], "no convention is called 'x'"),
    "a random payload": (["run.csv", "--payload", "random"], "--payload is 'random': expected what it is"),
    "a body without mass": (["run.csv", "--payload-com", "0,0,1"], "--payload-com goes with a body"),
    "a mass that is none": (["run.csv", "--payload-mass", "heavy"], "--payload-mass is 'heavy'"),
    "a negative mass": (["run.csv", "--payload-mass", "-1"], "mass is -1"),
    "ratings that lack numbers": (["run.csv", "--ratings", "gears.toml"], "joint_1 lacks rated_torque"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_used_exits_2_with_one_sentence(
    case: str, desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words, message = REFUSED[case]
    before = sorted(desk.iterdir())
    assert main(["loads", "arm.urdf", *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and message in err and err.startswith("error: ") and err.count("\n") == 1
    assert sorted(desk.iterdir()) == before


def test_a_robot_without_joints_carries_nothing(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["loads", "no_joint.urdf", "run.csv"]) == 2
    assert "has no joint" in capsys.readouterr().err


def test_a_trajectory_in_place_of_the_robot_is_told_the_order(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["loads", "run.csv", "arm.urdf"]) == 2
    err = capsys.readouterr().err
    assert "the robot comes first: rttrr-pin loads arm.urdf run.csv" in err and err.count("\n") == 1


def test_a_run_that_is_stopped_leaves_nothing(
    desk: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(desk.iterdir())

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("rttrr_pin.loads.gathering.Gathered.envelope", stop)
    assert main(["loads", "arm.urdf", "run.csv", "-o", "x.csv", "--load-cases", "y.csv"]) == 130
    assert "nothing was written" in capsys.readouterr().err and sorted(desk.iterdir()) == before


Show = Callable[[list[str]], str]


@pytest.fixture
def shown(desk: Path, capsys: pytest.CaptureFixture[str]) -> Show:
    def show(words: list[str]) -> str:
        assert main(["loads", "arm.urdf", *words]) in (0, 1)
        return capsys.readouterr().out

    return show


def test_the_report_is_short_and_full_on_request(shown: Show) -> None:
    short, full = shown(["run.csv"]), shown(["run.csv", "--full"])
    assert len(short.splitlines()) < 20 and "joint_5" in short and "tool_joint" in short
    assert "peak tilting of joint_3" in full and "takes back" in full
    assert shown(["run.csv", "--quiet"]) == ""
