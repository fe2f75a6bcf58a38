"""Settlements: planted errors are found on the right side, in the right quantity, at the right link; rounding is none."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import LinkWrenches, Robot
from rttrr_pin.cli import main
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.exact import Adjudication, Assessment, Deviation, bounded_dynamics, enclose
from rttrr_pin.exact.adjudication import in_order, walk
from rttrr_pin.implementations import Evaluation, make_oracle
from rttrr_pin.reporting.files import as_json
from rttrr_pin.validation import Sampler, compare_state, validate
from rttrr_pin.validation import ours as ours_module
from rttrr_pin.validation.adjudicate import adjudicate, true_numbers
from rttrr_pin.validation.compare import ADJUDICATED, Ranking
from rttrr_pin.validation.report_data import state_data, validation_data
from support.fakes import Liar
from support.serial_chains import EXAMPLES
from support.slow import slow_after
from support.trees import random_tree

PLACES = [("F", 3), ("N", 4), ("F", 5), ("f", 2), ("n", 4), ("tau", 1), ("tau", 5)]


def adjudicated(
    robot: Robot, state: int = 0, ours: Model | None = None, theirs: Model | None = None, spoil: Any = None
) -> Adjudication:
    """One state, where ours or the oracle compute with another model, or a number of the oracle's is changed."""
    drawn = Sampler(robot.model, payload=robot.link_names[-1]).draw(state, 1)
    arrays = (drawn.q, drawn.v, drawn.a, drawn.loads)
    values, bound = bounded_dynamics(ours or robot.model, *arrays)
    evaluation = make_oracle("pinocchio", robot.model).evaluate(*arrays)
    if theirs is not None:
        evaluation = Evaluation(bounded_dynamics(theirs, *arrays)[0], evaluation.rounding)
    if spoil is not None:
        spoil(evaluation.wrenches)
    enclosures = enclose(robot.model, *arrays, true_numbers(robot.model))
    return adjudicate(robot.model, enclosures, values, evaluation, bound, "pinocchio", state)


def altered(model: Model, link: int, key: str, factor: float = 1 + 1e-9) -> Model:
    """One number of link (counted from 1) altered by a part in 1e9."""
    links, joints = list(model.links), list(model.joints)
    if key == "p":
        joints[link - 1] = replace(joints[link - 1], p=joints[link - 1].p * factor)
    else:
        links[link - 1] = replace(links[link - 1], **{key: getattr(links[link - 1], key) * factor})
    return replace(model, links=tuple(links), joints=tuple(joints))


@pytest.mark.parametrize("sampling", slow_after(1, ["large-velocities", "uniform", "corners"]))
def test_both_are_right_at_random_states(robot: Robot, sampling: str) -> None:
    for state in range(8):
        adjudication = compare_state(robot, state, 3, sampling, "random").adjudicated
        assert adjudication.right == (True, True), adjudication.verdict
        assert adjudication.verdict.startswith("both are right to rounding: ours is off by ")


@pytest.mark.parametrize("side", ["ours", "theirs"])
@pytest.mark.parametrize(
    ("link", "key", "place"),
    [
        (3, "mass", "F of link_3"),
        (4, "com", "F of link_4"),
        (5, "com", "F of link_5"),
        (4, "inertia", "N of link_4"),
        (5, "inertia", "N of link_5"),
        (5, "p", "n of link_4"),  # along the axis of joint 4: no acceleration depends on it, a lever does
    ],
)
def test_a_wrong_number_of_a_link_is_named_where_it_enters_first(
    rttrr: Robot, side: Any, link: int, key: str, place: str
) -> None:
    """An error in a mass, a place or a tensor shows where that number enters, before anything else follows from it."""
    adjudication = adjudicated(rttrr, 1, **{side: altered(rttrr.model, link, key)})
    wrong, right = (adjudication.ours, adjudication.theirs)[:: 1 if side == "ours" else -1]
    assert right.first is None
    assert wrong.first is not None
    assert wrong.first.place == place
    assert adjudication.right == ((False, True) if side == "ours" else (True, False))
    told = f"{wrong.name} is off by {wrong.error}"
    assert adjudication.verdict == f"{right.name} is right to {right.error}; {told}"
    assert told.endswith(f"eps, first in {place}")


