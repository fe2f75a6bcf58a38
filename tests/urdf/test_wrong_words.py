"""Options and files that cannot be meant: each command says what it got, what it wanted and the fix, and exits with 2."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from rttrr_pin.cli import main
from support.faulty import URDF

COMMANDS = ("validate", "state", "search", "sample", "laws", "derive", "inspect")

SDF = '<?xml version="1.0"?>\n<sdf version="1.7"><model name="m"><link name="a"/></model></sdf>'

FILES: dict[str, bytes | None] = {
    "binary.urdf": bytes(range(256)),
    "mesh.urdf": b"solid x" + bytes(77),
    "nothing.urdf": b"",
    "truncated.urdf": URDF[: len(URDF) // 2].encode(),
    "model.sdf": SDF.encode(),
    "sdf.urdf": SDF.encode(),
    "scene.xml": b'<mujoco model="m"/>',
    "words.urdf": b"a robot\n",
    "broken.xacro": b"<robot",
    "sum.xacro": b'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${1 + }"/></robot>',
    "folder.urdf": None,
    "empty": None,
    "good.urdf": URDF.encode(),
}
"""By name; None is a folder."""

CASES: dict[str, tuple[list[str], tuple[str, ...]]] = {
    # id: (the words behind the command, what is said)
    "package-without-sign": (["good.urdf", "--package", "x"], ("--package is 'x'", "expected NAME=FOLDER")),
    "package-without-folder": (["good.urdf", "--package", "x="], ("--package is 'x='", "expected NAME=FOLDER")),
    "package-without-name": (["good.urdf", "--package", "=x"], ("--package is '=x'", "expected NAME=FOLDER")),
    "package-nowhere": (["good.urdf", "--package", "x=none"], ("none' is no folder", "the one that holds its package")),
    "package-of-a-file": (["good.urdf", "--package", "x=good.urdf"], ("good.urdf' is no folder",)),
    "package-of-a-home": (["good.urdf", "--package", "x=~nobody_of_that_name"], ("is no folder",)),
    "argument-without-sign": (["good.urdf", "--xacro-arg", "dof"], ("--xacro-arg is 'dof'", "expected NAME:=VALUE")),
    "argument-with-another": (["good.urdf", "--xacro-arg", "dof=7"], ("--xacro-arg is 'dof=7'", "such as dof:=7")),
    "argument-without-name": (["good.urdf", "--xacro-arg", ":=7"], ("--xacro-arg is ':=7'", "expected NAME:=VALUE")),
    "binary": (["binary.urdf"], ("byte 0x80 is not UTF-8", "save it as UTF-8")),
    "mesh": (["mesh.urdf"], ("is no well-formed XML",)),
    "no-text": (["nothing.urdf"], ("is empty, expected a URDF",)),
    "truncated": (["truncated.urdf"], ("is no well-formed XML", "line")),
    "sdf": (["model.sdf"], ("this is SDF, which is not read: convert it to URDF",)),
    "sdf-by-another-name": (["sdf.urdf"], ("expected <robot>: this is SDF",)),
    "words": (["words.urdf"], ("is no well-formed XML",)),
    "folder-for-a-file": (["folder.urdf"], ("is a folder without a .urdf or .xacro file: name the file",)),
    "empty-folder": (["empty"], ("is a folder without a .urdf or .xacro file: name the file",)),
    "behind-a-file": (["good.urdf/arm.urdf"], ("good.urdf/arm.urdf", "check the path")),
    "nowhere": (["gone.urdf"], ("no bundled robot or file is called 'gone.urdf'", "check the path")),
    "xacro-unasked": (["broken.xacro"], ("is a xacro file", "add --xacro")),
    "xacro-that-is-none": (["broken.xacro", "--xacro"], ("xacro cannot expand it",)),
    "xacro-that-cannot": (["sum.xacro", "--xacro"], ("xacro cannot expand it",)),
    "shut": (["shut.urdf"], ("cannot be read: Permission denied",)),
}
LENIENT = ("binary", "no-text", "truncated", "sdf", "empty-folder", "folder-for-a-file", "shut")
"""Cases that no assumption mends."""


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, content in FILES.items():
        if content is None:
            (tmp_path / name).mkdir()
        else:
            (tmp_path / name).write_bytes(content)
    (tmp_path / "shut.urdf").write_text(URDF)
    opened = os.open

    def may_open(path: str | Path, *words: Any, **options: Any) -> int:  # root may read everything
        if Path(path).name == "shut.urdf":
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return opened(path, *words, **options)

    monkeypatch.setattr(os, "open", may_open)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.one_in(5)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("command", COMMANDS)
def test_what_cannot_be_meant_exits_2_and_says_why(
    command: str, case: str, desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words, said = CASES[case]
    lenient = [["--lenient"]] if case in LENIENT and command != "inspect" else []
    for more in ([], *lenient):
        assert main([command, *words, *more]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.startswith("error: ") and "Traceback" not in err and err.count("\n") < 3
        assert all(word in err for word in said), err


ANY = ("--package", "--xacro", "--xacro-arg")
"""Options of all that read a robot; `inspect` goes on with every file, and needs no other."""

PAIRS = [(command, option) for command in ("validate", "derive", "inspect") for option in ANY]
PAIRS += [(command, option) for command in ("validate", "derive") for option in ("--lenient", "--no-mimic")]


@pytest.mark.parametrize(("command", "option"), PAIRS)
def test_the_options_go_with_whatever_is_read(command: str, option: str, desk: Path) -> None:
    """They are of no use for a plain file, and no harm."""
    value = {"--package": ["x=empty"], "--xacro-arg": ["dof:=7"]}.get(option, [])
    few = ["--states", "3", "--subject", "recursion"] if command == "validate" else []
    assert main([command, "good.urdf", "-q", *few, option, *value]) == 0
