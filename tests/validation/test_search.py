"""The search for the worst state."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.cli import main
from rttrr_pin.errors import InputError
from rttrr_pin.validation.search import POPULATION, search_worst_state
from support.implementations import altered

FEW = 3 * POPULATION


def test_a_search_comes_to_more_than_chance(rttrr: Robot) -> None:
    worst = search_worst_state(rttrr, evaluations=20 * POPULATION, seed=1, payload=RandomPayload())
    assert worst.of_tolerance > worst.random and worst.passed
    assert abs(worst.evaluations - 20 * POPULATION) <= 2 * POPULATION


def test_the_same_seed_comes_to_the_same_state(rttrr: Robot) -> None:
    one, two, other = (search_worst_state(rttrr, evaluations=FEW, seed=seed) for seed in (4, 4, 5))
    assert (one.of_tolerance, one.quantity, one.at) == (two.of_tolerance, two.quantity, two.at)
    np.testing.assert_array_equal(one.batch.q, two.batch.q)
    assert not np.array_equal(one.batch.q, other.batch.q)


def test_the_state_lies_within_the_ranges_of_uniform_states(rttrr: Robot) -> None:
    payload = Wrench((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    worst = search_worst_state(rttrr, evaluations=FEW, seed=2, payload=payload)
    limits = [(joint.limits.lower, joint.limits.upper) for joint in rttrr.model.moving]
    for q, (lower, upper) in zip(worst.batch.q[0], limits, strict=True):
        assert lower <= q <= upper
    assert len(worst.batch) == 1 and worst.of_tolerance > 0.0


@pytest.mark.slow
def test_a_search_beyond_the_tolerance_says_so(rttrr: Robot) -> None:
    """Against a reference that is wrong in one entry, by less than a random state would show."""

    def spoil(values: dict[str, Any], batch: Any) -> None:
        values["tau"][:, 0] += 2.5e-13 * np.exp(-30 * (batch.q[:, 0] - 1.0) ** 2)

    worst = search_worst_state(rttrr, reference=altered(rttrr, spoil), evaluations=40 * POPULATION)
    assert worst.random < 1.0 < worst.of_tolerance and (worst.quantity, worst.at) == ("tau", "joint_1")
    assert abs(worst.batch.q[0, 0] - 1.0) < 0.5


@pytest.mark.parametrize("evaluations", [0, 511, "many", 10**10])
def test_too_few_or_too_many_evaluations_are_an_error(rttrr: Robot, evaluations: Any) -> None:
    with pytest.raises(InputError, match="evaluations"):
        search_worst_state(rttrr, evaluations=evaluations)


def test_the_command_shows_what_was_reached(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    target = tmp_path / "out.json"
    assert main(["search", "--evaluations", "600", "--seed", "2", "--json", str(target)]) == 0
    assert "states searched, seed 2" in capsys.readouterr().out.replace("\n", " ")
    data = json.loads(target.read_text())
    assert data["evaluations"] >= 512 and data["of_tolerance"] >= data["random"] and len(data["q"]) == 5


def test_a_search_that_makes_no_sense_is_an_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["search", "--evaluations", "3"]) == 2
    assert "from 512" in capsys.readouterr().err
