"""Who is right: planted errors are found in the right program, in the right quantity, at the right link."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.core.model import Model
from rttrr_pin.exact import Adjudication, Assessment, enclose
from rttrr_pin.implementations import Batch, Evaluation
from rttrr_pin.validation import Sampler, compare_state, validate
from rttrr_pin.validation.comparison import adjudicate, true_parameters
from rttrr_pin.validation.ranking import ADJUDICATED, Ranking
from support.implementations import Spoil, altered, evaluated
from support.serial_chains import EXAMPLES

PLACES = [("F", 3), ("N", 4), ("F", 5), ("f", 2), ("n", 4), ("tau", 1), ("tau", 5)]


def other_model(model: Model, link: int, key: str, factor: float = 1 + 1e-9) -> Model:
    """One number of link (counted from 1) altered by a part in 1e9."""
    links, joints = list(model.links), list(model.joints)
    if key == "p":
        joints[link - 1] = replace(joints[link - 1], p=joints[link - 1].p * factor)
    else:
        links[link - 1] = replace(links[link - 1], **{key: getattr(links[link - 1], key) * factor})
    return replace(model, links=tuple(links), joints=tuple(joints))


def from_model(model: Model) -> Spoil:
    """The values of another model's recursion in place of the right ones."""

    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values |= evaluated("recursion", model, batch.q, batch.v, batch.a, batch.loads).values

    return spoil


def judged(robot: Robot, state: int = 0, **spoils: Spoil) -> Adjudication:
    """One state, with the subject or the reference altered."""
    sides: dict[str, Any] = {"subject": "recursion", "reference": "pinocchio"}
    for side, spoil in spoils.items():
        sides[side] = altered(robot, spoil, sides[side], side)
    return compare_state(robot, state, payload=RandomPayload(), **sides).adjudication


def place(assessment: Assessment) -> tuple[str, str]:
    first = assessment.first_wrong
    assert first is not None
    return first.quantity, first.at


@pytest.mark.one_in(10)
@pytest.mark.parametrize("sampling", ["uniform", "corners", "large-velocities"])
def test_both_are_right_at_random_states(robot: Robot, sampling: str) -> None:
    for state in range(4):
        one = compare_state(robot, state, seed=3, sampling=sampling, payload=RandomPayload())
        assert not one.adjudication.wrong


@pytest.mark.parametrize("side", ["subject", "reference"])
@pytest.mark.parametrize(
    ("link", "key", "where"),
    [
        (3, "mass", ("F", "link_3")),
        (4, "com", ("F", "link_4")),
        (4, "inertia", ("N", "link_4")),
        (5, "inertia", ("N", "link_5")),
        (5, "p", ("n", "link_4")),  # along the axis of joint 4: no acceleration depends on it, a lever does
    ],
)
def test_a_wrong_number_of_a_link_is_named_where_it_enters_first(
    rttrr: Robot, side: str, link: int, key: str, where: tuple[str, str]
) -> None:
    """An error in a mass, a place or a tensor shows where that number enters, before anything else follows from it."""
    adjudication = judged(rttrr, 1, **{side: from_model(other_model(rttrr.model, link, key))})
    (wrong,) = adjudication.wrong
    assert wrong.name == side and place(wrong) == where and len(adjudication.right) == 1


@pytest.mark.parametrize(("quantity", "at"), PLACES)
@pytest.mark.parametrize("size", [1e-9, 1e3, math.nan, math.inf])
def test_a_wrong_number_is_named(rttrr: Robot, quantity: str, at: int, size: float) -> None:
    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values[quantity][(0, at - 1) if quantity == "tau" else (0, at - 1, 1)] += size

    (wrong,) = judged(rttrr, 2, reference=spoil).wrong
    where = (quantity, f"{'joint' if quantity == 'tau' else 'link'}_{at}")
    assert place(wrong) == where
    if math.isfinite(size):
        assert [(one.quantity, one.at) for one in wrong.deviations if one.wrong] == [where]
    else:
        assert [(one.quantity, one.at) for one in wrong.deviations if one.eps == math.inf] == [where]


def test_of_several_errors_the_first_on_the_way_of_the_recursion_is_named(rttrr: Robot) -> None:
    """Inward the last link comes first; outward the first one does, and all that is outward is before."""

    def inward(values: dict[str, Any], batch: Batch) -> None:
        values["n"][0, 1:4] += 1.0
        values["tau"][0] += 1.0

    def both(values: dict[str, Any], batch: Batch) -> None:
        inward(values, batch)
        values["N"][0, 1:4] += 1.0

    places = [place(judged(rttrr, reference=spoil).wrong[0]) for spoil in (inward, both)]
    assert places == [("tau", "joint_5"), ("N", "link_2")]


def test_both_can_be_wrong(rttrr: Robot) -> None:
    spoils = {"subject": (4, "inertia"), "reference": (3, "mass")}
    adjudication = judged(rttrr, **{k: from_model(other_model(rttrr.model, *x)) for k, x in spoils.items()})
    assert [place(one) for one in adjudication.wrong] == [("N", "link_4"), ("F", "link_3")]


