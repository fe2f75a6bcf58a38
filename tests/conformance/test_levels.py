"""Levels: their robots have what they ask, their states too, whoever counts them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rttrr_pin import InputError
from rttrr_pin.conformance import LEVELS, Case, Level, cases, level_robot, level_robots
from rttrr_pin.errors import UnknownNameError

ROOT = Path(__file__).parents[2]


def numbers(case: Case) -> np.ndarray:
    """All numbers of the states but quaternions."""
    model, batch = case.robot.model, case.batch
    quaternion = np.zeros(model.nq, dtype=bool)
    for at in model.quaternions:
        quaternion[at : at + 4] = True
    return np.hstack([batch.q[:, ~quaternion], batch.v, batch.a, *(x for own in batch.loads for x in (own.f, own.n))])


def by_id(name: str) -> Level:
    return next(level for level in LEVELS if level.id == name)


def test_files_are_those_of_the_script() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "docs" / "level_robots.py", "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_ids_are_words_and_stand_once() -> None:
    ids = [level.id for level in LEVELS]
    assert len(set(ids)) == len(ids) == 14
    assert all(own.isidentifier() for own in ids)
    assert [level.number for level in LEVELS] == list(range(1, 15))


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.id)
def test_a_level_applies_to_its_robots(level: Level) -> None:
    assert all(level.applies(level_robot(name).model) for name in level.robots)


def test_every_robot_is_asked() -> None:
    assert set(level_robots()) == {name for level in LEVELS for name in level.robots}


@pytest.mark.parametrize("case", cases(n_states=8), ids=lambda case: case.id)
def test_float32_holds_the_states(case: Case) -> None:
    x = numbers(case)
    assert np.array_equal(x, x.astype(np.float32).astype(float))
    assert np.isfinite(x).all()


@pytest.mark.parametrize("few", cases(n_states=3), ids=lambda case: case.id)
def test_a_state_is_the_same_in_any_number(few: Case) -> None:
    many = cases(None if few.name in few.level.robots else [few.robot], [few.level.id], 9)
    other = next(own for own in many if own.id == few.id)
    assert np.array_equal(numbers(few), numbers(other)[:3])
    assert not np.array_equal(numbers(few), numbers(cases(levels=[few.level.id], n_states=3, seed=1)[0])[:3])


def test_what_the_first_levels_leave_out_is_zero() -> None:
    asked = {case.level.id: case.batch for case in cases(levels=["gravity", "rates", "accelerations", "payload"])}
    moving = {own: (bool(batch.v.any()), bool(batch.a.any()), bool(batch.loads)) for own, batch in asked.items()}
    assert moving == {
        "gravity": (False, False, False),
        "rates": (True, False, False),
        "accelerations": (True, True, False),
        "payload": (True, True, True),
    }


def test_fast_is_fast() -> None:
    arm, slide = cases(levels=["fast"], n_states=200)
    assert 290.0 < np.abs(arm.batch.v).max() <= 300.0
    assert np.abs(slide.batch.v[:, ~np.array(slide.robot.model.rotations)]).max() <= 10.0


def test_terms_cancel() -> None:
    """Each driving force is a millionth of its largest term at most: of what accelerations do."""
    for case in cases(levels=["cancelling"]):
        still = np.zeros_like(case.batch.a)
        term = np.abs(case.robot.inverse_dynamics(case.batch.q, case.batch.v, still).tau)
        left = np.abs(case.robot.inverse_dynamics(case.batch.q, case.batch.v, case.batch.a).tau)
        assert np.median(left / term.max(axis=1, keepdims=True)) < 1e-6


def test_own_robots_are_asked_what_applies() -> None:
    assert [case.level.id for case in cases([level_robot("rttrr")], n_states=1)] == [
        "gravity",
        "rates",
        "accelerations",
        "payload",
        "prismatic",
        "fixed",
        "fast",
        "cancelling",
    ]
    assert by_id("floating").id in {case.level.id for case in cases([level_robot("floating")], n_states=1)}


def test_bad_arguments_are_told() -> None:
    with pytest.raises(UnknownNameError, match="gravty"):
        cases(levels=["gravty"])
    with pytest.raises(UnknownNameError, match="arm7"):
        level_robot("arm7")
    with pytest.raises(InputError, match="no level applies"):
        cases([level_robot("rttrr")], ["sixty"])
    with pytest.raises(InputError, match="n_states"):
        cases(n_states=0)
