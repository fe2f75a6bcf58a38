"""Folders of robots; demands of parsers; SARIF and JUnit."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any
from urllib.parse import unquote_to_bytes
from xml.etree import ElementTree

import pytest

from rttrr_pin.cli import main
from rttrr_pin.inspection import CHECKS, PARSERS
from support.inspected import arm, diagonal, inertial

IMPOSSIBLE = arm(inertial(1, diagonal(1, 1, 3)))

ROBOTS = {"good.urdf": arm(), "bad.urdf": IMPOSSIBLE, "deep/none.urdf": "<robot/>"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in ROBOTS.items():
        (tmp_path / "robots" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "robots" / name).write_text(text)
    return tmp_path / "robots"


def test_a_folder_is_a_table(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(folder)]) == 1
    out = capsys.readouterr().out
    verdicts = {line.split()[0]: line.split()[1] for line in out.splitlines() if ".urdf  " in line}
    assert verdicts == {"bad.urdf": "FAIL", "deep/none.urdf": "FILE", "good.urdf": "PASS"}
    assert "1 pass, 1 fail, 1 cannot be read, 3 in all" in out


@pytest.mark.parametrize(
    ("left", "words", "code"),
    [
        (["good.urdf", "deep/none.urdf"], [], 2),
        (["good.urdf", "bad.urdf"], ["--ignore", "P"], 0),
        (["good.urdf", "bad.urdf"], ["--ignore", "P", "--fail-on", "drake"], 1),
        (["good.urdf", "bad.urdf"], ["--fix", "x.urdf"], 2),
        (["good.urdf", "bad.urdf"], ["--select", "X"], 2),
        (["good.urdf", "bad.urdf"], ["--json", "FOLDER/good.urdf"], 2),
    ],
)
def test_exit_codes_of_folders(
    folder: Path, left: list[str], words: list[str], code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ROBOTS.keys() - set(left):
        (folder / name).unlink()
    assert main(["inspect", str(folder), *(word.replace("FOLDER", str(folder)) for word in words)]) == code
    assert bool(capsys.readouterr().out) == (code != 2 or not words)


def test_a_folder_as_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(folder), "--json", "-"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert data["counts"] == {"PASS": 1, "FAIL": 1, "FILE": 1}
    by_name = {robot["name"]: robot for robot in data["robots"]}
    assert by_name["bad.urdf"]["inspection"]["findings"][0]["id"] == "P105"
    assert "inspection" not in by_name["deep/none.urdf"] and by_name["deep/none.urdf"]["defect"]


def test_a_parser_may_be_demanded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(arm(more='<mimic joint="other"/>', extra=ROBOT_MORE))
    assert main(["inspect", str(path)]) == 0
    assert main(["inspect", str(path), "--fail-on", "yourdfpy"]) == 0
    capsys.readouterr()
    assert main(["inspect", str(path), "--fail-on", "KDL"]) == 1
    assert "FAIL KDL" in capsys.readouterr().out
    assert main(["inspect", str(path), "--fail-on", "Webots"]) == 2


ROBOT_MORE = (
    f'<link name="tip">{inertial()}</link><joint name="other" type="continuous"><parent link="base"/>'
    '<child link="tip"/><axis xyz="0 0 1"/></joint>'
)


def test_sarif_names_files_lines_and_rules(folder: Path) -> None:
    out = folder.parent / "found.sarif"
    assert main(["inspect", str(folder), "-q", "--sarif", str(out), "--fail-on", "Drake"]) == 1
    data = json.loads(out.read_text())
    (run,) = data["runs"]
    rules = {rule["id"]: rule for rule in run["tool"]["driver"]["rules"]}
    assert data["version"] == "2.1.0" and set(rules) > {check.id for check in CHECKS}
    assert all(result["ruleId"] in rules for result in run["results"])
    assert {result["level"] for result in run["results"]} <= {"error", "warning", "note"}
    found = {(Path(place(result)["artifactLocation"]["uri"]).name, result["ruleId"]) for result in run["results"]}
    assert found == {("bad.urdf", "P105"), ("bad.urdf", "drake-inertia"), ("none.urdf", "file")}
    assert next(place(result) for result in run["results"] if result["ruleId"] == "P105")["region"]["startLine"] == 1


def place(result: dict[str, Any]) -> Any:
    return result["locations"][0]["physicalLocation"]


def test_junit_has_a_test_for_each_check_and_parser(folder: Path) -> None:
    out = folder.parent / "found.xml"
    assert main(["inspect", str(folder), "-q", "--junit", str(out), "--fail-on", "Drake"]) == 1
    suites = {suite.get("name"): suite for suite in ElementTree.parse(out).getroot()}
    assert len(suites["good.urdf"]) == len(CHECKS) + len(PARSERS)
    failed = {name: [failure_of(test) for test in suite if failure_of(test)] for name, suite in suites.items()}
    assert failed == {"bad.urdf": ["P105", "Drake"], "deep/none.urdf": ["file"], "good.urdf": []}
    assert (suites["bad.urdf"].get("failures"), suites["deep/none.urdf"].get("errors")) == ("2", "1")


ODD = (b"\xff", b"\x01\x1b[2J", b"<&>\"'", b"50%#?", b"a b", b"line\nend", "\u202e\ufffe".encode())
"""What names of files may hold, before `.urdf`."""


def test_names_of_files_leave_sarif_and_junit_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for k, name in enumerate(ODD):
        (tmp_path / os.fsdecode(name + b".urdf")).write_text((arm(), IMPOSSIBLE, "<robot/>")[k % 3])
    monkeypatch.chdir(tmp_path)
    assert main(["inspect", ".", "-q", "--sarif", "s.sarif", "--junit", "j.xml", "--json", "j.json"]) == 1
    assert len(ElementTree.parse("j.xml").getroot()) == len(ODD)
    (run,) = json.loads(Path("s.sarif").read_text(encoding="utf-8"))["runs"]
    named = {unquote_to_bytes(place(result)["artifactLocation"]["uri"]) for result in run["results"]}
    assert named == {name + b".urdf" for k, name in enumerate(ODD) if k % 3}


REQUIRED = {
    "testsuite": {"name", "tests", "failures", "errors", "time"},
    "testcase": {"name", "classname", "time"},
    "failure": {"type", "message"},
    "error": {"type", "message"},
}
ALLOWED = REQUIRED | {"testsuite": REQUIRED["testsuite"] | {"file"}}
"""Attributes of JUnit's XML by the schemas of Jenkins (xunit plugin) and Ant."""


