"""Several robots in one run: none is left out, and the verdicts are theirs."""

from __future__ import annotations

import json
import multiprocessing
import os
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.errors import InputError, UnknownNameError, UrdfError
from rttrr_pin.urdf.catalogue import robots_in
from rttrr_pin.validation import Task, validate_many
from support.serial_chains import EXAMPLES

BROKEN = '<robot name="x"><link name="a"><inertial><mass value="1,5"/></inertial></link></robot>'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("any-axes", "fixed-between"):
        (tmp_path / f"{name}.urdf").write_text(EXAMPLES[name])
    return tmp_path


@pytest.mark.slow
def test_every_robot_has_a_row_for_each_base(folder: Path) -> None:
    (folder / "broken.urdf").write_text(BROKEN)
    sources = {path.stem: path for path in sorted(folder.glob("*.urdf"))}
    entries = validate_many(sources, Task(n_states=30))
    assert [(entry.name, entry.base) for entry in entries] == [
        (name, base) for name in sources for base in ("fixed", "floating")
    ]
    assert [entry.verdict for entry in entries] == ["agree"] * 2 + ["unusable"] * 2 + ["agree"] * 2
    assert all("'1,5' is not a decimal number" in entry.defect for entry in entries if entry.name == "broken")
    assert all(entry.of_tolerance > 0 and entry.worst for entry in entries if entry.name != "broken")


