"""The laws hold wherever the dynamics are right, each is broken by a slip made to break it, and the report says so."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.cli import main
from rttrr_pin.core import newton_euler
from rttrr_pin.core.algebra import ZERO, Vector
from rttrr_pin.core.joints import JOINT_TYPES, revolute
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.laws import LawReport, check_laws
from rttrr_pin.laws import balance as law_balance
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.table import LAWS
from rttrr_pin.validation import SAMPLINGS, Sampler
from support.mutants import put_in
from support.robots import BASES, BUNDLED, driven
from support.serial_chains import random_chain
from support.slow import slow_after
from support.trees import random_tree

IDS = [law.id for law in LAWS]


def broken(report: LawReport) -> list[str]:
    return [row.law.id for row in report.rows if not row.holds]


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("name", BUNDLED)
def test_laws_hold_on_bundled_arms(name: str, base: Any) -> None:
    report = check_laws(driven(rttrr_pin.load(name, base=base)), 120, sampling="mixed")
    assert broken(report) == []
    assert [row.law.id for row in report.rows] == IDS
    assert all(row.numbers for row in report.rows)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("seed", slow_after(3, range(8)))
def test_laws_hold_on_random_trees(seed: int, base: Any) -> None:
    """Every joint type, followers, massless frames, payloads in both axes, drives."""
    robot = driven(rttrr_pin.load(random_tree(seed, 3 + seed), base=base))
    assert broken(check_laws(robot, 60, seed, "mixed")) == []


def test_the_trees_hold_every_kind_of_joint() -> None:
    joints = [joint for seed in range(8) for joint in rttrr_pin.load(random_tree(seed, 3 + seed)).model.joints]
    assert {joint.type for joint in joints} == set(JOINT_TYPES.values())
    assert any(joint.mimic for joint in joints)


def test_laws_hold_on_awkward_chains(robot: Robot) -> None:
    assert broken(check_laws(robot, 60, sampling="mixed")) == []


@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_laws_hold_in_every_family_of_states(rttrr: Robot, sampling: str) -> None:
    payload = Wrench((1, 2, 3), (4, 5, 6), expressed_in="base")
    assert broken(check_laws(rttrr, 60, 3, sampling, payload)) == []


def test_laws_hold_in_one_state_and_without_gravity() -> None:
    robot = rttrr_pin.load(random_tree(6, 9), base="floating", gravity=(0, 0, 0))
    assert broken(check_laws(robot, 1)) == []


def test_a_robot_that_cannot_move_keeps_the_laws_that_say_something_of_it() -> None:
    report = check_laws(rttrr_pin.load(random_chain(6, ("fixed", "fixed"))), 20)
    assert broken(report) == []
    silent = {row.law.id for row in report.rows if not row.numbers}
    assert silent == {"M401", "M402", "M403", "M404", "M405"}


SLIPS: dict[str, tuple[ModuleType, str, str]] = {
    "K101": (revolute, "w=u * v, w_dot=u * a", "w=-(u * v), w_dot=u * a"),
    "E201": (newton_euler, "carried.cross(joint.v) * 2", "carried.cross(joint.v)"),
    "E202": (newton_euler, "w_dot.cross(r_C) + w.cross(w.cross(r_C)) + v_dot", "w_dot.cross(r_C) + v_dot"),
    "E203": (newton_euler, " + w.cross(body.I @ w)", ""),
    "B301": (newton_euler, "keep(v_dot_C * body.M)", "keep(v_dot * body.M)"),
    "B302": (newton_euler, "+ w.cross(body.I @ w)", "- w.cross(body.I @ w)"),
    "B303": (newton_euler, "R_f = joint.R @ f", "R_f = joint.R.T @ f"),
    "B304": (newton_euler, "joint.R @ n + joint.p.cross(R_f)", "joint.R @ n - joint.p.cross(R_f)"),
    "M401": (newton_euler, " + body.r_C.cross(F))", ")"),
    "M402": (newton_euler, "body.I @ w_dot", "body.I @ w_dot * 2"),
    "M403": (newton_euler, "keep(v_dot_C * body.M)", "keep(-v_dot_C * body.M)"),
    "M404": (newton_euler, " + carried.cross(joint.w) + ", " + "),
    "M405": (newton_euler, "+ joint.w_dot)", "+ joint.w_dot * 2)"),
    "L501": (newton_euler, "w_dot.cross(r_C)", "w_dot.cross(w_dot.cross(r_C))"),
    "L502": (newton_euler, "ZERO, -gravity)", "ZERO, gravity * -gravity.dot(gravity))"),
    "L503": (newton_euler, "v_dot_C * body.M", "v_dot_C * body.M * body.M"),
    "I601": (newton_euler, "ZERO, -gravity)", "ZERO, Vector(0, 0, -gravity.z))"),
    "I602": (
        newton_euler,
        "body.I @ w_dot",  # products of inertia forgotten
        "Vector(*(row_x * x for row_x, x in zip([list(body.I.rows[k])[k] for k in range(3)], w_dot)))",
    ),
    "S701": (newton_euler, "keep(v_dot_C * body.M)", "keep(v_dot_C * body.M + v_dot_C)"),
    "S702": (newton_euler, "w.cross(w.cross(r_C))", "w.cross(r_C)"),
}
"""For each law a slip in the specification that breaks it."""


def test_every_law_has_a_slip() -> None:
    assert list(SLIPS) == IDS


@pytest.fixture(scope="module")
def tree() -> Robot:
    robot = rttrr_pin.load(random_tree(3, 7), base="floating")
    assert broken(check_laws(robot, 20)) == []
    return robot


@pytest.mark.parametrize("law", SLIPS)
def test_every_law_is_violated_by_a_slip_made_to_break_it(
    tree: Robot, monkeypatch: pytest.MonkeyPatch, law: str
) -> None:
    put_in(monkeypatch, *SLIPS[law])
    (row,) = check_laws(tree, 20, select=[law]).rows
    assert not row.holds
    assert row.violations >= 10 and row.share.value > 1e6


@pytest.mark.parametrize("law", ["E201", "B303", "M405", "M404", "L501", "S702"])
def test_a_slip_of_a_part_in_1e9_is_no_rounding(rttrr: Robot, monkeypatch: pytest.MonkeyPatch, law: str) -> None:
    """The bounds are those of rounding: a wrong tenth digit is seen."""
    slips = {
        "M405": ("+ joint.w_dot)", "+ joint.w_dot * (1 + 2**-30))"),
        "L501": ("w_dot.cross(r_C)", "(w_dot.cross(r_C) + w_dot.cross(w_dot.cross(r_C)) * 2**-30)"),
        "S702": ("w.cross(w.cross(r_C))", "(w.cross(w.cross(r_C)) + w.cross(r_C) * 2**-30)"),
    }
    factor = ("carried.cross(joint.v) * 2", "carried.cross(joint.v) * (2 + 2**-30)")
    put_in(monkeypatch, newton_euler, *slips.get(law, factor))
    assert broken(check_laws(rttrr, 20, select=[law])) == [law]


def test_a_negative_mass_is_against_the_law(rttrr: Robot) -> None:
    links = list(rttrr.model.links)
    links[4] = replace(links[4], mass=-links[4].mass - 50.0)
    report = check_laws(Robot(replace(rttrr.model, links=tuple(links))), 50)
    assert broken(report) == ["M403"]


def test_balls_prove_the_laws_at_a_state(rttrr: Robot) -> None:
    """At 200 bits what is zero lies in balls around zero that are far narrower than rounding."""
    with precision(200):
        drawn = Sampler(rttrr.model, seed=7).draw(0, 1)
        q, v, a = ([interval(float(x)) for x in values[0]] for values in (drawn.q, drawn.v, drawn.a))
        load = Vector.of((1, 2, 3), interval)
        case = Case(rttrr.model, INTERVAL, q, v, a, [Payload(4, load, load), Payload(2, load, load, in_base=True)])
        proven = [law for law in LAWS if law.id not in ("M403", "M405")]
        for law in proven:
            for x in law.residual(case):
                enclosed = interval(0.0) + x
                assert enclosed.contains(0), law.id
                assert float(enclosed.rad()) < 1e-50, law.id


def test_the_outcome_does_not_depend_on_blocks(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = ("E201", "M403", "M405", "S")
    whole = check_laws(rttrr, 130, 5, select=chosen)
    monkeypatch.setattr("rttrr_pin.laws.run.BLOCK", 32)
    seen: list[int] = []
    assert check_laws(rttrr, 130, 5, select=chosen, progress=seen.append).rows == whole.rows
    assert seen == [32, 64, 96, 128, 130]


def test_select_takes_prefixes(rttrr: Robot) -> None:
    rows = check_laws(rttrr, 5, select=["M", "E201"]).rows
    assert [row.law.id for row in rows] == ["E201", "M401", "M402", "M403", "M404", "M405"]
    with pytest.raises(UnknownNameError, match="no law is called 'X1'"):
        check_laws(rttrr, 5, select=["X1"])


def test_what_cannot_be_tried_is_an_error(rttrr: Robot) -> None:
    with pytest.raises(InputError, match="states is 0"):
        check_laws(rttrr, 0)
    with pytest.raises(InputError, match="no joint, so that no law"):
        check_laws(Robot(Model("bare", Link("base"), (), ())))
    with pytest.raises(InputError, match="robot is a str"):
        check_laws("rttrr")  # type: ignore[arg-type]


def test_overflow_is_no_zero(rttrr: Robot) -> None:
    report = check_laws(rttrr, 3, select=["E201"], payload=Wrench((1e308, 1e308, 1e308), (1e308, 0, 0)))
    assert report.rows[0].violations == 1 and not report.holds


def test_the_command_shows_the_laws_and_fails_with_them(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["validate", "--states", "60", "--laws"]) == 0
    out = capsys.readouterr().out
    assert "all of 60 states x 29 rows" in out and "PASS all 20 laws hold" in out
    assert all(identity in out for identity in IDS)
    monkeypatch.setattr(law_balance, "rate_of", lambda vector: ZERO)  # as if no momentum ever changed
    assert main(["validate", "--states", "20", "--laws", "--json", "-"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert data["verdict"] == "agree" and data["laws"]["verdict"] == "violated"
    assert data["laws"]["laws"]["B301"]["violations"] == 20
    assert list(data["laws"]["laws"]) == IDS
    assert main(["validate", "--states", "20", "--laws"]) == 1
    assert "B301: F of a link changes its linear momentum" in capsys.readouterr().out


def test_without_the_option_there_are_no_laws(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "--states", "20", "--json", "-"]) == 0
    assert "laws" not in json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("words", [["--state", "3"], ["urdf"]], ids=str)
def test_laws_go_with_one_robot_and_many_states(
    words: list[str], repository: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(repository)
    assert main(["validate", *words, "--laws"]) == 2
    assert "--laws" in capsys.readouterr().err


def test_the_page_of_laws_is_the_table(repository: Path) -> None:
    page = (repository / "docs" / "laws.md").read_text()
    for law in LAWS:
        assert f"| {law.id} | {law.name} | {law.statement} |" in page
