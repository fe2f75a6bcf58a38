"""The command `diagnose`: what it refuses, what it writes, and where `validate` names it."""

from __future__ import annotations

import io
import json
import shlex
import sys
from pathlib import Path

import pytest

from rttrr_pin import Wrench, load
from rttrr_pin.cli import main
from rttrr_pin.implementations import registry
from rttrr_pin.reporting import output
from support.serial_chains import EXAMPLES

NO_MASS = (
    '<robot name="x"><link name="base"/><link name="l"/><joint name="j" type="continuous"><parent link="base"/>'
    '<child link="l"/><axis xyz="0 1 0"/></joint></robot>'
)

NAMES = [f"{key}_joint_1" for key in ("q", "v", "a", "tau")]
HEADER = ",".join(NAMES)
ROW = "0.1,0.2,0.3"

ARM, STILL = "my arm.urdf", "support.implementations:still"

TABLES = {
    "empty": ("", "is empty: expected a header"),
    "a header only": (f"{HEADER}\n", "has a header and no row"),
    "no numbers": (f"{HEADER}\n{ROW},nan\n{ROW},nan\n", "no state has numbers"),
    "a joint that is not there": (f"{HEADER},tau_elbow\n{ROW},1,2\n", "no column is called 'tau_elbow'"),
    "no results": (f"q_joint_1,v_joint_1,a_joint_1\n{ROW}\n", "no column of results"),
    "a log without numbers": ("time,q_joint_1,tau_joint_1\n" + "0.1,nan,nan\n" * 60, "error: "),
    "a log of one row": (f"time,q_joint_1,tau_joint_1\n{ROW}\n", "error: "),
    "a log of no row": ("time,q_joint_1,tau_joint_1\n", "error: "),
}


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a robot whose name has a blank."""
    (tmp_path / ARM).write_text(EXAMPLES["one-joint"])
    (tmp_path / "no_joint.urdf").write_text('<robot name="x"><link name="base"/></robot>')
    (tmp_path / "no_mass.urdf").write_text(NO_MASS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("case", TABLES)
def test_a_table_that_cannot_be_used_exits_2_with_one_sentence(
    case: str, desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, message = TABLES[case]
    (desk / "results.csv").write_text(text)
    assert main(["diagnose", ARM, "results.csv"]) == 2
    out, err = capsys.readouterr()
    assert out == "" and message in err and err.count("\n") == 1


@pytest.mark.parametrize(("robot", "message"), [("no_joint", "has no joint"), ("no_mass", "nothing was compared")])
def test_a_robot_that_has_nothing_to_diagnose_exits_2(
    robot: str, message: str, desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["diagnose", f"{robot}.urdf", "--subject", "recursion"]) == 2
    out, err = capsys.readouterr()
    assert out == "" and message in err and err.count("\n") == 1


@pytest.mark.parametrize("words", [[ARM], []])
def test_a_table_in_place_of_the_robot_is_told_the_order(
    words: list[str], desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (desk / "results.csv").write_text(f"{HEADER}\n{ROW},1000\n")
    assert main(["diagnose", "results.csv", *words]) == 2
    out, err = capsys.readouterr()
    line = shlex.join(["rttrr-pin", "diagnose", *(words or ["ROBOT"]), "results.csv"])
    assert out == "" and err.endswith(f"the robot comes first: {line}\n") and err.count("\n") == 1


@pytest.mark.slow
def test_a_payload_beside_a_table_is_taken_and_told_or_refused(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A wrench is that of its results, as `validate` takes it; none is drawn for states that are there already."""
    (desk / "results.csv").write_text(f"{HEADER}\n{ROW},1000\n")
    words = ["diagnose", ARM, "results.csv", "--payload"]
    assert main([*words, "random"]) == 2
    assert "no random payload" in capsys.readouterr().err
    robot = load(ARM)
    tau = robot.inverse_dynamics([0.1], [0.2], [0.3], payload=Wrench(force=[1, 2, 3], moment=[4, 5, 6])).tau[0]
    (desk / "results.csv").write_text(f"{HEADER}\n{ROW},{float(tau)!r}\n")
    assert main([*words, "1,2,3,4,5,6"]) == 0
    assert "[1.0, 2.0, 3.0]" in capsys.readouterr().out
    assert main(words[:-1]) == 1
    (desk / "results.csv").write_text("time,q_joint_1,tau_joint_1\n" + "".join(f"{k},{k},0\n" for k in range(60)))
    assert main([*words, "1,2,3,4,5,6"]) == 2
    assert "--payload" in capsys.readouterr().err


def test_a_table_of_one_row_is_diagnosed(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tau = load(desk / ARM).inverse_dynamics([0.1], [0.2], [0.3]).tau[0]
    (desk / "results.csv").write_text(f"{HEADER}\n{ROW},{-tau}\n")
    assert main(["diagnose", ARM, "results.csv"]) == 1
    assert "1 state of the table" in capsys.readouterr().out


def test_json_alone_or_nothing_is_printed(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", ARM, "--subject", STILL, "--states", "20", "--json", "-"]) == 1
    out, err = capsys.readouterr()
    data = json.loads(out)
    assert err == "" and data["verdict"] == "explained" and data["residual_after"] <= 1.0 < data["residual_before"]
    assert {"hypothesis", "link", "joint", "sentence", "values"} <= set(data["causes"][0])
    assert main(["diagnose", ARM, "--subject", STILL, "--states", "20", "-q"]) == 1
    assert capsys.readouterr() == ("", "")


def test_hypotheses_are_counted_without_a_total(monkeypatch: pytest.MonkeyPatch) -> None:
    """How many there are, and in how many sets they are tried, the search knows when it ends."""

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(output, "SHOW_PROGRESS_AFTER", 0.0)
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    monkeypatch.setenv("TERM", "xterm")
    with output.progress(None, False, "hypotheses") as advance:
        advance(4321)
    assert "4,321 hypotheses" in terminal.getvalue() and " of " not in terminal.getvalue()


@pytest.mark.one_in(2)
@pytest.mark.parametrize("program", ["wrong", "results.csv"])
def test_validate_names_the_command_that_says_why(
    program: str, desk: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the same robot, programs and reading of the file; it runs as it stands."""
    monkeypatch.setitem(registry.BUILT_IN, "wrong", "support.implementations:Double")
    (desk / "results.csv").write_text(f"{HEADER}\n{ROW},1000\n")
    given = {"wrong": ["--gravity", "0,0,-1.6", "--base", "floating"], "results.csv": ["--lenient"]}[program]
    words = ["validate", ARM, "--subject", program, "--states", "20", "--seed", "3", *given]
    assert main(words) == 1
    line = capsys.readouterr().out.splitlines()[-1]
    assert line.startswith("why: rttrr-pin diagnose ")
    command = shlex.split(line.removeprefix("why: rttrr-pin "))
    subject = ["results.csv"] if program == "results.csv" else ["--subject", program]
    assert command == ["diagnose", ARM, *subject, "--reference", "pinocchio", *given]
    assert main([*command, "-q"]) == 1


def test_validate_of_what_agrees_or_of_several_robots_names_none(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (desk / "no_joint.urdf").unlink()
    (desk / "no_mass.urdf").unlink()
    for robot in (ARM, "."):
        main(["validate", robot, "--states", "5", "--subject", "recursion"])
        assert "why:" not in capsys.readouterr().out
