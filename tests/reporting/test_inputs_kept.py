"""No output overwrites what is read because another file names it: only the file itself is on the command line."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

ARM = (
    '<robot name="arm"{0}><link name="base"/>{1}<link name="rod"><inertial><mass value="2"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>{2}</link>'
    '<joint name="j" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>'
)

ABOUT = '[robot]\nurdf = "arm.urdf"\n'
EQUATION = '[[equation]]\nquantity = "tau"\njoint = 1\npython = "qdd1"\n'

FILES = {
    "arm.urdf": ARM.format("", "", '<visual><geometry><mesh filename="rod.obj"/></geometry></visual>'),
    "rod.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    "arm.xacro": ARM.format(f" {XACRO}", '<xacro:include filename="part.xacro"/>', ""),
    "part.xacro": f"<robot {XACRO}/>",
    "arm.xml": '<mujoco><include file="part.xml"/></mujoco>',
    "part.xml": '<mujoco><worldbody><body><joint/><geom size="1"/></body></worldbody></mujoco>',
    "one/arm.urdf": ARM.format("", "", ""),
    "whole.toml": f'language = "python"\n{ABOUT}{EQUATION}',
    "parts.toml": 'language = "python"\nsymbols = "symbols.toml"\nequations = "equations.toml"\n',
    "symbols.toml": ABOUT,
    "equations.toml": EQUATION,
    "my_id.py": "def my_id(q, v, a): return a\n",
    "settings.toml": "",
    "results.csv": "q_j,v_j,a_j,tau_j\n0.1,0.2,0.3,0.4\n",
}

COMMANDS = {
    "rod.obj": ["inspect arm.urdf --json", "inspect arm.urdf --fix"],
    "part.xacro": ["validate arm.xacro --xacro --states 5 --json", "inspect arm.xacro --xacro --sarif"],
    "part.xml": ["laws arm.xml --states 5 --json", "sample arm.xml -n 5 -o", "compare arm.urdf arm.xml --json"],
    "results.csv": ["diagnose arm.urdf results.csv --json", "diagnose arm.urdf results.csv --html"],
    "one/arm.urdf": [
        *("validate one --states 5 --json", "inspect one --junit", "derive one --c", "state one --json"),
        *("compare arm.urdf one --json", "compare arm.urdf one --html", "diagnose one --subject kernel --html"),
        "conform recursion one -n 1 --junit",
    ],
    "arm.urdf": ["audit whole.toml --json", "audit parts.toml --latex"],
    "symbols.toml": ["audit parts.toml --html"],
    "equations.toml": ["audit parts.toml --markdown"],
    "my_id.py": [
        "validate --subject my_id:my_id --json",
        "validate --subject 'python my_id.py' --json",
        "diagnose --subject 'python my_id.py' --html",
        "conform my_id:my_id arm.urdf --json",
        "conform 'python my_id.py {urdf}' --html",
    ],
    "settings.toml": ["search --subject './my_id.py settings.toml' --json"],
}
"""By the file that is read, commands that would write it."""


@pytest.mark.parametrize(("name", "command"), [(name, one) for name, each in COMMANDS.items() for one in each])
@pytest.mark.parametrize("spelling", ["same", "link"])
def test_what_is_read_is_not_overwritten(
    name: str,
    command: str,
    spelling: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for file, text in FILES.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(text)
    os.link(tmp_path / name, tmp_path / "other")
    monkeypatch.chdir(tmp_path)
    words = shlex.split(command)
    assert main([*words, name if spelling == "same" else "other"]) == 2
    assert "would overwrite the input" in capsys.readouterr().err
    assert (tmp_path / name).read_text() == FILES[name]


def test_the_file_itself_may_be_repaired_in_its_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm.urdf").write_text(rttrr_pin.load("rttrr").model.urdf)
    monkeypatch.chdir(tmp_path)
    for robot in ("arm.urdf", "."):
        assert main(["inspect", robot, "--fix", "arm.urdf", "-q"]) == 0