def test_junit_keeps_to_the_schemas(folder: Path) -> None:
    out = folder.parent / "found.xml"
    assert main(["inspect", str(folder), "-q", "--junit", str(out), "--strict", "--fail-on", "Drake"]) == 1
    elements = list(ElementTree.parse(out).getroot().iter())
    assert {element.tag for element in elements} >= REQUIRED.keys()
    for element in elements:
        if element.tag in REQUIRED:
            assert REQUIRED[element.tag] <= set(element.keys()) <= ALLOWED[element.tag]


def failure_of(test: ElementTree.Element) -> str:
    """The first word of the name of a test that failed."""
    failed = test.find("failure") is not None or test.find("error") is not None
    return (test.get("name") or "").split()[0] if failed else ""


def test_one_robot_as_sarif_and_junit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "arm.urdf", tmp_path / "arm.xml"
    path.write_text(IMPOSSIBLE)
    assert main(["inspect", str(path), "--sarif", "-", "--junit", str(out)]) == 1
    assert json.loads(capsys.readouterr().out)["runs"][0]["results"][0]["ruleId"] == "P105"
    assert ElementTree.parse(out).getroot()[0].get("failures") == "1"
    assert main(["inspect", str(path), "--sarif", str(out), "--junit", str(out)]) == 2
