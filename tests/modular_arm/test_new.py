"""`rttrr-pin new` builds arms that load, and never harms a file."""

from __future__ import annotations

from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.modular_arm import CODES, modules_of


@pytest.mark.parametrize("code", ["RTTRR", "RRRRRR", "T", "TTRTRRR"])
def test_the_arm_has_the_joints_of_its_code(code: str, tmp_path: Path) -> None:
    path = tmp_path / "my.urdf"
    assert main(["new", code, "-o", str(path)]) == 0
    robot = rttrr_pin.load(path)
    assert robot.name == code.lower()
    assert [joint.type.name for joint in robot.model.moving] == [module.type for module in modules_of(code)]
    assert [tuple(joint.axis) for joint in robot.model.moving] == [module.axis for module in modules_of(code)]
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("code", CODES)
def test_a_bundled_arm_comes_out_as_it_is_bundled(
    code: str, repository: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", code]) == 0
    assert capsys.readouterr().out.encode() == (repository / "urdf" / f"{code.lower()}.urdf").read_bytes()


def test_other_arms_do_not_claim_a_paper(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "RRR", "--name", "mine"]) == 0
    text = capsys.readouterr().out
    assert '<robot name="mine">' in text
    assert "rttrr-pin new RRR" in text
    assert "Detesan" not in text
    assert "do not edit" not in text
    assert rttrr_pin.load(text).name == "mine"


def test_a_file_that_is_there_is_kept_unless_forced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "my.urdf"
    path.write_text("precious")
    assert main(["new", "RT", "-o", str(path)]) == 2
    assert "--force" in capsys.readouterr().err
    assert path.read_text() == "precious"
    assert main(["new", "RT", "-o", str(path), "--force"]) == 0
    assert rttrr_pin.load(path).joint_names == ("joint_1", "joint_2")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["RTX"], "wanted one letter per joint"),
        (["rttrr"], "in capitals"),
        ([""], "wanted one letter per joint"),
        (["RT", "--name", "a b"], "choose another name"),
        (["RT", "-o", "{folder}"], "is a folder"),
        (["RT", "-o", "{folder}/none/my.urdf"], "cannot be written"),
        (["RT", "-o", "\0"], "cannot be written"),
    ],
)
def test_unusable_input_says_why_and_writes_nothing(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", *(word.format(folder=tmp_path) for word in arguments)]) == 2
    printed = capsys.readouterr()
    assert message in printed.err
    assert not printed.out
    assert list(tmp_path.iterdir()) == []
