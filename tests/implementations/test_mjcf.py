"""MJCF files that are meant to do harm end in a sentence, before MuJoCo is asked."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.errors import UrdfError
from rttrr_pin.urdf import files

BODY = '<body><joint/><geom size="0.1"/></body>'


def replicated(*counts: int) -> str:
    """A body, copied so often."""
    heads = "".join(f'<replicate count="{count}">' for count in counts)
    return f"<worldbody>{heads}{BODY}{'</replicate>' * len(counts)}</worldbody>"


HOSTILE = {
    "copies": (replicated(2_000_000_000), "makes 2,000,000,000 copies, expected 10,000"),
    "copies of copies": (replicated(1000, 1000, 1000), "copies, expected 10,000"),
    "copies of a file": (
        '<worldbody><replicate count="200"><include file="many.xml"/></replicate></worldbody>',
        "copies, expected 10,000",
    ),
    "itself": ('<include file="arm.xml"/>', "MuJoCo refuses the file"),
    "a pipe": ('<include file="pipe"/>', "pipe, which is no file"),
    "a mesh of a pipe": ('<compiler meshdir="deep"/><asset><mesh file="pipe"/></asset>', "pipe, which is no file"),
    "an endless file": ('<include file="/dev/zero"/>', "/dev/zero, which is no file"),
    "a large field": (
        '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
        "10,000,000,000 cells",
    ),
    "more digits than Python reads": (
        f'<asset><hfield name="h" nrow="{"9" * 5000}" ncol="2" size="1 1 1 1"/></asset>',
        "cells, expected",
    ),
    "a ladder": ('<include file="step0.xml"/><include file="step0.xml"/>', "MuJoCo refuses the file"),
    "names": (f'<worldbody><body name="{"y" * 100_000}"><joint/><geom size="1"/></body></worldbody>', "100,000 char"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_a_hostile_file_is_refused(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "PATIENCE", 0.1)
    text, message = HOSTILE[case]
    (tmp_path / "deep").mkdir()
    (tmp_path / "many.xml").write_text(f"<mujocoinclude>{replicated(100)[11:-12]}</mujocoinclude>")
    for k in range(40):  # each includes the next one twice
        twice = 2 * f'<include file="step{k + 1}.xml"/>' if k < 39 else ""
        (tmp_path / f"step{k}.xml").write_text(f"<mujocoinclude>{twice}</mujocoinclude>")
    for pipe in ("pipe", "deep/pipe"):
        os.mkfifo(tmp_path / pipe)
    (tmp_path / "arm.xml").write_text(f"<mujoco>{text}</mujoco>")
    with pytest.raises(UrdfError, match=message):
        rttrr_pin.load(tmp_path / "arm.xml")


def test_some_copies_are_read(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(f"<mujoco>{replicated(2, 3)}</mujoco>")
    assert len(rttrr_pin.load(tmp_path / "arm.xml").link_names) == 6