@pytest.mark.parametrize(("quantity", "place"), PLACES)
@pytest.mark.parametrize("size", [1e-9, 1e3, math.nan, math.inf])
def test_a_wrong_number_of_the_oracle_is_named(rttrr: Robot, quantity: str, place: int, size: float) -> None:
    def spoil(wrenches: LinkWrenches) -> None:
        array = getattr(wrenches, quantity)
        array[(0, place - 1) if quantity == "tau" else (0, place - 1, 1)] += size

    adjudication = adjudicated(rttrr, 2, spoil=spoil)
    first = adjudication.theirs.first
    assert adjudication.right == (True, False)
    assert first is not None
    assert (first.quantity, first.at) == (quantity, f"{'joint' if quantity == 'tau' else 'link'}_{place}")
    if math.isfinite(size):
        off = adjudication.theirs.deviations
        assert [one.place for one in off if one.wrong] == [first.place]
    else:
        assert [one.place for one in adjudication.theirs.deviations if one.eps == math.inf] == [first.place]


def test_of_several_errors_the_first_on_the_walk_is_named(rttrr: Robot) -> None:
    """Inward the last link comes first; outward the first one does, and all that is outward is before."""

    def inward(wrenches: LinkWrenches) -> None:
        wrenches.n[0, 1:4] += 1.0
        wrenches.tau[0] += 1.0

    def both(wrenches: LinkWrenches) -> None:
        inward(wrenches)
        wrenches.N[0, 1:4] += 1.0

    first = [adjudicated(rttrr, spoil=spoil).theirs.first for spoil in (inward, both)]
    assert [off and off.place for off in first] == ["tau of joint_5", "N of link_2"]


def test_both_can_be_off(rttrr: Robot) -> None:
    adjudication = adjudicated(rttrr, ours=altered(rttrr.model, 4, "inertia"), theirs=altered(rttrr.model, 3, "mass"))
    assert adjudication.right == (False, False)
    assert adjudication.verdict.startswith("both are off: ours by ")
    assert "first in N of link_4; pinocchio by " in adjudication.verdict
    assert adjudication.verdict.endswith("first in F of link_3")


def test_eps_are_of_the_norm_of_the_true_vector(rttrr: Robot) -> None:
    """F of link 3 lengthened by 1000 eps; a torque is measured by the n of its joint."""

    def spoil(wrenches: LinkWrenches) -> None:
        wrenches.F[0, 2] *= 1 + 1000 * 2.0**-52
        wrenches.tau[0, 3] += 1000 * 2.0**-52 * np.linalg.norm(wrenches.n[0, 3])

    deviations = {off.place: off.eps for off in adjudicated(rttrr, spoil=spoil).theirs.deviations}
    assert 995 < deviations["F of link_3"] < 1005
    assert 950 < deviations["tau of joint_4"] < 1050


@pytest.mark.parametrize("name", ["rttrr", "any-axes", "fixed-between"])
def test_within_an_enclosure_nothing_is_off(name: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(name, name))
    drawn = Sampler(robot.model).draw(0, 1)
    values, bound = bounded_dynamics(robot.model, drawn.q, drawn.v, drawn.a)
    enclosures = enclose(robot.model, drawn.q, drawn.v, drawn.a)
    zero = {key: np.zeros((1, len(robot.link_names))) for key in LINK_QUANTITIES}
    for end in ("lower", "upper"):
        parts = {key: getattr(ends, end) for key, ends in enclosures.items()}
        truth = LinkWrenches.of(parts | {"tau_joint": values.tau_joint}, values.links, values.joints)
        adjudication = adjudicate(robot.model, enclosures, truth, Evaluation(truth, zero), bound, "x")
        assert {off.eps for side in (adjudication.ours, adjudication.theirs) for off in side.deviations} == {0.0}


