"""Files that are repaired: nothing but what was repaired changes."""

from __future__ import annotations

import codecs
import stat
from pathlib import Path

import pytest

from rttrr_pin.cli import main

IMPOSSIBLE = """<robot name="x"><link name="base"/>
  <link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>
    <inertia ixx="0.1234" ixy="0" ixz="0" iyy="0.1234" iyz="0" izz="0.24681"/></inertial></link>
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>
"""
"""Its tensor is impossible by its last digit, and has a certain repair."""


def test_a_file_that_is_repaired_in_place_keeps_its_mark_and_its_mode(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_bytes(codecs.BOM_UTF8 + IMPOSSIBLE.replace("\n", "\r\n").encode())
    file.chmod(0o640)
    main(["inspect", str(file), "--fix", str(file), "--quiet"])
    after = file.read_bytes()
    assert after.startswith(codecs.BOM_UTF8) and after.count(b"\r\n") == IMPOSSIBLE.count("\n")
    assert b'izz="0.24681"' not in after
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


def test_a_repaired_file_goes_to_stdout(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.urdf").write_text(IMPOSSIBLE)
    main(["inspect", "arm.urdf", "--fix", "-"])
    out = capsys.readouterr().out
    assert out.startswith("<robot") and out.endswith("</robot>\n")
    assert [path.name for path in tmp_path.iterdir()] == ["arm.urdf"]
