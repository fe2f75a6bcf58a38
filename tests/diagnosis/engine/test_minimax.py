"""Numbers that are fitted to printed results."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.diagnosis.engine.minimax import minimax
from support.planted import text

NAMES = ("pan", "lift", "wrist")


def test_the_largest_error_is_smallest() -> None:
    """Of the constant nearest to some numbers: the middle of the extremes, not the mean."""
    step = minimax(np.ones((1, 4)), np.array([0.0, 0.0, 0.0, 1.0]), np.ones(4))
    assert step is not None and np.allclose(step, 0.5)


@pytest.mark.slow
def test_ten_numbers_are_found_from_results_of_four_decimals(tmp_path: Path) -> None:
    """Which least squares alone miss: some errors of theirs are above half a unit."""
    robot = rttrr_pin.load(text("turned_inertial"))
    states = rttrr_pin.sample_states(robot, 80, payload=None).states
    other = replace(
        robot.model.links[2], mass=1.9, com=np.array([0.11, 0.02, -0.03]), inertia=np.diag([0.01, 0.02, 0.017])
    )
    wrong = Robot(replace(robot.model, links=(*robot.model.links[:2], other)))
    tau = wrong.inverse_dynamics(states.q, states.v, states.a).tau
    rows = [",".join(f"{key}_{name}" for key in ("q", "v", "a", "tau") for name in NAMES)]
    rows += [
        ",".join([*(repr(float(x)) for x in (*q, *v, *a)), *(f"{x:.4f}" for x in own)])
        for q, v, a, own in zip(states.q, states.v, states.a, tau, strict=True)
    ]
    table = tmp_path / "results.csv"
    table.write_text("\n".join(rows) + "\n")
    result = rttrr_pin.diagnose(robot, table)
    assert [(cause.hypothesis, cause.link) for cause in result.causes] == [("another inertia", "forearm")], (
        result.summary()
    )