def test_eps_are_of_the_norm_of_the_true_vector(rttrr: Robot) -> None:
    """F of link 3 lengthened by 1000 eps; a torque is measured by the n of its joint."""

    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values["F"][0, 2] *= 1 + 1000 * 2.0**-52
        values["tau"][0, 3] += 1000 * 2.0**-52 * np.linalg.norm(values["n"][0, 3])

    (wrong,) = judged(rttrr, reference=spoil).wrong
    eps = {(one.quantity, one.at): one.eps for one in wrong.deviations}
    assert 995 < eps["F", "link_3"] < 1005 and 950 < eps["tau", "joint_4"] < 1050


@pytest.mark.parametrize("name", ["rttrr", "any-axes", "fixed-between"])
def test_within_an_enclosure_there_is_no_deviation(name: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(name, name))
    batch = Sampler(robot.model).draw(0, 1)
    enclosures = enclose(robot.model, batch.q, batch.v, batch.a, (), true_parameters(robot.model))
    allowance = evaluated("recursion", robot.model, batch.q, batch.v, batch.a).allowance
    for end in ("lower", "upper"):
        truth = Evaluation({key: getattr(ends, end) for key, ends in enclosures.items()}, allowance)
        (one,) = adjudicate(batch, [("x", truth)]).assessments
        assert {deviation.eps for deviation in one.deviations} == {0.0}


def test_each_is_judged_by_its_own_allowance(rttrr: Robot) -> None:
    """Half as far again as one may be is too far for it, and not for one that may be twice as far."""
    batch = Sampler(rttrr.model).draw(0, 1)
    right = evaluated("recursion", rttrr.model, batch.q, batch.v, batch.a)
    assert right.allowance is not None
    enclosures = enclose(rttrr.model, batch.q, batch.v, batch.a, (), true_parameters(rttrr.model))
    values = {**right.values, "tau": enclosures.tau.mid + 1.5 * right.allowance["tau"]}
    wide = {key: 2 * x for key, x in right.allowance.items()}
    own, other = adjudicate(
        batch, [("x", Evaluation(values, right.allowance)), ("y", Evaluation(values, wide))]
    ).assessments
    assert not own.right and place(own)[0] == "tau" and other.right


def test_who_decides(rttrr: Robot) -> None:
    """The file; where the model is not what the file says, the model."""
    assert true_parameters(rttrr.model) == "read"
    assert true_parameters(other_model(rttrr.model, 3, "mass")) == "doubles"
    assert true_parameters(replace(rttrr.model, document=None)) == "doubles"


def beyond(limit: float) -> Callable[[dict[str, Any], Batch], None]:
    """F of link 3 is wrong where the first angle is beyond a limit: the more, the farther beyond."""
    return lambda values, batch: values["F"][:, 2, 0].__iadd__(np.maximum(batch.q[:, 0] - limit, 0.0))


def ratio_at(robot: Robot, reference: Any, state: int) -> float:
    """The largest error / tolerance of one state."""
    (comparison,) = compare_state(robot, state, "kernel", reference).comparisons
    return max(float(one.of_tolerance[0]) for one in comparison.differences)


@pytest.mark.parametrize(("limit", "several"), [(2.5, False), (1.0, True)])
def test_a_run_adjudicates_the_worst_failing_states_and_the_worst_passing_one(
    rttrr: Robot, monkeypatch: pytest.MonkeyPatch, limit: float, several: bool
) -> None:
    monkeypatch.setattr("rttrr_pin.validation.states.BLOCK", 64)
    wrong = altered(rttrr, beyond(limit))
    result = validate(rttrr, "kernel", wrong, 150)
    assert result.worst is not None
    q = Sampler(rttrr.model).draw(0, 150).q[:, 0]
    assert 0 < result.failing == (q > limit).sum() and (result.failing > ADJUDICATED) == several
    *failing, passing = result.adjudications
    assert len(failing) == min(result.failing, ADJUDICATED) and all(q[one.state] > limit for one in failing)
    ratios = [ratio_at(rttrr, wrong, one.state) for one in failing]
    assert ratios == sorted(ratios, reverse=True) and ratios[0] == result.worst.of_tolerance.value
    for one in failing:
        assert [place(side) for side in one.wrong] == [("F", "link_3")]
    assert not passing.wrong and q[passing.state] <= limit


def test_where_all_agree_the_worst_state_is_adjudicated(rttrr: Robot) -> None:
    result = validate(rttrr, n_states=300)
    assert result.failing == 0 and result.worst is not None
    assert [one.state for one in result.adjudications] == [result.worst.of_tolerance.state]


def test_where_none_agrees_there_is_no_passing_state(rttrr: Robot) -> None:
    result = validate(rttrr, "kernel", altered(rttrr, beyond(-10.0)), 30)
    assert result.failing == 30 and len(result.adjudications) == ADJUDICATED


def test_the_ranking_does_not_depend_on_blocks() -> None:
    ratios = np.array([0.2, 3.0, np.inf, 0.9, 3.0, np.inf, 0.9, *np.linspace(1.5, 2, 12)])
    whole, cut = Ranking(), Ranking()
    whole.see(ratios, 5)
    for k in range(0, len(ratios), 2):
        cut.see(ratios[k : k + 2], 5 + k)
    assert whole == cut
    assert whole.failing == 16 and whole.chosen()[:5] == [7, 10, 6, 9, 23] and whole.chosen()[-1] == 8
