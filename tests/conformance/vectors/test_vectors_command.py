"""`rttrr-pin vectors`: writes, checks, and says what it cannot do."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rttrr_pin.cli import main


def test_own_robots_are_written_and_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    assert main(["vectors", "trr", "trtr", "-o", str(folder), "-n", "2", "--levels", "rates", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["passed"]
    assert data["robots"].keys() == {"trr", "trtr"}
    assert main(["vectors", "--check", str(folder)]) == 0
    assert "as it was written: rates-trr, rates-trtr; 4 states" in capsys.readouterr().out
    table = folder / "trr" / "states.csv"
    table.write_text(table.read_text().replace("0", "1", 1))
    assert main(["vectors", "--check", str(folder)]) == 2
    assert "was altered" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "-o FOLDER"),
        (["-o", "OUT", "--check", "OUT"], "writes nothing: leave out -o"),
        (["trr", "--check", "OUT"], "writes nothing: leave out trr"),
        (["-o", "OUT", "--base", "floating"], "--base goes with a robot"),
        (["-o", "OUT", "--levels", "gravty"], "did you mean gravity"),
        (["trr", "-o", "OUT", "--levels", "sixty"], "no level applies"),
        (["-o", "OUT", "-n", "0"], "-n"),
        (["--check", "OUT"], "cannot be read"),
        (["nothing.urdf", "-o", "OUT"], "nothing.urdf"),
    ],
)
def test_what_cannot_be_done_is_said(
    words: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    assert main(["vectors", *(str(folder) if word == "OUT" else word for word in words)]) == 2
    assert sentence in capsys.readouterr().err
    assert not folder.exists()


def test_what_is_there_is_left_as_it_was(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["vectors", "trr", "-o", str(tmp_path), "-n", "1", "--levels", "gravity"]
    (tmp_path / "mine").write_text("mine")
    assert main(words) == 2
    assert "--force" in capsys.readouterr().err
    assert main([*words, "--force", "-q"]) == 0
    assert capsys.readouterr().out == ""
    assert (tmp_path / "mine").read_text() == "mine"
