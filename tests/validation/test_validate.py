"""The verdict is right: agreement passes, every kind of disagreement is seen, counted and located."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import LinkWrenches, Robot, Wrench
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.pinocchio import PinocchioOracle
from rttrr_pin.validation import Sampler, Validation, compare_state, validate
from support.fakes import Liar
from support.recursion import recursion
from support.tolerances import EPS, ROUNDING


def outcome(result: Validation) -> dict[tuple[str, str], tuple[int, int]]:
    """Failures and the state of the worst, of each row that failed."""
    return {(row.quantity, row.at): (row.failures, row.share.state) for row in result.rows if not row.passed}


def test_right_dynamics_agree(rttrr: Robot) -> None:
    result = validate(rttrr, 3000, payload="random")
    assert result.agrees and result.n_states == 3000
    assert [(row.quantity, row.at) for row in result.rows if row.quantity == "tau"] == [
        ("tau", name) for name in rttrr.joint_names
    ]
    for quantity in QUANTITIES[1:]:
        assert [row.at for row in result.rows if row.quantity == quantity] == list(rttrr.link_names)


def test_no_worst_error_is_beyond_500_eps(robot: Robot) -> None:
    """Normwise, per link."""
    result = validate(robot, 2000, seed=3)
    assert max(row.relative.value for row in result.rows) * EPS <= ROUNDING


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("size", [1e-9, 1.0, np.nan, np.inf])
def test_one_wrong_number_in_one_state_is_found_and_located(
    rttrr: Robot, liar: type[Liar], quantity: str, size: float
) -> None:
    """In a later block, at one link, in one state of many."""
    calls: list[int] = []

    def spoil(result: LinkWrenches, q: np.ndarray) -> None:
        calls.append(len(q))
        if len(calls) == 2:
            array = getattr(result, quantity)
            array[(17, 3) if quantity == "tau" else (17, 3, 1)] += size

    liar.spoil = staticmethod(spoil)
    result = validate(rttrr, 2500, oracle="liar")
    at = "joint_4" if quantity == "tau" else "link_4"
    expected = {(quantity, at): (1, calls[0] + 17)}
    if quantity == "n":  # tau is measured against the norm of n, so that a wild n leaves tau's verdict alone
        assert ("tau", at) not in outcome(result)
    assert outcome(result) == expected
    assert not result.agrees and result.worst is not None
    assert (result.worst.quantity, result.worst.at) == (quantity, at)


def test_a_systematic_error_of_a_few_eps_of_the_norm_is_not_hidden(rttrr: Robot, liar: type[Liar]) -> None:
    """A relative error of 1e-12 in every torque: far below what a tolerance of 1e-9 would see."""

    def spoil(result: LinkWrenches, q: np.ndarray) -> None:
        result.tau[:] *= 1 + 1e-12

    liar.spoil = staticmethod(spoil)
    assert {at for _, at in outcome(validate(rttrr, 200, oracle="liar"))} == set(rttrr.joint_names)


def test_the_outcome_does_not_depend_on_blocks(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = validate(rttrr, 700, payload="random")
    monkeypatch.setattr("rttrr_pin.validation.run.BLOCK", 64)
    cut = validate(rttrr, 700, payload="random")
    assert whole.rows == cut.rows


def test_a_longer_run_begins_with_the_shorter(rttrr: Robot) -> None:
    short, long = validate(rttrr, 500), validate(rttrr, 1500)
    for one, other in zip(short.rows, long.rows, strict=True):
        assert other.absolute.value >= one.absolute.value
        if other.share.state < 500:
            assert other.share == one.share


def test_the_worst_state_can_be_had_again(rttrr: Robot) -> None:
    result = validate(rttrr, 2000, seed=4, payload="random", sampling="mixed")
    worst = result.worst
    assert worst is not None
    one = compare_state(rttrr, worst.share.state, seed=4, payload="random", sampling="mixed", states=2000)
    index = result.rows.index(worst)
    assert one.gaps[index].share[0] == worst.share.value
    assert one.agrees


def test_progress_counts_to_the_end(rttrr: Robot) -> None:
    seen: list[int] = []
    validate(rttrr, 2100, progress=seen.append)
    assert seen[-1] == 2100 and seen == sorted(seen) and len(seen) > 1


def test_a_payload_changes_the_torques_of_both_alike(rttrr: Robot) -> None:
    payload = Wrench((10, 20, 30), (1, 2, 3), expressed_in="base")
    assert validate(rttrr, 300, payload=payload).agrees
    loaded, bare = (compare_state(rttrr, 5, payload=p) for p in (payload, None))
    assert not np.isclose(loaded.theirs.tau, bare.theirs.tau).any()


def test_gravity_of_another_model_is_seen(rttrr: Robot, liar: type[Liar]) -> None:
    """An oracle under 9.80665, ours under 9.81: every force differs."""

    def spoil(result: LinkWrenches, q: np.ndarray) -> None:
        oracle = PinocchioOracle(rttrr.model)
        oracle.pin_model.gravity.linear = np.array([0, 0, -9.80665])
        drawn = Sampler(rttrr.model).draw(0, len(q))
        other = oracle.evaluate(drawn.q, drawn.v, drawn.a).wrenches
        for key, x in other.items():
            getattr(result, key)[:] = x

    liar.spoil = staticmethod(spoil)
    failed = outcome(validate(rttrr, 50, oracle="liar"))
    assert {("F", f"link_{i}") for i in range(1, 6)} <= failed.keys()
    assert not any(quantity == "N" for quantity, _ in failed)


@pytest.mark.parametrize("number", ["mass", "com", "inertia", "p"])
@pytest.mark.parametrize("link", [0, 2, 4])
def test_an_error_of_1e_10_in_one_number_is_seen(rttrr: Robot, liar: type[Liar], number: str, link: int) -> None:
    """One mass, centre of mass, tensor or placement of ours altered by a part in 1e10."""

    def altered(x: Any) -> Any:
        return x * (1 + 1e-10)

    links, joints = list(rttrr.model.links), list(rttrr.model.joints)
    if number == "p":
        joints[link] = replace(joints[link], p=altered(joints[link].p))
    else:
        links[link] = replace(links[link], **{number: altered(getattr(links[link], number))})
    other = replace(rttrr.model, links=tuple(links), joints=tuple(joints))

    def spoil(result: LinkWrenches, q: np.ndarray) -> None:
        drawn = Sampler(rttrr.model).draw(0, len(q))
        for key, x in recursion(Robot(other), drawn.q, drawn.v, drawn.a).items():
            getattr(result, key)[:] = x

    liar.spoil = staticmethod(spoil)
    no_effect = number == "p" and link == 0  # a height on the axis of joint 1 enters nothing
    assert validate(rttrr, 200, oracle="liar").agrees == no_effect


@pytest.mark.parametrize("gravity", [(-1e200, 0, 0), (1e307, 1e307, 1e307)], ids=str)
def test_numbers_that_no_norm_can_hold_are_no_verdict(gravity: tuple[float, ...]) -> None:
    """Neither a disagreement nor an agreement within an infinite bound."""
    with pytest.raises(InputError, match="in state 0, beyond 1e.140, which no norm can hold"):
        validate(rttrr_pin.load("rttrr", gravity=gravity), 5)


def test_a_robot_without_joints_is_no_agreement() -> None:
    with pytest.raises(InputError, match="nothing to compare"):
        validate(rttrr_pin.load('<robot name="x"><link name="a"/></robot>'), 5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"states": 0}, "states is 0.*from 1"),
        ({"states": 2.5}, "states is 2.5 .float.: expected a whole number"),
        ({"states": True}, "states is True .bool."),
        ({"states": 10**30}, "states is 1000"),
        ({"seed": None}, "seed is None"),
        ({"payload": 3}, "payload is a int, expected a Wrench"),
        ({"payload": (1, 2, 3)}, "payload is a tuple, expected a Wrench"),
        ({"sampling": ["uniform"]}, "no family of states"),
        ({"states": -5}, "states is -5"),
        ({"payload": "heavy"}, "expected 'random' or a Wrench"),
        ({"payload": Wrench(np.zeros((4, 3)))}, "has a batch axis"),
        ({"sampling": "gaussian"}, "no family of states is called 'gaussian'"),
        ({"oracle": "bullet"}, "no oracle is called 'bullet'"),
    ],
    ids=str,
)
def test_bad_arguments(rttrr: Robot, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        validate(rttrr, **{"states": 10} | arguments)


@pytest.mark.parametrize("index", [-1, 10**19, 1.5, True])
def test_a_state_is_a_whole_number_from_0(rttrr: Robot, index: Any) -> None:
    with pytest.raises(InputError, match="state is .*expected a whole number from 0"):
        compare_state(rttrr, index)


def test_a_robot_is_a_robot() -> None:
    with pytest.raises(InputError, match=r"robot is a str: pass a Robot, such as rttrr_pin.load\('rttrr'\)"):
        validate("rttrr")  # type: ignore[arg-type]


def test_a_gap_of_zero_over_zero_is_zero(rttrr: Robot) -> None:
    """A massless tool without payload: nothing against nothing."""
    tool = [row for row in validate(rttrr, 50).rows if row.at == "tool"]
    assert len(tool) == 4
    assert all(row.relative.value == row.share.value == 0.0 for row in tool)


def test_rows_are_plain_data(rttrr: Robot) -> None:
    row = validate(rttrr, 10).rows[0]
    assert replace(row) == row


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_the_error_over_all_links_is_the_norm_of_the_whole(rttrr: Robot, quantity: str) -> None:
    seen = validate(rttrr, 700, seed=2).whole[quantity]
    one = compare_state(rttrr, seen.state, seed=2, states=700)
    mine, theirs = (getattr(x, quantity)[0] for x in (one.ours, one.theirs))
    assert abs(seen.value - np.linalg.norm(mine - theirs) / np.linalg.norm(theirs) / EPS) <= ROUNDING * seen.value
