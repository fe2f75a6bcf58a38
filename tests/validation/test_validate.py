"""The verdict is right: agreement passes, every kind of disagreement is seen, counted and located."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, Wrench
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations import Batch
from rttrr_pin.implementations.pinocchio import Pinocchio
from rttrr_pin.validation import Validation, compare_state, validate
from support.implementations import altered
from support.recursion import recursion
from support.serial_chains import random_chain
from support.tolerances import EPS, ROUNDING


def outcome(result: Validation) -> dict[tuple[str, str], tuple[int, int]]:
    """Failures and the state of the worst, of each row that failed."""
    return {(row.quantity, row.at): (row.failures, row.of_tolerance.state) for row in result.rows if not row.passed}


def test_right_dynamics_agree(rttrr: Robot) -> None:
    result = validate(rttrr, n_states=3000, payload=RandomPayload())
    assert result.passed and result.n_states == 3000 and result.subject.startswith("kernel")
    assert [row.at for row in result.rows if row.quantity == "tau"] == list(rttrr.joint_names)
    for quantity in QUANTITIES[1:]:
        assert [row.at for row in result.rows if row.quantity == quantity] == list(rttrr.link_names)


@pytest.mark.parametrize("subject", ["kernel", "recursion", "mujoco", "lagrange"])
def test_any_of_them_can_be_the_subject_or_the_reference(rttrr: Robot, subject: str) -> None:
    one = validate(rttrr, subject, "pinocchio", 50)
    other = validate(rttrr, "pinocchio", subject, 50)
    assert one.passed and other.passed
    assert [row.of_tolerance for row in one.rows] == [row.of_tolerance for row in other.rows]


@pytest.mark.one_in(6)
def test_no_worst_error_is_beyond_500_eps(robot: Robot) -> None:
    """Normwise, per link."""
    result = validate(robot, n_states=2000, seed=3)
    assert max(row.relative.value for row in result.rows) * EPS <= ROUNDING


@pytest.mark.one_in(3)
@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("size", [1e-9, 1.0, np.nan, np.inf])
@pytest.mark.parametrize("side", ["subject", "reference"])
def test_one_wrong_number_in_one_state_is_found_and_located(
    rttrr: Robot, monkeypatch: pytest.MonkeyPatch, quantity: str, size: float, side: str
) -> None:
    """In a later block, at one link, in one state of many."""
    monkeypatch.setattr("rttrr_pin.validation.states.BLOCK", 300)

    def spoil(values: dict[str, Any], batch: Batch) -> None:
        if batch.first <= 700 < batch.first + len(batch):
            k = 700 - batch.first
            values[quantity][(k, 3) if quantity == "tau" else (k, 3, 1)] += size

    sides = {"subject": "kernel", "reference": "pinocchio"}
    result = validate(rttrr, **sides | {side: altered(rttrr, spoil, sides[side])}, n_states=800)
    at = "joint_4" if quantity == "tau" else "link_4"
    if quantity == "n":  # tau is compared with the norm of n, so that a wild n leaves tau's verdict alone
        assert ("tau", at) not in outcome(result)
    assert outcome(result) == {(quantity, at): (1, 700)}
    assert not result.passed and result.failing == 1 and result.worst is not None
    assert (result.worst.quantity, result.worst.at) == (quantity, at)


def test_a_systematic_error_of_a_few_eps_of_the_norm_is_not_hidden(rttrr: Robot) -> None:
    """A relative error of 1e-12 in every torque: far below what a tolerance of 1e-9 would see."""
    wrong = altered(rttrr, lambda values, batch: values["tau"].__imul__(1 + 1e-12))
    assert {at for _, at in outcome(validate(rttrr, reference=wrong, n_states=200))} == set(rttrr.joint_names)


@pytest.mark.parametrize(("name", "size"), [("BLOCK", 60), ("NUMBERS", 60 * 77)])
def test_the_outcome_does_not_depend_on_blocks(
    rttrr: Robot, monkeypatch: pytest.MonkeyPatch, name: str, size: int
) -> None:
    """Of so many states, or of so many numbers, of which a state of the arm has 77."""
    whole = validate(rttrr, n_states=700, payload=RandomPayload())
    monkeypatch.setattr(f"rttrr_pin.validation.states.{name}", size)
    cut = validate(rttrr, n_states=700, payload=RandomPayload())
    assert (whole.rows, whole.whole, whole.adjudications) == (cut.rows, cut.whole, cut.adjudications)


def test_a_longer_run_begins_with_the_shorter(rttrr: Robot) -> None:
    short, long = validate(rttrr, n_states=500), validate(rttrr, n_states=1500)
    for one, other in zip(short.rows, long.rows, strict=True):
        assert other.absolute.value >= one.absolute.value
        if other.of_tolerance.state < 500:
            assert other.of_tolerance == one.of_tolerance


@pytest.mark.parametrize("subject", ["kernel", "recursion"])
def test_the_worst_state_can_be_had_again(rttrr: Robot, subject: str) -> None:
    """One state, one answer: alone it has the numbers that it had in the run."""
    chosen: dict[str, Any] = {"seed": 4, "payload": RandomPayload(), "sampling": "mixed", "subject": subject}
    result = validate(rttrr, n_states=2000, **chosen)
    worst = result.worst
    assert worst is not None
    one = compare_state(rttrr, worst.of_tolerance.state, **chosen)
    index = result.rows.index(worst)
    assert one.comparisons[0].differences[index].of_tolerance[0] == worst.of_tolerance.value
    assert one.passed


def test_progress_counts_to_the_end(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rttrr_pin.validation.states.BLOCK", 1000)
    seen: list[int] = []
    validate(rttrr, n_states=2100, progress=seen.append)
    assert seen[-1] == 2100 and seen == sorted(seen) and len(seen) > 1


def test_a_payload_changes_the_torques_of_both_alike(rttrr: Robot) -> None:
    payload = Wrench((10, 20, 30), (1, 2, 3), expressed_in="base")
    assert validate(rttrr, n_states=300, payload=payload).passed
    loaded, bare = (compare_state(rttrr, 5, payload=p).comparisons[0].result for p in (payload, None))
    assert not np.isclose(loaded.values["tau"], bare.values["tau"]).any()


def test_gravity_of_another_model_is_seen(rttrr: Robot) -> None:
    """A reference under 9.80665, the subject under 9.81: every force differs."""
    reference = Pinocchio(rttrr.model)
    reference.pin_model.gravity.linear = np.array([0, 0, -9.80665])
    failed = outcome(validate(rttrr, reference=reference, n_states=50))
    assert {("F", f"link_{i}") for i in range(1, 6)} <= failed.keys()
    assert not any(quantity == "N" for quantity, _ in failed)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("number", ["mass", "com", "inertia", "p"])
@pytest.mark.parametrize("link", [0, 2, 4])
def test_an_error_of_1e_10_in_one_number_is_seen(rttrr: Robot, number: str, link: int) -> None:
    """One mass, centre of mass, tensor or placement altered by a part in 1e10."""
    links, joints = list(rttrr.model.links), list(rttrr.model.joints)
    if number == "p":
        joints[link] = replace(joints[link], p=joints[link].p * (1 + 1e-10))
    else:
        links[link] = replace(links[link], **{number: getattr(links[link], number) * (1 + 1e-10)})
    other = Robot(replace(rttrr.model, links=tuple(links), joints=tuple(joints)))

    def spoil(values: dict[str, Any], batch: Batch) -> None:
        values |= dict(recursion(other, batch.q, batch.v, batch.a).items())

    no_effect = number == "p" and link == 0  # a height on the axis of joint 1 enters nothing
    assert validate(rttrr, reference=altered(rttrr, spoil), n_states=200).passed == no_effect


def body(name: str, mass: float) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz=".1 .2 .3"/><mass value="{mass}"/>'
        '<inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>'
    )


def joint(name: str, kind: str, parent: str, child: str) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz=".1 0 .2"/><parent link="{parent}"/><child link="{child}"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    )


def negative(base: float, moving: float, tip: float, kind: str) -> str:
    """A mass fixed to the base, one that moves, one on its end."""
    links = '<link name="world_"/>' + body("b", base) + body("m", moving) + body("t", tip)
    joints = joint("f", "fixed", "world_", "b") + joint("j", "revolute", "b", "m") + joint("k", kind, "m", "t")
    return f'<robot name="r">{links}{joints}</robot>'


SIGNS = [
    (-1, 1, 0.5, "fixed"),
    (1, 2, -0.5, "fixed"),
    (-1, -2, 1, "revolute"),
    (1, 1, -3, "fixed"),
    (0, -1, -1, "revolute"),
]


CASES = [(signs, subject) for signs in SIGNS for subject in ("recursion", "kernel")] + [(SIGNS[0], "pinocchio")]
"""Pinocchio cannot build what moves with less than nothing."""


@pytest.mark.one_in(9)
@pytest.mark.parametrize(("masses", "subject"), CASES, ids=str)
def test_an_allowance_is_a_sum_of_sizes_whatever_the_signs_of_masses(
    masses: tuple[float, float, float, str], subject: str
) -> None:
    """No false alarm, and no blind tolerance: 1e-9 of error is seen."""
    robot = rttrr_pin.load(negative(*masses))
    reference = "lagrange" if subject != "pinocchio" else "recursion"
    assert validate(robot, subject, reference, 200).passed
    wrong = altered(robot, lambda values, batch: values["tau"].__iadd__(1e-9), subject)
    assert not validate(robot, wrong, reference, 20).passed


def test_a_robot_without_joints_is_no_agreement() -> None:
    with pytest.raises(InputError, match="nothing to compare"):
        validate(rttrr_pin.load('<robot name="x"><link name="a"/></robot>'), n_states=5)


def test_torques_of_a_robot_that_cannot_move_are_no_agreement() -> None:
    robot = rttrr_pin.load(random_chain(6, ("fixed", "fixed")))
    with pytest.raises(InputError, match="lagrange gives tau: there is nothing to compare, since no joint moves"):
        validate(robot, reference="lagrange", n_states=5)


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"n_states": 0}, InputError),
        ({"n_states": 2.5}, InputError),
        ({"n_states": True}, InputError),
        ({"n_states": 10**30}, InputError),
        ({"seed": None}, InputError),
        ({"payload": 3}, InputError),
        ({"payload": "random"}, InputError),
        ({"payload": Wrench(np.zeros((4, 3)))}, InputError),
        ({"payload": RandomPayload("nowhere")}, UnknownNameError),
        ({"sampling": ["uniform"]}, UnknownNameError),
        ({"sampling": "gaussian"}, UnknownNameError),
        ({"reference": "bullet"}, UnknownNameError),
        ({"subject": "bullet"}, UnknownNameError),
        ({"subject": 3}, InputError),
        ({"reference": []}, InputError),
        ({"reference": ["mujoco", "pinocchio", "mujoco"]}, InputError),
    ],
    ids=str,
)
def test_bad_arguments(rttrr: Robot, arguments: dict[str, Any], error: type[InputError]) -> None:
    with pytest.raises(error):
        validate(rttrr, **{"n_states": 10} | arguments)


@pytest.mark.parametrize("index", [-1, 10**19, 1.5, True])
def test_a_state_is_a_whole_number_from_0(rttrr: Robot, index: Any) -> None:
    with pytest.raises(InputError, match="state is .*expected a whole number from 0"):
        compare_state(rttrr, index)


def test_a_robot_is_a_robot() -> None:
    with pytest.raises(InputError, match=r"robot is a str: pass a Robot"):
        validate("rttrr")  # type: ignore[arg-type]


def test_a_difference_of_zero_over_zero_is_zero(rttrr: Robot) -> None:
    """A massless tool without payload: nothing against nothing."""
    tool = [row for row in validate(rttrr, n_states=50).rows if row.at == "tool"]
    assert len(tool) == 4
    assert all(row.relative.value == row.of_tolerance.value == 0.0 for row in tool)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_the_error_over_all_links_is_the_norm_of_the_whole(rttrr: Robot, quantity: str) -> None:
    seen = validate(rttrr, n_states=700, seed=2).whole[quantity]
    one = compare_state(rttrr, seen.state, seed=2)
    x, y = (side.values[quantity][0] for side in (one.result, one.comparisons[0].result))
    assert abs(seen.value - np.linalg.norm(x - y) / np.linalg.norm(y) / EPS) <= ROUNDING * seen.value


def test_results_are_data(rttrr: Robot) -> None:
    result = validate(rttrr, n_states=10)
    data = result.to_dict()
    assert data["schema"] == 1 and data["passed"] and data["references"][0]["worst"]["value"] <= 1.0
    assert replace(result.rows[0]) == result.rows[0]
    assert result.summary().startswith("PASS kernel")
