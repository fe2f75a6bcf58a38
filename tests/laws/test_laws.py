"""The laws hold wherever the dynamics are right, each is broken by a slip made to break it, and the report says so."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.cli import main
from rttrr_pin.core.algebra import ZERO, Vector
from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.laws import LawReport, check_laws
from rttrr_pin.laws import balance as law_balance
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.run import error_over_bound
from rttrr_pin.laws.table import LAWS
from rttrr_pin.validation import SAMPLINGS, Sampler
from support.mutants import EQUIVALENT, Mutant, mutant, mutants, planted
from support.robots import BASES, BUNDLED, driven
from support.serial_chains import random_chain
from support.slow import slow_after
from support.trees import MUTATED, random_tree

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


BREAKS = {
    "K101": "Revolute.motion: negate w=u * v",
    "E201": "outwards: forget the factor of carried.cross(joint.v) * 2",
    "E202": "outwards: drop w.cross(w.cross(r_C))",
    "E203": "outwards: drop w.cross(body.I @ w)",
    "B301": "outwards: drop w_dot.cross(r_C)",
    "B302": "outwards: negate w.cross(body.I @ w)",
    "B303": "inwards: transpose joint.R in joint.R @ f",
    "B304": "inwards: negate joint.p.cross(R_f)",
    "M401": "inwards: drop body.r_C.cross(F)",
    "M402": "outwards: keep the diagonal of body.I in body.I @ w_dot",
    "M403": "newton_euler: negate f[parents[i]] += R_f",
    "M404": "outwards: drop carried.cross(joint.w)",
    "M405": "outwards: drop joint.w_dot",
    "L501": "outwards: repeat w_dot.cross(r_C)",
    "L502": "newton_euler: square gravity",
    "L503": "outwards: square body.M",
    "I601": "newton_euler: take z alone of gravity",
    "I602": "outwards: keep the diagonal of body.I in body.I @ w_dot",
    "S701": "outwards: square body.M",
    "S702": "outwards: keep the last of w.cross(w.cross(r_C))",
}
"""For each law an error in the recursion that breaks it."""

UNSEEN = {
    "_mimicked: drop offset": "the coordinate of a joint that follows another is what this function says",
    "_mimicked: negate offset": "likewise",
    "Planar.motion: drop body.p": "it makes another robot; I602 sees it where the frame that carries the joint may move",
    "Planar.motion: negate body.p": "likewise",
}
"""Errors that no law sees in this tree, and why."""


def test_every_law_has_an_error_that_breaks_it() -> None:
    assert list(BREAKS) == IDS


@pytest.fixture(scope="module")
def tree() -> Robot:
    robot = driven(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)))
    assert broken(check_laws(robot, 2)) == []
    return robot


@pytest.mark.parametrize("law", BREAKS)
def test_every_law_is_violated_by_an_error_that_breaks_it(tree: Robot, law: str) -> None:
    with planted(mutant(BREAKS[law])):
        (row,) = check_laws(tree, 2, select=[law]).rows
    assert row.violations == 2 and row.share.value > 1e6


def test_every_error_is_found_by_a_law(tree: Robot) -> None:
    """Also those in the tenth digit of one term; laws that take long come last."""
    states = Sampler(tree.model, payload=RandomPayload(tree.link_names[-1])).draw(0, 1)
    laws = sorted(LAWS, key=lambda law: "EBKSLIM".index(law.id[0]))
    loads = (*states.loads, Load(4, -states.loads[0].f, states.loads[0].n, in_base=True))

    def found(error: Mutant) -> bool:
        with planted(error):
            case = Case.bounded(tree.model, states.q, states.v, states.a, loads)
            return any((error_over_bound(law, case, 1) > 1.0).any() for law in laws)

    assert {error.id for error in mutants() if not found(error)} == {*UNSEEN, *EQUIVALENT}


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
