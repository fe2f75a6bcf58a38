"""What a diagnosis says: who is wrong, in what, how sure that is, and where it shows."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Batch, Evaluation, Robot, diagnose
from rttrr_pin.diagnosis import Diagnosis
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import default_allowance


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def lighter(robot: Robot, link: int, mass: float) -> Any:
    """A program that has another mass of a link, its centre of mass and tensor as they are."""
    pi = np.zeros(len(robot.inertial_parameters()))
    c = robot.model.links[link].com
    pi[10 * link : 10 * link + 4] = mass * np.array([1.0, *c])
    pi[10 * link + 4 : 10 * link + 10] = mass * np.array([np.dot(c, c) * (i == j) - c[i] * c[j] for i, j in PAIRS])

    def tau(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        return robot.inverse_dynamics(q, v, a).tau + robot.regressor(q, v, a) @ pi

    return tau


PAIRS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


class Wrong:
    """An implementation whose driving forces are those of the kernel with something done to them."""

    def __init__(self, robot: Robot, change: Any, name: str = "wrong") -> None:
        self.robot, self.change = robot, change
        self.name, self.version, self.quantities = name, "", ("tau",)

    def evaluate(self, batch: Batch) -> Evaluation:
        tau = self.robot.inverse_dynamics(batch.q, batch.v, batch.a, payload=list(batch.loads) or None).tau
        return Evaluation({"tau": self.change(batch, tau)})


def test_a_mass_is_named_with_its_number(arm: Robot) -> None:
    found = diagnose(arm, lighter(arm, 3, 0.25))
    assert found.verdict == "explained" and not found.passed
    (cause,) = found.causes
    assert cause.link == "link_4" and "mass" in cause.hypothesis
    assert math.isclose(cause.values["mass"], arm.model.links[3].mass + 0.25, rel_tol=1e-9)
    assert found.residual_before > 1e6 and found.residual_after <= 1.0
    assert all(row.after < row.before for row in found.residuals if row.of_tolerance_before > 1e3)


def test_two_right_programs_agree(arm: Robot) -> None:
    found = diagnose(arm, "pinocchio", "recursion")
    assert found.passed and found.verdict == "agrees" and not found.causes and not found.counterexample


def test_the_reference_is_blamed_where_it_is_wrong(arm: Robot) -> None:
    wrong = Wrong(arm, lambda batch, tau: -tau, "reference")
    found = diagnose(arm, "pinocchio", wrong)
    assert found.verdict == "explained"
    assert [(cause.program, cause.hypothesis) for cause in found.causes] == [("reference", "sign of tau")]


@pytest.mark.slow
def test_each_program_has_causes_of_its_own(arm: Robot) -> None:
    twice = Wrong(arm, lambda batch, tau: tau * 1000.0, "in mm")
    found = diagnose(arm, Wrong(arm, lambda batch, tau: -tau, "negative"), twice)
    assert found.verdict == "explained" and found.residual_after <= 1.0
    assert {cause.program for cause in found.causes} == {"negative", "in mm"}


def test_programs_that_are_wrong_alike_agree_with_each_other(arm: Robot) -> None:
    first, second = (Wrong(arm, lambda batch, tau: -tau, name) for name in ("one", "other"))
    assert diagnose(arm, first, second).passed


def test_results_that_are_no_numbers_are_no_agreement(arm: Robot) -> None:
    def change(batch: Batch, tau: np.ndarray) -> np.ndarray:
        return np.where((np.arange(len(tau)) == 5)[:, None], np.nan, tau)

    found = diagnose(arm, Wrong(arm, change), n_states=40)
    assert found.verdict == "unexplained" and not found.passed
    assert any("1 state," in note and "first 5" in note for note in found.notes) and found.dependence
    with pytest.raises(InputError):
        diagnose(arm, Wrong(arm, lambda batch, tau: tau * np.nan), n_states=10)


@pytest.mark.slow
def test_zeros_are_zero(arm: Robot) -> None:
    """Of all joints, or of one; not a mass, a factor or gravity, though at rest without tau there is no gravity."""
    found = diagnose(arm, Wrong(arm, lambda batch, tau: 0.0 * tau), n_states=40)
    assert [cause.hypothesis for cause in found.causes] == [
        "tau missing at every joint"
    ] and found.verdict == "explained"
    found = diagnose(arm, Wrong(arm, lambda batch, tau: tau * (np.arange(5) != 1)), n_states=40)
    assert [(cause.hypothesis, cause.joint) for cause in found.causes] == [("tau missing", "joint_2")]


def test_zeros_of_a_table_at_rest_are_zero(arm: Robot, tmp_path: Path) -> None:
    names = [f"{key}_{name}" for key in ("q", "v", "a", "tau") for name in arm.model.v_names]
    rows = np.hstack([np.random.default_rng(0).uniform(-1, 1, (30, 5)), np.zeros((30, 15))])
    np.savetxt(tmp_path / "zeros.csv", rows, delimiter=",", header=",".join(names), comments="")
    found = diagnose(arm, tmp_path / "zeros.csv")
    assert [cause.hypothesis for cause in found.causes] == ["tau missing at every joint"]


def test_where_nothing_acts_nothing_is_compared(arm: Robot) -> None:
    """Zeros that equal zeros are no agreement: of a robot without mass, and of two programs that give none."""
    empty = Robot(
        replace(arm.model, links=tuple(replace(own, mass=0.0, inertia=0.0 * own.inertia) for own in arm.model.links))
    )
    with pytest.raises(InputError, match="nothing was compared"):
        diagnose(empty, "recursion", n_states=10)
    zero = [Wrong(arm, lambda batch, tau: 0.0 * tau, name) for name in ("one", "other")]
    with pytest.raises(InputError, match="nothing was compared"):
        diagnose(arm, *zero, n_states=10)


def odd(batch: Batch, tau: np.ndarray) -> np.ndarray:
    """Nothing that anybody would do."""
    return tau + 0.1 * np.sin(batch.q) * np.abs(batch.v) ** 2.5


@pytest.fixture(scope="module")
def unexplained() -> Diagnosis:
    robot = rttrr_pin.load("rttrr")
    return diagnose(robot, Wrong(robot, odd), n_states=60)


@pytest.mark.slow
def test_what_nothing_explains_is_not_explained(unexplained: Diagnosis) -> None:
    assert unexplained.verdict == "unexplained" and not unexplained.causes
    assert unexplained.residual_after == unexplained.residual_before
    lines = " ".join(unexplained.dependence)
    assert "zero at rest" in lines and "accelerations do not change it" in lines and "neither linearly" in lines
    assert all(0.0 < near.explains < 1.0 for near in unexplained.near_misses)


@pytest.mark.slow
def test_a_result_is_data(unexplained: Diagnosis) -> None:
    data = json.loads(json.dumps(unexplained.to_dict(), allow_nan=False))
    assert data["schema"] == 1 and data["verdict"] == "unexplained"


@pytest.mark.slow
def test_few_rows_do_not_make_many_numbers_an_explanation(arm: Robot) -> None:
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(3, 5))
    found = diagnose(arm, Wrong(arm, lambda batch, tau: tau + noise[: len(tau)]), n_states=3)
    assert found.verdict == "unexplained"


@pytest.mark.slow
def test_the_same_question_has_the_same_answer(arm: Robot) -> None:
    first, second = (diagnose(arm, lighter(arm, 2, 1.0), n_states=60).to_dict() for _ in range(2))
    assert {**first, "seconds": 0} == {**second, "seconds": 0}


@pytest.mark.slow
def test_the_counterexample_is_a_test_that_fails(arm: Robot) -> None:
    """Pasted beside the program it fails, beside a right one it passes; most of its numbers are zero."""

    def change(batch: Batch, tau: np.ndarray) -> np.ndarray:
        return tau + np.eye(5)[1] * (0.5 * batch.v[:, 0] * batch.v[:, 3])[:, None]

    found = diagnose(arm, Wrong(arm, change), n_states=80)
    assert found.counterexample.count("def test_") == 1

    def run(wrong: bool) -> None:
        def inverse_dynamics(q: list[float], v: list[float], a: list[float]) -> np.ndarray:
            own = Batch(arm.model, *(np.array([x], dtype=float) for x in (q, v, a)))
            tau = arm.inverse_dynamics(own.q, own.v, own.a).tau
            return (change(own, tau) if wrong else tau)[0]

        names: dict[str, Any] = {"inverse_dynamics": inverse_dynamics}
        exec(found.counterexample, names)
        next(value for name, value in names.items() if name.startswith("test_"))()

    run(wrong=False)
    with pytest.raises(AssertionError):
        run(wrong=True)
    assert found.counterexample.count("1") < 40 and "v=[" in found.counterexample
    state = found.counterexample.partition("v=[")[2].partition("]")[0]
    assert sum(float(x) != 0.0 for x in state.split(",")) == 2


@pytest.mark.one_in(2)
@pytest.mark.parametrize("factor", [1e200, 1e305])
def test_results_far_from_any_torque_are_a_difference_and_no_crash(arm: Robot, factor: float) -> None:
    found = diagnose(arm, Wrong(arm, lambda batch, tau: tau * factor), n_states=20)
    assert not found.passed and found.residual_before > 1e6


class Printed(Wrong):
    """The same printed to four digits."""

    def evaluate(self, batch: Batch) -> Evaluation:
        """Results, and half a unit of their last place."""
        tau = super().evaluate(batch).values["tau"]
        unit = 10.0 ** np.floor(np.log10(np.maximum(np.abs(tau), 1e-12)) - 3)
        return Evaluation({"tau": np.round(tau / unit) * unit}, {"tau": 0.5 * unit + 1e-12})


@pytest.mark.slow
def test_a_cause_that_is_barely_more_than_the_digits_is_found(arm: Robot) -> None:
    """Printing leaves more of the difference than half: the cause is computed all the same."""
    found = diagnose(arm, Printed(arm, lambda batch, tau: 1.0001 * tau), n_states=60)
    assert found.verdict == "explained" and found.residual_before < 5.0
    (cause,) = found.causes
    assert cause.hypothesis == "factor of tau" and cause.values["factor"] == 1.0001


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_little_evidence_is_no_explanation(seed: int) -> None:
    """Four states that differ by four times rounding are as good as any of a thousand hypotheses."""
    robot = rttrr_pin.load("trr")
    rng = np.random.default_rng(seed)

    def change(batch: Batch, tau: np.ndarray) -> np.ndarray:
        return tau + 4.0 * default_allowance(batch)["tau"] * noise[: len(tau)]

    noise = rng.uniform(-1.0, 1.0, (4, robot.model.nv))
    assert diagnose(robot, Wrong(robot, change), n_states=4).verdict != "explained"


def test_a_small_difference_in_many_states_is_evidence() -> None:
    robot = rttrr_pin.load("trr")
    found = diagnose(robot, Wrong(robot, lambda batch, tau: tau * (1.0 + 1e-12)), n_states=200)
    assert found.verdict == "explained" and "factor" in found.causes[0].hypothesis


@pytest.mark.slow
def test_the_cause_of_one_program_is_told_where_the_other_is_unexplained() -> None:
    robot = rttrr_pin.load("trr")
    found = diagnose(robot, Wrong(robot, odd, "odd"), Wrong(robot, lambda batch, tau: -tau, "negative"), n_states=30)
    assert found.verdict == "unexplained" and not found.causes
    assert any("opposite sign" in line and "negative" in line for line in found.dependence)
