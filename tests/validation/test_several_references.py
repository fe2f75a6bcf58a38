"""Several oracles in one run: the same states for all, a column for each, one verdict, and an umpire between them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import LinkWrenches, Robot
from rttrr_pin.cli import main
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.exact import Adjudication, Assessment, Deviation, verdict_of
from rttrr_pin.validation import compare_state, validate
from rttrr_pin.validation.compare import ADJUDICATED
from rttrr_pin.validation.ours import Ours
from rttrr_pin.validation.report_data import validation_data
from rttrr_pin.validation.search import search
from support.fakes import Liar
from support.trees import random_tree

ALL = ("pinocchio", "mujoco", "lagrange")


@pytest.fixture
def liar(liar: type[Liar], monkeypatch: pytest.MonkeyPatch) -> type[Liar]:
    """Pinocchio with one number changed, under a name of its own."""
    monkeypatch.setattr(liar, "name", "liar")
    return liar


def wrong_in_one(wrenches: LinkWrenches, q: np.ndarray) -> None:
    """F of link 3 where the first angle is large."""
    wrenches.F[:, 2, 0] += 1e-6 * (q[:, 0] > 2.5)


def test_each_oracle_is_seen_as_if_it_were_alone(rttrr: Robot) -> None:
    together = validate(rttrr, 300, 3, "mixed", "random", ALL)
    assert together.agrees
    for other in together.against:
        alone = validate(rttrr, 300, 3, "mixed", "random", other.name)
        assert (other.rows, other.whole) == (alone.rows, alone.whole)
        assert alone.oracle in together.oracle
        assert together.versions[other.name] == other.version


def test_a_run_with_one_oracle_in_a_list_is_that_run(rttrr: Robot) -> None:
    one, listed = validate(rttrr, 50), validate(rttrr, 50, oracle=["pinocchio"])
    assert (one.rows, one.whole, one.oracle, one.failing) == (listed.rows, listed.whole, listed.oracle, listed.failing)
    assert one.adjudicated[0].verdict == listed.adjudicated[0].verdict


def test_ours_is_computed_once_for_all(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    ours = Ours.__call__

    def counted(self: Ours, drawn: Any) -> Any:
        calls.append(len(drawn.q))
        return ours(self, drawn)

    monkeypatch.setattr(Ours, "__call__", counted)
    validate(rttrr, 50, oracle=ALL)
    assert calls == [50, 1]  # the run, and the state that is settled


def test_trees_agree_with_all(rttrr: Robot) -> None:
    robot = rttrr_pin.load(random_tree(4, 6), base="floating", friction=True)
    assert validate(robot, 20, sampling="mixed", oracle=ALL).agrees


def test_one_liar_fails_the_run_and_the_umpire_names_it(rttrr: Robot, liar: type[Liar]) -> None:
    liar.spoil = staticmethod(wrong_in_one)
    result = validate(rttrr, 100, oracle=("pinocchio", "mujoco", "liar"))
    assert [other.agrees for other in result.against] == [True, True, False] and not result.agrees
    assert 0 < result.failing <= ADJUDICATED
    *failing, passing = result.adjudicated_states
    assert len(failing) == result.failing
    for state in failing:
        assert len({one.state for one in state}) == 1
        told = verdict_of(state)
        assert told.startswith("ours, pinocchio and mujoco are right to rounding; liar is off by ")
        assert told.endswith("first in F of link_3")
    assert verdict_of(passing).startswith("all are right to rounding: off are ours by ")


def test_a_state_that_fails_against_several_counts_once(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    ours = Ours.__call__

    def wrong(self: Ours, drawn: Any) -> Any:
        values, bounds = ours(self, drawn)
        values.n[:, 4, 1] *= 1 + 1e-9
        return values, bounds

    monkeypatch.setattr(Ours, "__call__", wrong)
    result = validate(rttrr, 6, oracle=("pinocchio", "mujoco"))
    assert result.failing == 6 and len(result.adjudicated_states) == 6
    told = verdict_of(result.adjudicated_states[0])
    assert told.startswith("pinocchio and mujoco are right to rounding; ours is off by ")
    assert told.endswith("first in n of link_5")


def side(name: str, share: float) -> Assessment:
    return Assessment(name, (Deviation("F", "link_1", 3.0, 0.1), Deviation("tau", "joint_1", 7.0, share)))


@pytest.mark.parametrize(
    ("shares", "told"),
    [
        ((0.1, 0.1, 0.1), "all are right to rounding: off are ours by 7.0 eps (tau of joint_1), a by 7.0"),
        ((9.0, 9.0, 9.0), "none is right: ours is off by 7.0 eps, first in tau of joint_1; a is off by"),
        ((9.0, 0.1, 9.0), "a is right to rounding; ours is off by 7.0 eps, first in tau of joint_1; b is off by"),
        ((0.1, 9.0, 9.0), "ours is right to rounding; a is off by"),
        ((0.1, 9.0, 0.1), "ours and b are right to rounding; a is off by 7.0 eps, first in tau of joint_1"),
    ],
)
def test_the_umpire_s_words(shares: tuple[float, float, float], told: str) -> None:
    ours, a, b = (side(name, share) for name, share in zip(("ours", "a", "b"), shares, strict=True))
    assert verdict_of([Adjudication(3, 128, ours, a), Adjudication(3, 128, ours, b)]).startswith(told)


def test_ours_is_wrong_where_any_settlement_has_it_wrong() -> None:
    """An oracle that gives tau alone still sees all of ours."""
    short = Assessment("ours", (Deviation("tau", "joint_1", 1.0, 0.1),))
    told = verdict_of(
        [Adjudication(3, 128, short, side("a", 0.1)), Adjudication(3, 128, side("ours", 2.0), side("b", 0.1))]
    )
    assert told.startswith("a and b are right to rounding; ours is off")


def test_one_settlement_keeps_its_words() -> None:
    one = Adjudication(3, 128, side("ours", 0.1), side("a", 2.0))
    assert verdict_of([one]) == one.verdict


@pytest.mark.parametrize(
    ("oracles", "message"),
    [
        (("mujoco", "pinocchio", "mujoco"), "'mujoco' is named 2 times"),
        ((), "no oracle is named"),
        (("pinocchio", "bullet"), "no oracle is called 'bullet'"),
    ],
)
def test_bad_lists_of_oracles(rttrr: Robot, oracles: tuple[str, ...], message: str) -> None:
    with pytest.raises((InputError, UnknownNameError), match=message):
        validate(rttrr, 5, oracle=oracles)


def test_one_state_beside_each_oracle(rttrr: Robot) -> None:
    report = compare_state(rttrr, 7, oracle=ALL, states=50)
    assert report.agrees and [view.oracle.split()[0] for view in report.views] == list(ALL)
    for view in report.views:
        alone = compare_state(rttrr, 7, oracle=view.oracle.split()[0], states=50)
        np.testing.assert_array_equal(view.theirs.tau, alone.theirs.tau)
        assert [gap.share[0] for gap in view.gaps] == [gap.share[0] for gap in alone.gaps]
        assert view.adjudicated.verdict == alone.adjudicated.verdict


def test_one_oracle_that_is_off_fails_the_state(rttrr: Robot, liar: type[Liar]) -> None:
    liar.spoil = staticmethod(lambda wrenches, q: wrenches.F.__iadd__(1.0))
    report = compare_state(rttrr, 7, oracle=("pinocchio", "liar"), states=50)
    assert [view.agrees for view in report.views] == [True, False] and not report.agrees


def test_a_search_looks_against_all(rttrr: Robot, liar: type[Liar]) -> None:
    liar.spoil = staticmethod(lambda wrenches, q: wrenches.F.__iadd__(1.0))
    found = search(rttrr, 768, oracle=("pinocchio", "liar"))
    assert found.oracle == "liar" and found.quantity == "F" and not found.agrees
    assert search(rttrr, 768, oracle="pinocchio").oracle == "pinocchio"


# The command


def words(*more: str) -> list[str]:
    return ["validate", "--states", "40", *more, *(word for name in ALL for word in ("--oracle", name))]


def test_the_table_has_a_column_for_each(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert main(words()) == 0
    printed = capsys.readouterr().out
    table = [line for line in printed.splitlines() if line.startswith(("┃", "│"))]
    assert all(name in table[0] for name in ALL) and max(map(len, table)) <= 100
    last = [cell.strip() for cell in table[-1].split("│")[1:-1]]
    assert last[1] == "tool" and last[4] == "" and last[5] == "PASS"
    assert "PASS all of 40 states x 63 rows within rounding" in printed
    assert "settled by balls, worst state" in printed and "all are right to rounding" in printed
    assert "--oracle pinocchio --oracle mujoco --oracle lagrange --state" in printed.replace("\n", " ")


def test_the_table_says_which_oracle_fails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, liar: type[Liar]
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    liar.spoil = staticmethod(wrong_in_one)
    assert main(["validate", "--states", "100", "--oracle", "mujoco", "--oracle", "liar"]) == 1
    printed = capsys.readouterr().out
    (row,) = [line for line in printed.splitlines() if line.startswith("│") and "FAIL" in line]
    cells = [cell.strip() for cell in row.split("│")[1:-1]]
    assert cells[1] == "link_3" and "FAIL" not in cells[2] and cells[3].endswith("FAIL") and cells[4] == "FAIL"
    assert "1 of 58 rows beyond rounding, first F at link_3 against liar" in printed
    assert "ours and mujoco are right to rounding; liar is off by" in printed
    assert "(F at link_3 against liar), in full" in printed


def test_one_state_shows_each_oracle(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words("--state", "3")) == 0
    printed = capsys.readouterr().out
    for name in ALL:
        assert f"ours against {name}" in printed
    assert printed.count("closest to the gate") == 3 and printed.count("settled by balls") == 1


def test_the_command_for_the_worst_state_draws_that_state(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words()) == 0
    printed = capsys.readouterr().out
    again = printed.rsplit("in full: rttrr-pin ", 1)[1].split()
    state = int(again[-1])
    assert main([*again, "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["state"] == state and len(data["oracles"]) == 3


def test_data_of_several_oracles(rttrr: Robot, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words("--search", "600", "--json", "-")) == 0
    data = json.loads(capsys.readouterr().out)
    assert [one["oracle"].split()[0] for one in data["oracles"]] == list(ALL)
    assert data["oracle"] == ", ".join(one["oracle"] for one in data["oracles"])
    assert "F" in data["oracles"][1]["quantities"] and set(data["oracles"][2]["quantities"]) == {"tau"}
    assert all(one["verdict"] == "agree" for one in data["oracles"])
    assert data["worst"]["share"] == max(one["worst"]["share"] for one in data["oracles"])
    assert [one["theirs"]["program"] for one in data["settled"][0]["oracles"]] == list(ALL)
    assert data["search"]["oracle"] in ALL and "quantities" not in data


def test_data_of_one_oracle_have_the_keys_they_had(rttrr: Robot) -> None:
    data = validation_data(validate(rttrr, 20))
    assert {"oracle", "verdict", "worst", "normwise", "quantities", "failing_states", "settled"} <= data.keys()
    assert "oracles" not in data and data["settled"][0].keys() == {"state", "verdict", "bits", "ours", "theirs"}
    assert data["ours"] == "readable recursion"


def test_several_robots_go_against_one_oracle(tmp_path: Path, rttrr: Robot, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.urdf").write_text(rttrr.model.urdf)
    assert main(["validate", str(tmp_path), "--oracle", "mujoco", "--oracle", "lagrange"]) == 2
    assert "--oracle more than once goes with one robot" in capsys.readouterr().err
    assert main(["validate", str(tmp_path), "--oracle", "mujoco", "--states", "5", "--quiet"]) == 0
