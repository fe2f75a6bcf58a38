"""The laws hold where the dynamics are right, and each is violated by an error in the recursion; any program is checked."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.cli import main
from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.implementations import Batch
from rttrr_pin.laws import LawReport, check_laws
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.run import LAWS, error_over_bound
from rttrr_pin.validation import SAMPLINGS, Sampler
from support.implementations import altered
from support.mutants import EQUIVALENT, Mutant, mutant, mutants, planted
from support.robots import BASES, BUNDLED, driven
from support.serial_chains import random_chain
from support.slow import slow_after
from support.trees import MUTATED, random_tree

IDS = [law.id for law in LAWS]


def broken(report: LawReport) -> list[str]:
    return [row.law.id for row in report.violated]


@pytest.mark.one_in(4)
@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("name", BUNDLED)
def test_laws_hold_on_bundled_arms(name: str, base: Any) -> None:
    report = check_laws(driven(rttrr_pin.load(name, base=base)), n_states=60, sampling="mixed")
    assert broken(report) == []
    assert [row.law.id for row in report.rows] == IDS
    assert all(row.numbers for row in report.rows)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("seed", slow_after(3, range(8)))
def test_laws_hold_on_random_trees(seed: int, base: Any) -> None:
    """Every joint type, followers, massless frames, payloads in both axes, armature and friction."""
    robot = driven(rttrr_pin.load(random_tree(seed, 3 + seed), base=base))
    assert broken(check_laws(robot, n_states=40, seed=seed, sampling="mixed")) == []


def test_the_trees_hold_every_kind_of_joint() -> None:
    joints = [joint for seed in range(8) for joint in rttrr_pin.load(random_tree(seed, 3 + seed)).model.joints]
    assert {joint.type for joint in joints} == set(JOINT_TYPES.values())
    assert any(joint.mimic for joint in joints)


def test_laws_hold_on_awkward_chains(robot: Robot) -> None:
    assert broken(check_laws(robot, n_states=40, sampling="mixed")) == []


@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_laws_hold_however_states_are_drawn(rttrr: Robot, sampling: str) -> None:
    payload = Wrench((1, 2, 3), (4, 5, 6), expressed_in="base")
    report = check_laws(rttrr, n_states=40, seed=3, sampling=sampling, payload=payload)
    assert report.passed and report.violated == ()


def test_laws_hold_in_one_state_and_without_gravity() -> None:
    robot = rttrr_pin.load(random_tree(6, 9), base="floating", gravity=(0, 0, 0))
    assert broken(check_laws(robot, n_states=1)) == []


def test_a_robot_that_cannot_move_keeps_the_laws_that_say_something_of_it() -> None:
    report = check_laws(rttrr_pin.load(random_chain(6, ("fixed", "fixed"))), n_states=20)
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
    "mimicked: drop offset": "the coordinate of a joint that follows another is what this function says",
    "mimicked: negate offset": "likewise",
    "Planar.motion: drop body.p": "it makes another robot; I602 sees it where the frame that carries the joint may move",
    "Planar.motion: negate body.p": "likewise",
}
"""Errors that no law sees in this tree, and why."""


def test_every_law_has_an_error_that_breaks_it() -> None:
    assert list(BREAKS) == IDS


@pytest.fixture(scope="module")
def tree() -> Robot:
    robot = driven(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)))
    assert broken(check_laws(robot, n_states=2)) == []
    return robot


@pytest.mark.one_in(3)
@pytest.mark.parametrize("law", BREAKS)
def test_every_law_is_violated_by_an_error_that_breaks_it(tree: Robot, law: str) -> None:
    with planted(mutant(BREAKS[law])):
        (row,) = check_laws(tree, n_states=2, select=[law]).rows
    assert row.violations == 2 and row.error_over_bound.value > 1e6


@pytest.mark.slow
def test_every_error_is_found_by_a_law(tree: Robot) -> None:
    """Also those in the tenth digit of one term; without the laws of the mass matrix, which take long."""
    batch = Sampler(tree.model, payload=RandomPayload(tree.link_names[-1])).draw(0, 1)
    (load,) = batch.loads
    batch = replace(batch, loads=(load, Load(4, -load.f, load.n, in_base=True)))
    laws = sorted((law for law in LAWS if law.id[0] != "M"), key=lambda law: "EBKSLI".index(law.id[0]))

    def found(error: Mutant) -> bool:
        with planted(error):
            case = Case.of(batch)
            return any((error_over_bound(law, case, 1) > 1.0).any() for law in laws)

    assert {error.id for error in mutants() if not found(error)} == {*UNSEEN, *EQUIVALENT}


def test_a_negative_mass_is_against_the_law(rttrr: Robot) -> None:
    links = list(rttrr.model.links)
    links[4] = replace(links[4], mass=-links[4].mass - 50.0)
    report = check_laws(Robot(replace(rttrr.model, links=tuple(links))), n_states=50)
    assert broken(report) == ["M403"]


def test_interval_arithmetic_proves_the_laws_at_a_state(rttrr: Robot) -> None:
    """At 200 bits the residuals lie in intervals around zero that are far narrower than rounding."""
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
    whole = check_laws(rttrr, n_states=130, seed=5, select=chosen)
    monkeypatch.setattr("rttrr_pin.validation.states.BLOCK", 32)
    seen: list[int] = []
    assert check_laws(rttrr, n_states=130, seed=5, select=chosen, progress=seen.append).rows == whole.rows
    assert seen == [32, 64, 96, 128, 130]


def test_select_takes_prefixes(rttrr: Robot) -> None:
    rows = check_laws(rttrr, n_states=5, select=["M", "E201"]).rows
    assert [row.law.id for row in rows] == ["E201", "M401", "M402", "M403", "M404", "M405"]
    with pytest.raises(UnknownNameError) as raised:
        check_laws(rttrr, n_states=5, select=["X1"])
    assert raised.value.got == "X1"


def test_what_cannot_be_checked_is_an_error(rttrr: Robot) -> None:
    with pytest.raises(InputError, match="n_states is 0"):
        check_laws(rttrr, n_states=0)
    with pytest.raises(InputError, match="no joint"):
        check_laws(Robot(Model("bare", Link("base"), (), ())))
    with pytest.raises(InputError, match="robot is a str"):
        check_laws("rttrr")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="none of these laws can be checked on pinocchio"):
        check_laws(rttrr, "pinocchio", select=["M", "L"])


def test_overflow_is_no_zero(rttrr: Robot) -> None:
    report = check_laws(rttrr, n_states=3, select=["E201"], payload=Wrench((1e308, 1e308, 1e308), (1e308, 0, 0)))
    assert report.rows[0].violations == 1 and not report.passed


def test_one_meaning_of_payload(rttrr: Robot) -> None:
    """None is none; a random one acts at the link that it names, else at the last one."""
    by_default, random, named, none = (
        check_laws(rttrr, n_states=3, select=["E201"], **options)
        for options in ({}, {"payload": RandomPayload()}, {"payload": RandomPayload("tool")}, {"payload": None})
    )
    assert by_default.rows == random.rows == named.rows != none.rows
    assert (by_default.payload, none.payload) == ("random", "none")


# Other programs

BALANCES = ["E201", "E202", "E203", "B301", "B302", "B303", "B304"]


@pytest.mark.parametrize("subject", ["pinocchio", "kernel", "lagrange"])
def test_balances_hold_for_any_program(subject: str) -> None:
    robot = driven(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)))
    report = check_laws(robot, subject, n_states=5)
    assert report.passed
    assert [row.law.id for row in report.rows] == (BALANCES if subject != "lagrange" else ["E201"])
    assert all(row.error_over_bound.value > 0.0 for row in report.rows)


@pytest.mark.parametrize(
    ("quantity", "violated"),
    [
        ("tau", ["E201"]),
        ("F", ["B301"]),
        ("N", ["B302"]),
        ("f", ["E202", "E203", "B303", "B304"]),
        ("n", ["E203", "B304"]),
    ],
)
@pytest.mark.parametrize("size", [1e-6, math.nan, math.inf])
def test_a_wrong_quantity_violates_the_laws_that_read_it(
    rttrr: Robot, quantity: str, violated: list[str], size: float
) -> None:
    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values[quantity][:, 0] += size

    assert broken(check_laws(rttrr, altered(rttrr, spoil), n_states=4)) == violated


def test_a_function_of_the_user_is_checked_without_another_program(rttrr: Robot) -> None:
    def right(q: Any, v: Any, a: Any) -> Any:
        return rttrr.inverse_dynamics(q, v, a).tau

    def without_velocities(q: Any, v: Any, a: Any) -> Any:
        return rttrr.inverse_dynamics(q, 0 * v, a).tau

    reports = [check_laws(rttrr, f, n_states=20, payload=None) for f in (right, without_velocities)]
    assert [broken(report) for report in reports] == [[], ["E201"]]
    assert reports[1].rows[0].violations == 20
    assert reports[1].subject == "without_velocities"


def test_a_table_of_results_is_checked_on_its_own_states(rttrr: Robot, tmp_path: Path) -> None:
    batch = Sampler(rttrr.model).draw(0, 3)
    tau = rttrr.inverse_dynamics(batch.q, batch.v, batch.a).tau
    names = [f"{key}_{name}" for key in ("q", "v", "a", "tau") for name in rttrr.joint_names]
    table = np.hstack([batch.q, batch.v, batch.a, tau])
    table[1, -1] += 1e-6
    path = tmp_path / "results.csv"
    np.savetxt(path, table, "%.17g", ",", header=",".join(names), comments="")
    report = check_laws(rttrr, path, payload=None)
    assert (report.n_states, report.sampling) == (3, "table")
    assert [(row.law.id, row.violations) for row in report.rows] == [("E201", 1)]
    with pytest.raises(InputError, match="no random payload"):
        check_laws(rttrr, path)


# The command


def test_the_command_shows_the_laws(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["laws", "--states", "20"]) == 0
    printed = capsys.readouterr().out
    assert all(identity in printed for identity in IDS)
    assert printed.splitlines()[-1].startswith("PASS")


def test_the_command_fails_with_the_laws_that_are_violated(capsys: pytest.CaptureFixture[str]) -> None:
    with planted(mutant("outwards: square body.M")):
        assert main(["laws", "--states", "20", "--select", "B", "--json", "-"]) == 1
        data = json.loads(capsys.readouterr().out)
        assert main(["laws", "--states", "20", "--select", "B"]) == 1
        printed = capsys.readouterr().out
    assert data["schema"] == 1 and data["passed"] is False
    assert [law for law, row in data["laws"].items() if not row["passed"]] == ["B301", "B303", "B304"]
    assert data["laws"]["B301"]["violations"] == 20
    assert all(LAWS[k].statement in printed for k in range(8) if LAWS[k].id in ("B301", "B303", "B304"))


def test_the_command_checks_other_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["laws", "trr", "--states", "5", "--subject", "pinocchio", "--payload", "none", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["subject"].startswith("pinocchio") and data["payload"] == "none"
    assert list(data["laws"]) == BALANCES


def test_the_page_of_laws_is_the_table(repository: Path) -> None:
    page = (repository / "docs" / "laws.md").read_text()
    for law in LAWS:
        assert f"| {law.id} | {law.name} | {law.statement} |" in page
