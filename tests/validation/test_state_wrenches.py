"""`rttrr-pin state --convention`: what the subject gave, as another program says it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import compare_state
from rttrr_pin.cli import main
from rttrr_pin.core.conventions import CONVENTIONS
from rttrr_pin.errors import InputError
from rttrr_pin.validation.wrenches import wrenches_of

STATE = ["state", "--index", "3", "--reference", "recursion"]


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", [row.name for row in CONVENTIONS])
def test_it_is_what_the_result_says(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    robot = rttrr_pin.load("rttrr")
    batch = compare_state(robot, 3, reference="recursion").batch
    wanted = robot.inverse_dynamics(batch.q, batch.v, batch.a).in_convention(name)
    assert main([*STATE, "--convention", name, "--json", "-"]) == 0
    said = json.loads(capsys.readouterr().out)["wrenches"]
    assert said["convention"]["name"] == name and tuple(said["links"]) == robot.link_names
    assert np.array_equal(said["wrenches"], wanted.vector)


def test_it_is_shown_in_the_order_of_the_program(capsys: pytest.CaptureFixture[str]) -> None:
    for name, order in (("mujoco", "nx ny nz fx fy fz"), ("gazebo", "fx fy fz nx ny nz")):
        assert main([*STATE, "--convention", name]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert f"link {order}" in [" ".join(line.split()) for line in lines]
    assert main(STATE) == 0 and "nx" not in capsys.readouterr().out


def test_what_is_no_number_is_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """JSON has no NaN."""
    (tmp_path / "nothing.py").write_text(
        "import numpy as np\n\ndef known(q, v, a):\n"
        "    return {'tau': 0 * a, 'f': np.full((6, 3), np.nan), 'n': np.zeros((6, 3))}\n"
    )
    monkeypatch.chdir(tmp_path)
    assert main([*STATE, "--subject", "nothing:known", "--convention", "mujoco", "--json", "-"]) == 1
    said = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)["wrenches"]["wrenches"]
    assert said[0][0] == ["nan"] * 6


def test_what_cannot_be_shown_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*STATE, "--convention", "mujok"]) == 2 and "mujoco" in capsys.readouterr().err
    report = compare_state(rttrr_pin.load("rttrr"), 3, subject="lagrange", reference="recursion")
    with pytest.raises(InputError, match="--subject"):
        wrenches_of(report, "mujoco")
