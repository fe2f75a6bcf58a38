"""Judging: no false alarm, in either precision, and every planted fault where its level asks for it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rttrr_pin import InputError, JointEffects
from rttrr_pin.conformance import Case, cases, conform, judge, level_robot
from rttrr_pin.conformance.judging import precision_of
from rttrr_pin.conformance.results import BINS
from rttrr_pin.core.model import Model
from rttrr_pin.implementations import Batch, Evaluation, default_allowance, make_implementation
from rttrr_pin.implementations.allowance import SINGLE
from support.implementations import Altered
from support.planted_levels import PLANTED
from support.single import SingleRecursion, SingleSpatial, single_ratios, with_mass

CASES = cases(n_states=4)

ARM = next(case for case in CASES if case.id == "accelerations-arm6")


def recursion(case: Case, spoil: Any = lambda values, batch: None) -> Altered:
    return Altered(make_implementation("recursion", case.robot.model), spoil)


@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    "name",
    [
        "recursion",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("kernel", "lagrange")),
        "pinocchio",
        "mujoco",
    ],
)
def test_right_programs_pass_every_level(name: str) -> None:
    result = conform(name, n_states=4)
    assert result.standing.whole and result.passed, result.summary()
    assert result.precision == "float64"
    assert result.claim() == ("14 of 14, tau alone" if name == "lagrange" else "14 of 14")


@pytest.mark.one_in(10)
@pytest.mark.parametrize("fault", PLANTED)
def test_a_planted_fault_fails_at_its_level(fault: str) -> None:
    """The first that fails is the one that asks for it; where only one asks, it is the only one."""
    program, first, only = PLANTED[fault]
    standing = conform(program, n_states=2, diagnose=False).standing
    assert standing.failed[0] == first
    assert only is None or set(standing.failed) == only


@pytest.mark.one_in(2)
@pytest.mark.parametrize("program", [SingleRecursion, SingleSpatial])
def test_single_precision_is_found_out_and_passes(program: Any) -> None:
    result = conform(program, n_states=4)
    assert result.precision == "float32"
    assert result.passed, result.summary()
    assert result.standing.not_offered == (("payload",) if program is SingleSpatial else ())
    assert not any(own.digits > 7.3 for own in result.results)
    medians = [part.median for own in result.results for part in own.quantities if not np.isnan(part.median)]
    assert 0.1 < np.median(medians) < 30.0


@pytest.mark.parametrize("n_states", [300, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("program", [SingleRecursion, SingleSpatial])
def test_rounding_to_single_precision_is_never_a_fault(n_states: int, program: Any) -> None:
    """Also of the numbers of the robot, in two formulations; sixty joints included."""
    for case in cases(n_states=n_states):
        if program is SingleRecursion or not case.batch.loads:
            worst = max(single_ratios(case, program))
            assert 0.0 < worst < 0.2, case.id


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_a_mass_off_by_a_thousandth_is_seen_in_single_precision(case: Case) -> None:
    """Where float32 shows it: in F of the link, here of the first that has a mass."""
    model = case.robot.model
    link = next(i for i, own in enumerate(model.links) if own.mass)
    result = judge(case, SingleRecursion(with_mass(model, link, 1.001)), "float32")
    assert result.outcome == "fail"
    assert result.worst is not None and result.worst[0] == "F" and result.worst[1].at == model.link_names[link]


def test_a_single_precision_program_fails_as_a_double_one() -> None:
    assert judge(ARM, SingleRecursion(ARM.robot.model), "float64").outcome == "fail"
    assert judge(ARM, SingleRecursion(ARM.robot.model), "float32").outcome == "pass"
    assert judge(ARM, SingleRecursion(ARM.robot.model)).precision == "float32"


def test_a_function_of_single_precision_is_judged_as_wanted() -> None:
    def single(q: Any, v: Any, a: Any) -> Any:
        return ARM.robot.inverse_dynamics(q, v, a).tau.astype(np.float32)

    asked: dict[str, Any] = {"robots": [ARM.robot], "levels": ["rates"], "n_states": 4, "diagnose": False}
    assert conform(single, **asked).passed
    assert conform(single, **asked, precision="float32").passed
    assert not conform(single, **asked, precision="float64").passed


def test_few_numbers_of_a_float32_function_are_no_more_than_that() -> None:
    def single(q: Any, v: Any, a: Any) -> Any:
        return ARM.robot.inverse_dynamics(q, v, a).tau.astype(np.float32)

    result = conform(single, [ARM.robot], ["gravity"], n_states=1)
    assert result.passed and result.precision == "float32"


def test_nobody_sets_the_bar_for_his_own_numbers() -> None:
    """Neither by an allowance nor by a type of three digits: what is claimed is rounding of float64 or float32."""

    class Generous:
        name, version, quantities = "generous", "1", ("tau",)

        def __init__(self, model: Model) -> None:
            self.nv = model.nv

        def evaluate(self, batch: Batch) -> Evaluation:
            rows = np.zeros((len(batch), self.nv))
            return Evaluation({"tau": rows}, {"tau": rows + 1e9})

    def half(q: Any, v: Any, a: Any) -> Any:
        return ARM.robot.inverse_dynamics(q, v, a).tau.astype(np.float16)

    asked: dict[str, Any] = {"robots": [ARM.robot], "levels": ["rates"], "n_states": 4, "diagnose": False}
    assert not conform(Generous, **asked).passed
    assert not conform(half, **asked).passed and not conform(half, **asked).notes
    assert judge(ARM, make_implementation(half, ARM.robot.model)).outcome == "fail"


DOUBLES = np.random.default_rng(0).normal(size=40)
SINGLES = DOUBLES.astype(np.float32)

NUMBERS = {
    "doubles": (DOUBLES, "float64"),
    "singles": (SINGLES.astype(float), "float32"),
    "singles, printed": (np.array([float(str(x)) for x in SINGLES]), "float32"),
    "singles, nine digits": (np.array([float(f"{x:.9g}") for x in SINGLES]), "float32"),
    "doubles, nine digits": (np.array([float(f"{x:.9g}") for x in DOUBLES]), "float64"),
    "doubles, eight digits": (np.array([float(f"{x:.8g}") for x in DOUBLES]), "float64"),
    "doubles, six digits": (np.array([float(f"{x:.6g}") for x in DOUBLES]), "float64"),
    "small integers": (np.arange(40.0), "float64"),
    "quarters": (np.arange(40.0) / 4, "float64"),
    "few": (SINGLES[:10].astype(float), "float64"),
    "one of them a double": (np.append(SINGLES.astype(float), 1 / 3), "float64"),
    "no numbers among them": (np.append(SINGLES.astype(float), [np.nan, np.inf, 0.0]), "float32"),
    "the same one": (np.full(40, SINGLES[0], dtype=float), "float64"),
    "none": (np.zeros(0), "float64"),
}


@pytest.mark.parametrize("kind", NUMBERS)
def test_precision_is_found_in_the_numbers(kind: str) -> None:
    numbers, name = NUMBERS[kind]
    assert precision_of([{"tau": numbers}]).name == name


def test_what_is_not_finite_is_a_failure() -> None:
    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values["n"][1, 2, 0], values["tau"][0, 0] = np.nan, np.inf

    result = judge(ARM, recursion(ARM, spoil))
    assert result.outcome == "fail" and result.digits < 15
    parts = {own.quantity: own for own in result.quantities}
    assert (parts["n"].failures, parts["n"].not_finite) == (parts["tau"].failures, parts["tau"].not_finite) == (1, 1)
    worst = parts["n"].worst
    assert (worst.at, worst.state, worst.error) == ("link_3", 1, np.inf) and np.isnan(worst.eps)


def test_no_digit_is_no_less_than_none() -> None:
    def zero(values: Any, batch: Batch) -> None:
        values["tau"][:] = 0.0

    assert f"{judge(ARM, recursion(ARM, zero)).digits:.1f}" == "0.0"


def test_every_number_stands_in_one_bin() -> None:
    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values["f"][:, 1] *= 1.0 + 1e-9

    result = judge(ARM, recursion(ARM, spoil))
    for own in result.quantities:
        assert own.count == len(ARM.batch) * (6 if own.quantity == "tau" else len(ARM.robot.link_names))
        assert sum(own.histogram) + own.near_zero + own.failures == own.count
        assert len(own.histogram) == len(BINS) + 1
    of_f = next(own for own in result.quantities if own.quantity == "f")
    assert of_f.failures == len(ARM.batch) and of_f.worst.at == "link_2"
    assert of_f.worst.eps == pytest.approx(1e-9 * 2**52, rel=1e-4) and of_f.digits == pytest.approx(9.0, abs=0.01)


def test_errors_are_counted_in_eps() -> None:
    """A vector that is off by three eps of its length."""

    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values["f"][:] *= 1.0 + 48 * 2.0**-52

    of_f = next(own for own in judge(ARM, recursion(ARM, spoil)).quantities if own.quantity == "f")
    assert 40 < of_f.median < 56
    assert sum(of_f.histogram[BINS.index(64.0) :]) + of_f.failures >= of_f.count * 0.9


class Refusing:
    name, version, quantities = "refusing", "", ("tau",)

    def __init__(self, error: Exception) -> None:
        self.error = error

    def evaluate(self, batch: Batch) -> Evaluation:
        raise self.error


def test_a_refusal_is_no_failure_and_a_crash_is_one() -> None:
    refused = judge(ARM, Refusing(NotImplementedError("trees only")))
    assert (refused.outcome, refused.passed, refused.failed) == ("not offered", False, False)
    assert "trees only" in refused.message and refused.quantities == ()
    crashed = judge(ARM, Refusing(ValueError("boom")))
    assert (crashed.outcome, crashed.failed) == ("error", True) and "boom" in crashed.message


def test_no_quantity_is_an_error() -> None:
    class Nothing(Refusing):
        quantities = ()  # type: ignore[assignment]

        def evaluate(self, batch: Batch) -> Evaluation:
            return Evaluation({})

    assert judge(ARM, Nothing(ValueError())).outcome == "error"


def test_there_is_no_other_precision() -> None:
    with pytest.raises(InputError, match="float16"):
        judge(ARM, recursion(ARM), "float16")  # type: ignore[arg-type]


def test_armature_and_damping_that_cancel_are_no_false_alarm() -> None:
    """What joints take adds up from terms, of which each is rounded: 1000 a - 1000 v, beside bodies of some grams."""
    robot = level_robot("small")
    effects = JointEffects(armature=1e3, damping=1e3)
    model = robot.with_joint_effects(dict.fromkeys(robot.joint_names, effects)).model
    v = np.random.default_rng(0).uniform(1.0, 2.0, (50, model.nv)).astype(np.float32).astype(float)
    batch = Batch(model, np.zeros((50, model.nq)), v, -v * (1 + 2.0**-20))
    values, bounds = batch.recursion
    error = np.abs(SingleRecursion(model).evaluate(batch).values["tau"] - values.tau)
    assert (error <= default_allowance(batch, SINGLE)["tau"] + np.abs(bounds.tau)).all()
    assert (default_allowance(batch)["tau"] > 4 * 2.0**-52 * 1e3 * v).all()
