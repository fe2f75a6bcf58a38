"""Verdicts say what they know: no false alarm, nothing overlooked, no number where there is nothing to measure."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.cli import main
from rttrr_pin.errors import InputError
from rttrr_pin.exact.adjudication import Deviation
from rttrr_pin.validation import compare_state, validate
from support.extremes import extreme_state, false_verdicts
from support.hostile import KINDS, usual_state
from support.implementations import altered
from support.tolerances import EPS


def report(repository: Path, name: str) -> str:
    return str(repository / f"tests/data/reports/{name}.urdf")


@pytest.mark.parametrize("seed", [*range(12), 20, 30, 1261, 26121])
def test_extreme_trees_have_no_false_verdict(seed: int) -> None:
    """More of them in `benchmarks/extreme_trees.py`.

    1261: a body whose parts lie 1e30 m apart; 26121: a payload over two fixed joints, without a mass beside it.
    """
    count, false = false_verdicts(seed)
    assert count["lagrange: compared"] == 1 and false == []


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(10, 14))
@pytest.mark.parametrize("kind", KINDS)
def test_trees_that_are_hostile_in_one_way_have_none(kind: Any, seed: int) -> None:
    text = kind(seed, np.random.default_rng(seed))
    for state in (extreme_state, usual_state) if seed % 2 else (usual_state,):
        count, false = false_verdicts(seed, text, state)
        assert count["lagrange: compared"] == 1 and false == []


@pytest.mark.one_in(16)
@pytest.mark.parametrize("sampling", ["uniform", "corners", "zeros", "mixed"])
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("subject", ["kernel", "recursion"])
@pytest.mark.parametrize("name", ["negative_mass_fixed", "negative_mass_on_base"])
def test_negative_masses_are_judged_like_others(
    repository: Path, name: str, subject: str, base: Any, sampling: str
) -> None:
    """Neither blamed nor excused: an error of 1e-6 of the moment is seen, and so is one of 1,000 N m."""
    robot = rttrr_pin.load(report(repository, name), base=base)
    reference = "pinocchio" if base == "fixed" else "lagrange"
    assert validate(robot, subject, reference, 100, sampling=sampling).passed
    for size in (1e-9, 1000.0):
        wrong = altered(robot, lambda values, batch, size=size: values["tau"].__iadd__(size), subject)
        assert not validate(robot, wrong, reference, 8, sampling=sampling).passed


@pytest.mark.parametrize("gravity", [(-1e200, 0, 0), (0, 0, 1e-200)], ids=str)
def test_numbers_whose_squares_float64_does_not_hold_are_compared(rttrr: Robot, gravity: tuple[float, ...]) -> None:
    """No false alarm, and 1e-6 of an error is seen."""
    robot = rttrr_pin.load("rttrr", gravity=gravity)
    for reference in ("pinocchio", "mujoco", "lagrange"):
        assert validate(robot, "recursion", reference, 20, sampling="zeros").passed
    wrong = altered(robot, lambda values, batch: values["F"].__imul__(1 + 1e-6), "recursion")
    (one,) = compare_state(robot, 6, wrong, "recursion", sampling="zeros").comparisons  # state 6 is at rest
    assert not one.passed


def test_what_overflows_is_named() -> None:
    robot = rttrr_pin.load("rttrr", gravity=(1e307, 1e307, 1e307))
    with pytest.raises(InputError, match=r"overflows in state 0: float64 holds no bound on the rounding of"):
        validate(robot, "recursion", n_states=5)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_program_that_overflows_alone_is_wrong(rttrr: Robot, value: float) -> None:
    wrong = altered(rttrr, lambda values, batch: values["n"].__setitem__((0, 2, 1), value), "recursion")
    assert not validate(rttrr, wrong, n_states=5).passed


def test_zeros_that_equal_zeros_are_no_agreement(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = rttrr_pin.load(report(repository, "no_mass"))
    with pytest.raises(InputError, match="no link of robot 'no_mass' has mass: nothing was compared"):
        validate(robot, "recursion", n_states=5)
    assert validate(robot, "recursion", n_states=5, payload=RandomPayload("tool")).passed
    assert main(["validate", report(repository, "no_mass")]) == 2
    assert "nothing was compared" in capsys.readouterr().err


def still(mass: str = "", arm: str = "", gravity: Any = None, kind: str = "continuous") -> Robot:
    """A hand on an arm that turns, a foot that is fixed, all on a stand; inertials as they are passed."""
    body = '<inertial><origin xyz="0.1 0 0.2"/><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    inertials = {mass: body, arm: body}
    links = "".join(
        f'<link name="{name}">{inertials.get(name, "")}</link>' for name in ("stand", "foot", "arm", "hand")
    )
    joints = "".join(
        f'<joint name="to_{child}" type="{own}"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/></joint>'
        for child, parent, own in (("foot", "stand", "fixed"), ("arm", "stand", kind), ("hand", "arm", "fixed"))
    )
    return rttrr_pin.load(f'<robot name="still">{links}{joints}</robot>', gravity)


def test_a_root_that_stands_still_gives_nothing_to_compare() -> None:
    for subject in ("kernel", "recursion", lambda q, v, a: np.zeros(1)):
        with pytest.raises(
            InputError, match="no link of robot 'still' but its root, which stands still, has mass: noth"
        ):
            validate(still("stand"), subject, n_states=5)
    assert validate(still("stand", "hand"), "recursion", n_states=5).passed
    floating = rttrr_pin.load(still("stand").model.urdf, base="floating")
    assert validate(floating, "recursion", n_states=5).passed


def test_zeros_in_every_state_are_no_agreement(tmp_path: Path) -> None:
    """Of whatever makes them zero: masses that stand still, no gravity and no motion, a payload of nothing."""
    for robot, subject, payload in (
        (still("foot"), lambda q, v, a: np.zeros(1), None),
        (still("foot", gravity=(0, 0, 0)), "recursion", None),
        (still("", "", kind="fixed"), "recursion", Wrench((0, 0, 0), link="hand")),
        (still(""), "recursion", RandomPayload("hand", force=0.0, moment=0.0)),
    ):
        with pytest.raises(InputError, match="zero in every state, by all programs: nothing was compared; pass"):
            validate(robot, subject, n_states=5, payload=payload)
    resting = tmp_path / "rest.csv"
    resting.write_text("q_to_arm,v_to_arm,a_to_arm,tau_to_arm\n0.5,0,0,0\n0.7,0,0,0\n")
    with pytest.raises(InputError, match="tau of robot 'still' are zero in every state"):
        validate(still("arm", gravity=(0, 0, 0)), resting, "recursion")
    assert validate(still("arm"), "recursion", n_states=5).passed
    wrong = validate(still("foot"), lambda q, v, a: np.full(1, 1e-9), "recursion", n_states=5)
    assert not wrong.passed


def test_what_is_zero_throughout_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    result = validate(still("foot"), "recursion", n_states=5)
    assert result.passed and any(note.startswith("tau, N: zero everywhere") for note in result.notes)
    one = compare_state(still("foot", gravity=(0, 0, 0)), 0, "recursion")
    assert any(note.startswith("tau, F, N, f, n: zero everywhere") for note in one.notes)
    assert not any("zero" in note for note in validate(still("arm"), "recursion", n_states=5).notes)


def test_relative_errors_are_of_what_is_not_rounding_itself(repository: Path) -> None:
    """N of this link is zero but for an axis that is 5e-15 off: |error| / |N| would be 1e7 eps."""
    result = validate(rttrr_pin.load(report(repository, "axis_tilted")), "recursion", n_states=200, sampling="corners")
    assert result.passed
    assert all(row.relative.value * EPS < 1.0 for row in result.rows)
    assert all(seen.value * EPS < 1.0 for seen in result.whole.values())


@pytest.mark.parametrize(
    ("eps", "of_allowance", "error", "relative"),
    [(4.6, 0.1, 1e-16, True), (9.7e15, 0.3, 1e-17, False), (0.0, 0.0, 0.0, True), (math.inf, math.inf, math.inf, True)],
)
def test_eps_are_said_where_there_is_something_to_measure(
    eps: float, of_allowance: float, error: float, relative: bool
) -> None:
    assert Deviation("n", "link_1", eps, of_allowance, error, "N m").relative is relative


def test_a_pass_names_no_program_wrong(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("axis_nearly_y", "axis_tilted"):
        for sampling in ("uniform", "corners"):
            words = ["validate", report(repository, name), "--subject", "recursion", "--states", "200"]
            assert main([*words, "--sampling", sampling]) == 0
            out = capsys.readouterr().out
            assert "wrong" not in out and "takes the axis of joint" in out


def test_a_file_with_errors_is_said_beside_its_verdict(repository: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["validate", report(repository, "negative_mass_on_base"), "--subject", "recursion", "--states", "5"]
    assert main(words) == 0
    out = capsys.readouterr().out
    found = re.search(r"inspect finds (\d+) errors? in this file", out)
    assert found and int(found[1]) > 0
    assert main([*words, "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_hints_name_options_on_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    limbs = "".join(
        f'<link name="{side}"/><joint name="to_{side}" type="continuous"><parent link="a"/><child link="{side}"/><axis xyz="0 0 1"/></joint>'
        for side in ("left", "right")
    )
    path = tmp_path / "two.urdf"
    path.write_text(f'<robot name="two"><link name="a"/>{limbs}</robot>')
    (tmp_path / "hint_of_mine.py").write_text("number = 3")
    monkeypatch.chdir(tmp_path)
    for words, hint in (
        ([str(path), "--payload", "random"], "pass --payload-link NAME"),
        ([str(path), "--payload", "1,2,3,4,5,6"], "pass --payload-link NAME"),
        (["--payload-link", "tool"], "pass --payload random or --payload"),
        (["--payload", "random", "--payload-axes", "base"], "--payload-axes goes with six numbers"),
        (["--subject", "hint_of_mine:number"], "hint_of_mine:number is of type int: expected a function"),
        (["--states", "0"], "--states is 0"),
        (["--seed", "-1"], "--seed is -1"),
    ):
        assert main(["validate", *words]) == 2
        assert hint in capsys.readouterr().err
    words = [str(path), "--payload", "random", "--payload-link", "left", "--subject", "recursion", "--states", "5"]
    assert main(["validate", *words]) == 0 and "random at left" in capsys.readouterr().out
    with pytest.raises(InputError, match="pass link=NAME"):
        validate(rttrr_pin.load(path), "recursion", payload=RandomPayload())