def test_each_is_held_to_its_own_half_of_the_gate(rttrr: Robot) -> None:
    """Half as far again as ours may be is too far for ours, and not for an oracle that sums in another order."""
    drawn = Sampler(rttrr.model).draw(0, 1)
    values, bound = bounded_dynamics(rttrr.model, drawn.q, drawn.v, drawn.a)
    enclosures = enclose(rttrr.model, drawn.q, drawn.v, drawn.a)
    off = replace(values, tau=enclosures.tau.mid + 1.5 * bound.tau)
    rounding = {key: np.zeros((1, len(rttrr.link_names))) for key in LINK_QUANTITIES}
    adjudication = adjudicate(rttrr.model, enclosures, off, Evaluation(off, rounding), bound, "x")
    assert adjudication.right == (False, True)
    assert adjudication.ours.first is not None and adjudication.ours.first.quantity == "tau"


@pytest.mark.parametrize("seed", range(8))
def test_the_walk_meets_everything_once_and_causes_first(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 12), base="floating").model
    steps = list(walk(model))
    assert len(steps) == len(set(steps)) == 4 * len(model.links) + model.nv
    at = {step: k for k, step in enumerate(steps)}
    column = 0
    for i in model.independent:
        made_of = [i, *(k for k, joint in enumerate(model.joints) if joint.mimic and joint.mimic.joint == i)]
        for k in range(column, column + model.joints[i].nv):
            assert all(at["tau", k] > max(at["f", link], at["n", link]) for link in made_of)
        column += model.joints[i].nv
    for i, joint in enumerate(model.joints):
        if joint.parent >= 0:
            assert at["F", joint.parent] < at["F", i] and at["n", joint.parent] > at["n", i]
    assert max(at["N", i] for i in range(len(model.links))) < min(at["f", i] for i in range(len(model.links)))


def test_the_walk_names_rows_as_reports_do(rttrr: Robot) -> None:
    rows = validate(rttrr, 2).rows
    deviations = in_order(rttrr.model, [Deviation(row.quantity, row.at, 0.0, 0.0) for row in rows])
    assert [off.place for off in deviations[:3]] == ["F of link_1", "N of link_1", "F of link_2"]
    assert [off.place for off in deviations[12:17]] == [
        "f of tool",
        "n of tool",
        "f of link_5",
        "n of link_5",
        "tau of joint_5",
    ]
    assert sorted((off.quantity, off.at) for off in deviations) == sorted((row.quantity, row.at) for row in rows)


def test_who_decides(rttrr: Robot) -> None:
    """The file; where the model is not what the file says, the model."""
    assert true_numbers(rttrr.model) == "read"
    assert true_numbers(altered(rttrr.model, 3, "mass")) == "doubles"
    assert true_numbers(replace(rttrr.model, document=None)) == "doubles"


# In a run


def in_some_states(every: float) -> Callable[[LinkWrenches, np.ndarray], None]:
    """An oracle whose F of link 3 is wrong where the first angle is beyond a limit: the more, the farther beyond."""

    def spoil(wrenches: LinkWrenches, q: np.ndarray) -> None:
        wrenches.F[:, 2, 0] += np.maximum(q[:, 0] - every, 0.0)

    return spoil


@pytest.mark.parametrize(("limit", "several"), [(2.5, False), (1.0, True)])
def test_a_run_settles_the_worst_failing_states_and_the_worst_passing_one(
    rttrr: Robot, liar: type[Liar], monkeypatch: pytest.MonkeyPatch, limit: float, several: bool
) -> None:
    liar.spoil = staticmethod(in_some_states(limit))
    monkeypatch.setattr("rttrr_pin.validation.run.BLOCK", 64)
    result = validate(rttrr, 150, oracle="liar")
    q = Sampler(rttrr.model).draw(0, 150).q[:, 0]
    assert 0 < result.failing == (q > limit).sum()
    assert (result.failing > ADJUDICATED) == several
    *failing, passing = result.adjudicated
    shares = [max(gap.share[0] for gap in compare_state(rttrr, k, oracle="liar", states=150).gaps) for k in range(150)]
    assert [one.state for one in failing] == sorted(np.flatnonzero(q > limit), key=lambda k: -shares[k])[:ADJUDICATED]
    assert passing.state == max(np.flatnonzero(q <= limit), key=lambda k: shares[k])
    for one in failing:
        assert one.verdict.startswith("ours is right to ") and one.verdict.endswith("first in F of link_3")
    assert passing.right == (True, True) and q[passing.state] <= limit


