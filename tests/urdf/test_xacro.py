"""xacro files are programs: none is run that was not asked for, and what is passed to them arrives."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.errors import InputError, UrdfError

ARM = """<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="mass" default="${{{default}}}"/>
  <link name="base"/>
  <link name="arm"><inertial><mass value="$(arg mass)"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>
"""

RUNS_A_PROGRAM = (
    "(lambda: [c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0]"
    ".__init__.__globals__['system']('touch {0}'))() + 1"
)
"""An expression that leaves a file behind, and is 1."""

AUDIT = """
title = "An arm"
language = "python"
[robot]
urdf = "arm.xacro"
[[equation]]
number = 1
quantity = "tau"
joint = 1
python = ["0.1 * qdd1"]
"""


@pytest.fixture
def marker(tmp_path: Path) -> Path:
    return tmp_path / "it_ran"


@pytest.fixture
def folder(tmp_path: Path, marker: Path) -> Path:
    """An arm whose file runs a program, beside one that does not, and a publication that names it."""
    place = tmp_path / "robots"
    place.mkdir()
    (place / "arm.xacro").write_text(ARM.format(default=RUNS_A_PROGRAM.format(marker)))
    (place / "arm.urdf").write_text(rttrr_pin.load("rttrr").model.urdf)
    (place / "paper.toml").write_text(AUDIT)
    return place


COMMANDS: dict[str, Callable[[Path], list[str]]] = {
    "validate": lambda folder: ["validate", f"{folder}/arm.xacro", "--states", "5"],
    "validate a folder": lambda folder: ["validate", str(folder), "--states", "5"],
    "state": lambda folder: ["state", f"{folder}/arm.xacro"],
    "search": lambda folder: ["search", f"{folder}/arm.xacro", "--evaluations", "100"],
    "laws": lambda folder: ["laws", f"{folder}/arm.xacro", "--states", "5"],
    "sample": lambda folder: ["sample", f"{folder}/arm.xacro", "-n", "5"],
    "compare": lambda folder: ["compare", f"{folder}/arm.urdf", f"{folder}/arm.xacro"],
    "derive": lambda folder: ["derive", f"{folder}/arm.xacro"],
    "inspect": lambda folder: ["inspect", f"{folder}/arm.xacro"],
    "audit": lambda folder: ["audit", f"{folder}/paper.toml"],
}


@pytest.mark.one_in(2)
@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_runs_what_stands_in_a_file_unless_it_is_asked(
    command: str, folder: Path, marker: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = COMMANDS[command](folder)
    assert main(words) == 2
    shown = capsys.readouterr()
    assert "--xacro" in (shown.out + shown.err).replace("\n", " ")
    assert not marker.exists()
    main([*words, "--xacro"])
    assert marker.exists()


def test_no_function_runs_it_either(folder: Path, marker: Path) -> None:
    for load in (
        lambda: rttrr_pin.load(folder / "arm.xacro"),
        lambda: rttrr_pin.load_all(folder),
        lambda: rttrr_pin.read_publication(folder / "paper.toml"),
    ):
        with pytest.raises(UrdfError, match="--xacro .*xacro=True"):
            load()
    assert not marker.exists()
    assert rttrr_pin.load(folder / "arm.xacro", xacro=True).model.links[0].mass == 1.0
    assert marker.exists()


def test_the_other_robots_of_a_folder_are_validated_all_the_same(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["validate", str(folder), "--states", "5", "--json", "-"]) == 2
    entries = json.loads(capsys.readouterr().out)["entries"]
    assert {entry["name"]: entry["verdict"] for entry in entries} == {"arm.urdf": "agree", "arm.xacro": "unusable"}


def test_arguments_reach_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(ARM.format(default="1.5"))
    for arguments, mass in (({"mass": 2}, 2.0), ({"mass": "0.25"}, 0.25), ({}, 1.5)):
        assert rttrr_pin.load(path, xacro=True, xacro_args=arguments).model.links[0].mass == mass
    assert rttrr_pin.load(path, xacro_args={"mass": 2}).model.links[0].mass == 2.0  # to pass some asks for it
    assert main(["inspect", str(path), "--xacro-arg", "mass:=3", "--json", "-"]) in (0, 1)
    assert json.loads(capsys.readouterr().out)["mass"] == 3.0


def test_the_command_for_a_state_takes_the_same_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(ARM.format(default="1.5"))
    assert main(["validate", str(path), "--states", "5", "--xacro", "--xacro-arg", "mass:=3"]) == 0
    assert "--xacro --xacro-arg mass:=3 --index" in " ".join(capsys.readouterr().out.split())


def test_xacro_in_a_file_of_another_name_is_expanded_too(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.format(default="1.5"))
    with pytest.raises(UrdfError, match="this is xacro"):
        rttrr_pin.load(path)
    assert rttrr_pin.load(path, xacro=True).model.links[0].mass == 1.5


@pytest.mark.parametrize("word", ["dof", "dof=7", ":=7"])
def test_an_argument_that_is_none_is_refused(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", "rttrr", "--xacro-arg", word]) == 2
    assert "expected NAME:=VALUE" in capsys.readouterr().err


def test_arguments_are_a_dict() -> None:
    with pytest.raises(InputError, match="pass a dict"):
        rttrr_pin.load("rttrr", xacro_args=["dof:=7"])  # type: ignore[arg-type]
