"""The command `conform`: what it refuses, what it writes, its exit codes."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from rttrr_pin.cli import main
from support.serial_chains import EXAMPLES

FAST = ["--levels", "gravity", "-n", "2"]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "my_arm.urdf").write_text(EXAMPLES["one-joint"])
    (tmp_path / "results.csv").write_text("q_joint_1,v_joint_1,a_joint_1,tau_joint_1\n1,2,3,4\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_all_files_are_written(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--json", "a.json", "--junit", "b.xml", "--html", "c.html", "--badge", "d.svg"]
    assert main(["conform", "recursion", *FAST, *words]) == 0
    assert "PASS level 1 of 14 (gravity)" in capsys.readouterr().out
    assert json.loads((desk / "a.json").read_text())["passed"] is True
    assert ElementTree.fromstring((desk / "b.xml").read_text())[0].get("tests") == "1"
    assert (desk / "c.html").read_text().startswith("<!doctype html>")
    assert (desk / "d.svg").read_text().startswith("<svg")


def test_what_fails_exits_1(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--levels", "gravity,rates", "-n", "2", "--no-diagnose"]
    assert main(["conform", "support.implementations:still", "my_arm.urdf", *words]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1].startswith("FAIL ") and ": 0 of 14 levels; failed: gravity, rates (" in lines[-1]


def test_robots_of_the_levels_have_names(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["conform", "recursion", "tree", "mimic", "--levels", "tree", "--levels", "mimic", "-n", "2"]) == 0
    assert "tree, mimic: 2 of 14 levels (tree, mimic)" in capsys.readouterr().out


@pytest.mark.parametrize("target", ["--json", "--junit", "--html", "--badge"])
def test_a_result_to_stdout_stands_alone(target: str, desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["conform", "recursion", *FAST, target, "-"]) == 0
    out = capsys.readouterr().out
    assert out[0] in "{<" and "level  " not in out


UNUSABLE = {
    "no program": (["pinochio"], "did you mean pinocchio"),
    "a table": (["results.csv"], "is a table, with states of its own"),
    "one robot": (["support.implementations:still"], "rttrr-pin conform SUBJECT ROBOT"),
    "no level": (["recursion", "--levels", "gravty"], "did you mean gravity"),
    "levels without a name": (["recursion", "--levels", ","], "--levels is ','"),
    "no states": (["recursion", "-n", "0"], "-n is 0"),
    "precision": (["recursion", "--precision", "float16"], "'float16' is not one of"),
    "badge": (["recursion", "--badge", "x.png"], "expected the name of a .svg or .json file"),
    "base": (["recursion", "--base", "floating"], "--base goes with robots of yours"),
    "twice": (["recursion", "--json", "-", "--badge", "-"], "both go to stdout"),
    "input": (["recursion", "my_arm.urdf", "--html", "my_arm.urdf"], "would overwrite the input"),
    "robot": (["recursion", "arm_6.urdf"], "arm_6.urdf"),
    "applies": (["recursion", "my_arm.urdf", "--levels", "sixty"], "no level applies"),
}


@pytest.mark.parametrize("case", UNUSABLE)
def test_what_cannot_be_used_exits_2_with_a_sentence(case: str, desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words, message = UNUSABLE[case]
    assert main(["conform", *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and message in err and "Traceback" not in err


def test_nothing_is_written_where_nothing_is_judged(desk: Path) -> None:
    assert main(["conform", "pinochio", "--json", "a.json", "--badge", "b.svg"]) == 2
    assert not (desk / "a.json").exists() and not (desk / "b.svg").exists()