def test_where_all_agree_the_worst_state_is_settled(rttrr: Robot) -> None:
    result = validate(rttrr, 300)
    assert result.failing == 0 and result.worst is not None
    assert [one.state for one in result.adjudicated] == [result.worst.share.state]


def test_where_none_agrees_there_is_no_passing_state(rttrr: Robot, liar: type[Liar]) -> None:
    liar.spoil = staticmethod(in_some_states(-10.0))
    result = validate(rttrr, 30, oracle="liar")
    assert result.failing == 30 and len(result.adjudicated) == ADJUDICATED


def test_a_wrong_recursion_of_ours_is_ours(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = altered(rttrr.model, 4, "inertia")
    monkeypatch.setattr(ours_module, "bounded_dynamics", lambda model, *arrays: bounded_dynamics(wrong, *arrays))
    result = validate(rttrr, 40)
    assert result.adjudicated
    for one in result.adjudicated[: min(result.failing, ADJUDICATED)]:
        assert one.verdict.startswith("pinocchio is right to ")
        assert "; ours is off by " in one.verdict and one.verdict.endswith("first in N of link_4")


def test_the_ranking_does_not_depend_on_blocks() -> None:
    shares = np.array([0.2, 3.0, np.inf, 0.9, 3.0, np.inf, 0.9, *np.linspace(1.5, 2, 12)])
    whole, cut = Ranking(), Ranking()
    whole.see(shares, 5)
    for k in range(0, len(shares), 2):
        cut.see(shares[k : k + 2], 5 + k)
    assert whole == cut
    assert whole.failing == 16 and whole.chosen()[:5] == [7, 10, 6, 9, 23] and whole.chosen()[-1] == 8


def test_the_report_says_who_is_right(
    rttrr: Robot, liar: type[Liar], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    liar.spoil = staticmethod(in_some_states(1.0))
    assert main(["validate", "--states", "500", "--oracle", "liar"]) == 1
    printed = capsys.readouterr().out
    failing = validate(rttrr, 500, oracle="liar").failing
    assert f"settled by balls, the {ADJUDICATED} worst of {failing} failing states:" in printed
    assert printed.count("is off by") == ADJUDICATED + 1
    assert "worst passing state" in printed
    state = validate(rttrr, 500, oracle="liar").adjudicated[0].state
    assert main(["validate", "--state", str(state), "--oracle", "liar"]) == 1
    assert "settled by balls of 128 bits: ours is right to" in capsys.readouterr().out


def test_data_say_who_is_right(rttrr: Robot, liar: type[Liar]) -> None:
    liar.spoil = staticmethod(in_some_states(2.5))
    result = validate(rttrr, 150, oracle="liar")
    data = json.loads(as_json(validation_data(result)))
    assert data["failing_states"] == result.failing == len(data["settled"]) - 1
    one = data["settled"][0]
    assert one["ours"]["right"] is True and one["theirs"]["right"] is False
    assert one["theirs"]["program"] == "pinocchio"
    assert (one["theirs"]["first_wrong"]["quantity"], one["theirs"]["first_wrong"]["at"]) == ("F", "link_3")
    assert one["ours"]["first_wrong"] is None
    again = state_data(compare_state(rttrr, one["state"], oracle="liar", states=150))["settled"]
    assert again == one


def test_words_for_eps() -> None:
    deviations = (Deviation("F", "link_1", 2.14, 0.1), Deviation("N", "link_1", 3.14e12, 1e9))
    assert Assessment("x", deviations).error == "3.1e+12 eps, first in N of link_1"
    assert Assessment("x", deviations[:1]).error == "2.1 eps"
