"""What is refused before anything is served."""

from __future__ import annotations

import socket
import sys
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin import InputError
from rttrr_pin.cli import main
from rttrr_pin.viewing import state_of
from support.viewed import MASSLESS


@pytest.fixture
def without_viser(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)


def test_a_missing_library_is_said(without_viser: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", "rttrr"]) == 2
    error = capsys.readouterr().err
    assert "pip install 'rttrr-pin[view]'" in error and len(error.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--q", "1,2"], "--q is '1,2': expected 5 numbers"),
        (["--q", "1,2,3,4,nan"], "--q is"),
        (["--payload", "random"], "expected six numbers"),
        (["--subject", "nope"], "nope"),
        (["nowhere.csv"], "nowhere.csv"),
        (["--worst"], "the worst state is one of a trajectory"),
        (["--html", "/nowhere/x.html"], "--html /nowhere/x.html cannot be written"),
        (["--port", "70000"], "70000"),
    ],
)
def test_words_that_cannot_be_used(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", "rttrr", *words]) == 2
    captured = capsys.readouterr()
    assert said in captured.err and "Traceback" not in captured.err and not captured.out


def test_a_port_in_use(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        assert main(["view", "rttrr", "--port", str(port)]) == 2
    assert f"--port {port} of this machine cannot be had" in capsys.readouterr().err


def test_html_does_not_overwrite_what_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "r.urdf").write_text(MASSLESS)
    (tmp_path / "t.csv").write_text("time,q_j\n0,0\n1,1\n")
    for name in ("r.urdf", "t.csv"):
        before = (tmp_path / name).read_text()
        assert main(["view", str(tmp_path / "r.urdf"), str(tmp_path / "t.csv"), "--html", str(tmp_path / name)]) == 2
        assert "would overwrite the input" in capsys.readouterr().err
        assert (tmp_path / name).read_text() == before


def test_a_state_by_joint_name() -> None:
    robot = rttrr_pin.load("rttrr")
    state = state_of(robot, q=dict.fromkeys(robot.joint_names, 0.1))
    assert state.q.tolist() == [0.1] * 5 and not state.v.any()
    with pytest.raises(InputError, match="batch axis"):
        state_of(robot, q=[[0.0] * 5] * 2)


def test_importing_the_command_loads_no_viser() -> None:
    import subprocess

    code = "import rttrr_pin.viewing.command, sys; assert not {'viser', 'trimesh', 'scipy'} & {*sys.modules}"
    subprocess.run([sys.executable, "-c", code], check=True)