@pytest.mark.slow
def test_errors_that_inspect_finds_are_counted(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """That two programs agree on a body does not mean that there can be one."""
    monkeypatch.setenv("COLUMNS", "100")
    text = (folder / "any-axes.urdf").read_text()
    (folder / "worse.urdf").write_text(text.replace('ixx="', 'ixx="9', 1))  # the triangle inequality
    assert main(["validate", str(folder), "--states", "5", "--subject", "recursion", "--json", str(folder / "x")]) == 0
    entries = json.loads((folder / "x").read_text())["entries"]
    wanted = {path.name: rttrr_pin.inspect(path).counts["error"] for path in folder.glob("*.urdf")}
    assert {entry["name"]: entry["errors"] for entry in entries} == wanted and wanted["worse.urdf"] > 0
    (row, _) = (line.split("│") for line in capsys.readouterr().out.splitlines() if "worse.urdf" in line)
    assert str(wanted["worse.urdf"]) in [cell.strip() for cell in row][-3:-1]


@pytest.mark.slow
def test_the_outcome_does_not_depend_on_the_workers(folder: Path) -> None:
    sources = {path.stem: path for path in sorted(folder.glob("*.urdf"))}
    outcomes = [
        [
            (entry.name, entry.base, entry.eps, entry.of_tolerance, entry.worst)
            for entry in validate_many(sources, Task(n_states=40), workers=workers)
        ]
        for workers in (1, 2)
    ]
    assert outcomes[0] == outcomes[1]


@pytest.mark.slow
def test_a_worker_that_is_killed_costs_one_robot(folder: Path) -> None:
    """As where memory runs out: what it was at is named, and all else goes on."""
    (folder / "more.urdf").write_text(EXAMPLES["one-joint"])
    sources = {path.stem: path for path in sorted(folder.glob("*.urdf"))}
    killed: list[int] = []

    def kill(done: int) -> None:
        if done == 1:
            for worker in multiprocessing.active_children():
                killed.append(worker.pid or 0)
                worker.kill()
                worker.join()

    entries = validate_many(sources, Task(n_states=2000), workers=2, progress=kill)
    assert [(entry.name, entry.base) for entry in entries] == [
        (name, base) for name in sources for base in ("fixed", "floating")
    ]
    lost = [entry for entry in entries if entry.verdict != "agree"]
    assert len(lost) < len(killed) == 2
    assert all("killed by signal 9: was memory short?" in entry.defect for entry in lost)
    assert not multiprocessing.active_children()


def test_a_folder_that_cannot_be_looked_into_is_told(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As for a user who may not; root may everything. What lies beside it is validated."""
    (folder / "shut").mkdir()
    scandir = os.scandir

    def scan(place: str) -> object:
        if Path(place).name == "shut":
            raise PermissionError(13, "Permission denied", str(place))
        return scandir(place)

    monkeypatch.setattr(os, "scandir", scan)
    assert list(robots_in(folder)) == ["any-axes.urdf", "fixed-between.urdf", "shut/"]
    with pytest.raises(UrdfError, match="shut: cannot be read: Permission denied"):
        rttrr_pin.load_all(folder)
    for name in ("any-axes", "fixed-between"):
        (folder / f"{name}.urdf").unlink()
    with pytest.raises(UrdfError, match="holds no robot, and shut/ cannot be read"):
        rttrr_pin.load(folder)
    assert main(["validate", str(folder / "shut")]) == 2
    assert "shut: cannot be read: Permission denied" in capsys.readouterr().err


def test_a_folder_as_large_as_a_disk_is_not_searched_through(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("rttrr_pin.urdf.catalogue.MOST_ENTRIES", 1)
    assert main(["validate", str(folder)]) == 2
    assert "holds more than 1 files and folders, of which 0 robots" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("task", "error", "message"),
    [
        (Task(n_states=0), InputError, "n_states is 0"),
        (Task(sampling="gauss"), UnknownNameError, "no sampling"),
        (Task(reference="bullet"), UnknownNameError, "no implementation"),
        (Task(packages={"x": "nowhere"}), InputError, "nowhere' is no folder"),
    ],
    ids=["states", "sampling", "reference", "packages"],
)
def test_what_is_wrong_for_all_is_said_once(folder: Path, task: Task, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        validate_many({"x": folder / "any-axes.urdf"}, task)


def test_a_folder_on_the_command_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["validate", str(folder), "--states", "20", "--subject", "recursion"]
    assert main(words) == 0
    out = capsys.readouterr().out
    assert "4 agree, 0 disagree, 0 stopped by their file, 4 in all" in out
    (folder / "broken.urdf").write_text(BROKEN)
    assert main([*words, "--json", "-"]) == 2
    data = json.loads(capsys.readouterr().out)
    assert data["verdicts"] == {"agree": 4, "disagree": 0, "unusable": 2}
    assert len(data["entries"]) == 6


@pytest.mark.parametrize(
    "words",
    [
        ["--payload", "random"],
        ["--gravity", "0,0,0"],
        ["--friction"],
        ["--base", "floating"],
        ["--full"],
    ],
    ids=lambda words: words[0],
)
def test_options_of_one_robot_are_refused(folder: Path, capsys: pytest.CaptureFixture[str], words: list[str]) -> None:
    assert main(["validate", str(folder), *words]) == 2
    assert f"{words[0]} goes with one robot" in capsys.readouterr().err


@pytest.mark.slow
def test_the_bundled_arms_all_agree(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", str(repository / "urdf"), "--states", "200"]) == 0
    files = len(list((repository / "urdf").rglob("*.urdf")))
    assert f"{2 * files} agree" in capsys.readouterr().out


def test_the_saved_run_accounts_for_all_example_robots(repository: Path) -> None:
    """69 files, two bases each, 10,000 states; what was not compared is named with its defect."""
    result = json.loads((repository / "benchmarks/results/example_robots.json").read_text())
    assert result["files"] == 69
    assert len(result["entries"]) == 138
    assert result["states"] == 10_000
    assert {entry["verdict"] for entry in result["entries"]} == {"agree", "unusable"}
    stopped = [entry for entry in result["entries"] if entry["verdict"] == "unusable"]
    without_joint = [entry for entry in stopped if "has no joint" in entry["defect"]]
    assert {entry["base"] for entry in without_joint} <= {"fixed"}  # one body: it agrees on its floating base
    assert all(", line " in entry["defect"] for entry in stopped if entry not in without_joint)
    assert len({entry["name"] for entry in stopped}) <= 3
    trees = json.loads((repository / "benchmarks/results/random_trees.json").read_text())
    assert trees["trees"] == 1000
    assert trees["disagree"] == []
    assert {"planar", "floating", "fixed", "prismatic", "revolute following"} <= set(trees["joint_types"])
