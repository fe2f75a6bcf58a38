"""Several references in one run: the same states for all, one verdict, and the exact reference between them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.cli import main
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import compare_state, validate
from rttrr_pin.validation.ranking import ADJUDICATED
from rttrr_pin.validation.search import search_worst_state
from support.implementations import altered
from support.trees import random_tree

ALL = ["pinocchio", "mujoco", "lagrange"]


def wrong_in_one(values: dict[str, Any], batch: Batch) -> None:
    """F of link 3 where the first angle is large."""
    values["F"][:, 2, 0] += 1e-6 * (batch.q[:, 0] > 2.5)


def test_each_reference_is_seen_as_if_it_were_alone(rttrr: Robot) -> None:
    chosen: dict[str, Any] = {"n_states": 300, "seed": 3, "sampling": "mixed", "payload": RandomPayload()}
    together = validate(rttrr, reference=ALL, **chosen)
    assert together.passed
    for other in together.references:
        alone = validate(rttrr, reference=other.name, **chosen)
        assert (other.rows, other.whole) == (alone.rows, alone.whole)
        assert together.versions[other.name] == other.version


def test_the_subject_is_evaluated_once_for_all(rttrr: Robot) -> None:
    subject = altered(rttrr, lambda values, batch: None, "kernel")
    validate(rttrr, subject, ALL, 50)
    assert subject.calls == [50, 1]  # the run, and the state that is adjudicated


@pytest.mark.slow
def test_trees_agree_with_all() -> None:
    robot = rttrr_pin.load(random_tree(4, 6), base="floating", friction=True)
    assert validate(robot, reference=ALL, n_states=20, sampling="mixed").passed


def test_one_wrong_reference_fails_the_run_and_is_named(rttrr: Robot) -> None:
    wrong = altered(rttrr, wrong_in_one, name="wrong")
    result = validate(rttrr, reference=["pinocchio", "mujoco", wrong], n_states=100)
    assert [other.passed for other in result.references] == [True, True, False] and not result.passed
    assert 0 < result.failing <= ADJUDICATED
    *failing, passing = result.adjudications
    assert len(failing) == result.failing and not passing.wrong
    for one in failing:
        assert [side.name for side in one.right] == ["kernel", "pinocchio", "mujoco"]
        (side,) = one.wrong
        assert side.name == "wrong" and side.first_wrong is not None
        assert (side.first_wrong.quantity, side.first_wrong.at) == ("F", "link_3")


def test_a_wrong_subject_fails_against_several_and_counts_once(rttrr: Robot) -> None:
    subject = altered(rttrr, lambda values, batch: values["n"][:, 4].__imul__(1 + 1e-9), "kernel")
    result = validate(rttrr, subject, ["pinocchio", "mujoco"], 6)
    assert result.failing == 6 and len(result.adjudications) == 6
    assert all([side.name for side in one.wrong] == ["altered"] for one in result.adjudications)


def test_one_state_beside_each_reference(rttrr: Robot) -> None:
    report = compare_state(rttrr, 7, reference=ALL)
    assert report.passed and [one.reference.split()[0] for one in report.comparisons] == ALL
    for one in report.comparisons:
        alone = compare_state(rttrr, 7, reference=one.reference.split()[0]).comparisons[0]
        np.testing.assert_array_equal(one.result.values["tau"], alone.result.values["tau"])
        assert [x.of_tolerance[0] for x in one.differences] == [x.of_tolerance[0] for x in alone.differences]


def test_a_search_looks_against_all(rttrr: Robot) -> None:
    wrong = altered(rttrr, lambda values, batch: values["F"].__iadd__(1.0), name="wrong")
    worst = search_worst_state(rttrr, reference=["pinocchio", wrong], evaluations=768)
    assert worst.reference == "wrong" and worst.quantity == "F" and not worst.passed


def words(*more: str) -> list[str]:
    return ["validate", "--states", "40", *more, *(word for name in ALL for word in ("--reference", name))]


def test_the_table_has_a_column_for_each(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    assert main(words("--full")) == 0
    printed = capsys.readouterr().out
    head = next(line for line in printed.splitlines() if "error / tolerance" in line)
    assert all(name in head for name in ALL)


def test_the_command_for_the_worst_state_draws_that_state(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words("--sampling", "mixed")) == 0
    again = capsys.readouterr().out.rsplit("in full: rttrr-pin ", 1)[1].split()
    assert main([*again, "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["state"] == int(again[-1]) and len(data["references"]) == 3


def test_data_of_several_references(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words("--json", "-")) == 0
    data = json.loads(capsys.readouterr().out)
    assert [one["reference"].split()[0] for one in data["references"]] == ALL
    assert set(data["references"][2]["quantities"]) == {"tau"}
    assert all(one["passed"] for one in data["references"])
    assert [one["program"] for one in data["adjudications"][0]["programs"]] == ["kernel", *ALL]


@pytest.mark.slow
def test_several_robots_go_against_one_reference(
    tmp_path: Path, rttrr: Robot, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.urdf").write_text(rttrr.model.urdf)
    assert main(["validate", str(tmp_path), "--reference", "mujoco", "--reference", "lagrange"]) == 2
    assert "--reference more than once goes with one robot" in capsys.readouterr().err
    words = ["validate", str(tmp_path), "--subject", "recursion", "--reference", "mujoco", "--states", "5", "--quiet"]
    assert main(words) == 0
