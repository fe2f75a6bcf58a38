"""Outputs never overwrite an input or each other, and one that cannot be written is refused before the work is done."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.reporting.files import write_whole

Command = Callable[[Path, str], list[str]]

WRITING: dict[str, Command] = {
    "validate": lambda robot, out: ["validate", str(robot), "--json", out],
    "validate a folder": lambda robot, out: ["validate", str(robot.parent), "--json", out],
    "state": lambda robot, out: ["state", str(robot), "--json", out],
    "search": lambda robot, out: ["search", str(robot), "--json", out],
    "laws": lambda robot, out: ["laws", str(robot), "--json", out],
    "sample": lambda robot, out: ["sample", str(robot), "-o", out],
    "compare": lambda robot, out: ["compare", str(robot), "rttrr", "--json", out],
    "compare another": lambda robot, out: ["compare", "rttrr", str(robot), "--json", out],
    "compare, a page": lambda robot, out: ["compare", str(robot), "rttrr", "--html", out],
    "diagnose": lambda robot, out: ["diagnose", str(robot), "--subject", "recursion", "--json", out],
    "diagnose, a page": lambda robot, out: ["diagnose", str(robot), "--subject", "recursion", "--html", out],
    "loads": lambda robot, out: ["loads", str(robot), "run.csv", "-o", out],
    "loads, cases": lambda robot, out: ["loads", str(robot), "run.csv", "--load-cases", out],
    "inspect": lambda robot, out: ["inspect", str(robot), "--json", out],
    "derive": lambda robot, out: ["derive", str(robot), "--latex", out],
    "audit": lambda robot, out: ["audit", str(robot), "--html", out],
}


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    folder = tmp_path / "robots"
    folder.mkdir()
    (folder / "other.urdf").write_text(rttrr_pin.load("trr").model.urdf)
    file = folder / "arm.urdf"
    file.write_text(rttrr_pin.load("rttrr").model.urdf)
    return file


@pytest.fixture(autouse=True)
def no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Loading or reading anything would be work before the refusal."""

    def work(*_: object, **__: object) -> None:
        pytest.fail("the work began before the outputs were checked")

    for name in ("validation.options.load", "inspection.command.find", "derivation.command.load"):
        monkeypatch.setattr(f"rttrr_pin.{name}", work)
    monkeypatch.setattr("rttrr_pin.auditing.command.read_publication", work)


@pytest.mark.parametrize("command", WRITING)
@pytest.mark.parametrize("spelling", ["same", "dots", "link", "hard link"])
def test_an_input_is_not_overwritten(
    command: str, spelling: str, robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = robot.read_bytes()
    other = tmp_path / "other_name"
    if spelling == "link":
        other.symlink_to(robot)
    elif spelling == "hard link":
        os.link(robot, other)
    out = {"same": robot, "dots": robot.parent / ".." / "robots" / robot.name}.get(spelling, other)
    assert main(WRITING[command](robot, str(out))) == 2
    assert "would overwrite the input" in capsys.readouterr().err
    assert robot.read_bytes() == before


@pytest.mark.parametrize("command", WRITING)
@pytest.mark.parametrize("out", ["missing/out", "robots", "n" * 300, "nul\0"])
def test_an_output_that_cannot_be_written_is_refused_first(
    command: str, out: str, robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(WRITING[command](robot, str(tmp_path / out))) == 2
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["audit", "--html", "{0}", "--markdown", "{0}"],
        ["audit", "--json", "-", "--latex", "-"],
        ["derive", "--latex", "{0}", "--markdown", "{1}"],
        ["inspect", "--json", "{0}", "--fix", "{1}"],
    ],
)
def test_two_outputs_do_not_share_a_file(words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = (str(tmp_path / "out"), str(tmp_path / "." / "x" / ".." / "out"))
    (tmp_path / "x").mkdir()
    assert main([word.format(*names) for word in words]) == 2
    assert "both go to" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_file_that_is_replaced_keeps_its_mode(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("before")
    file.chmod(0o640)
    write_whole(file, "after")
    assert (file.read_text(), stat.S_IMODE(file.stat().st_mode)) == ("after", 0o640)
