"""The worst-case search, and which program stands on our side of a comparison."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.validation import Sampler, compare_state, validate
from rttrr_pin.validation.ours import COMPUTED, KERNEL_FROM, Ours
from rttrr_pin.validation.search import POPULATION, search
from support.trees import random_tree

FEW = 3 * POPULATION


def test_a_search_finds_more_than_chance(rttrr: Robot) -> None:
    found = search(rttrr, 20 * POPULATION, 1, "random")
    assert found.share > found.random and found.agrees
    assert abs(found.evaluations - 20 * POPULATION) <= 2 * POPULATION


def test_the_same_seed_finds_the_same_state(rttrr: Robot) -> None:
    one, two, other = (search(rttrr, FEW, seed) for seed in (4, 4, 5))
    assert (one.share, one.quantity, one.at) == (two.share, two.quantity, two.at)
    np.testing.assert_array_equal(one.states.q, two.states.q)
    assert not np.array_equal(one.states.q, other.states.q)


def test_the_state_that_is_found_is_as_bad_as_was_said(rttrr: Robot) -> None:
    """The share is that of the state itself, within the ranges of uniform states."""
    found = search(rttrr, FEW, 2, Wrench((1.0, 2.0, 3.0), (0.1, 0.2, 0.3)))
    limits = [(joint.limits.lower, joint.limits.upper) for joint in rttrr.model.moving]
    for q, (lower, upper) in zip(found.states.q[0], limits, strict=True):
        assert lower <= q <= upper
    assert len(found.states.q) == 1 and found.share > 0.0


def test_a_search_beyond_the_gate_says_so(monkeypatch, rttrr: Robot) -> None:
    """Against an oracle that is wrong in one entry, by less than a random state would show."""
    from rttrr_pin.implementations.pinocchio import PinocchioOracle

    right = PinocchioOracle.evaluate

    def wrong(self, q, v, a, loads=()):
        result = right(self, q, v, a, loads)
        result.wrenches.tau[:, 0] += 2.5e-13 * np.exp(-30 * (q[:, 0] - 1.0) ** 2)
        return result

    monkeypatch.setattr(PinocchioOracle, "evaluate", wrong)
    found = search(rttrr, 40 * POPULATION, 0)
    assert found.random < 1.0 < found.share and (found.quantity, found.at) == ("tau", "joint_1")
    assert abs(found.states.q[0, 0] - 1.0) < 0.5


@pytest.mark.parametrize("evaluations", [0, 511, "many", 10**10])
def test_too_few_or_too_many_evaluations_are_an_error(rttrr: Robot, evaluations) -> None:
    with pytest.raises(InputError, match="evaluations"):
        search(rttrr, evaluations)


def test_few_states_take_the_readable_recursion_and_many_the_kernel(rttrr: Robot) -> None:
    assert Ours(rttrr, KERNEL_FROM - 1).kernel is None
    assert Ours(rttrr, KERNEL_FROM).kernel is not None
    large = rttrr_pin.load(random_tree(0, 20))
    assert Ours(large, KERNEL_FROM).kernel is None


@pytest.mark.parametrize("axes", ["link", "base"])
def test_both_sides_lie_within_each_other_s_bounds(axes) -> None:
    """Values, drives and payload alike; the kernel's bound is no larger than the readable one by more than a third."""
    robot = rttrr_pin.load(random_tree(3, 5), friction=True)
    load = robot.load_of(Wrench((1.0, -2.0, 3.0), (0.3, 0.2, -0.1), robot.link_names[-1], axes))
    states = Sampler(robot.model, "uniform", 0, load).draw(0, 50)
    (mine, my_bounds), (other, other_bounds) = (Ours(robot, n)(states) for n in (KERNEL_FROM, 1))
    for name in COMPUTED:
        x, y, b, c = (getattr(side, name) for side in (mine, other, my_bounds, other_bounds))
        assert (np.abs(x - y) <= b + c).all(), name
        assert b.sum() <= 4 / 3 * c.sum(), name


def test_a_state_that_overflows_is_shown_and_no_error_of_the_kernel(rttrr: Robot) -> None:
    states = Sampler(rttrr.model, "uniform", 0).draw(0, 3)
    states.v[1] = 1e200
    with np.errstate(all="ignore"):
        values, _ = Ours(rttrr, KERNEL_FROM)(states)
    assert np.isfinite(values.tau[[0, 2]]).all() and not np.isfinite(values.tau[1]).all()


def test_a_state_in_full_has_the_numbers_of_the_run(rttrr: Robot) -> None:
    run = validate(rttrr, KERNEL_FROM, seed=3)
    worst = run.worst
    assert worst is not None
    state = compare_state(rttrr, worst.share.state, seed=3, states=KERNEL_FROM)
    row = [(r.quantity, r.at) for r in state.rows].index((worst.quantity, worst.at))
    assert float(state.gaps[row].share[0]) == worst.share.value


# The command


def test_the_command_shows_what_was_found(capsys, tmp_path) -> None:
    import json

    from rttrr_pin.cli import main

    target = tmp_path / "out.json"
    assert main(["validate", "--states", "50", "--search", "600", "--seed", "2", "--json", str(target)]) == 0
    assert "states searched, seed 2" in capsys.readouterr().out
    data = json.loads(target.read_text())["search"]
    assert data["evaluations"] >= 512 and data["share"] >= data["share_of_random_states"] and len(data["q"]) == 5


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--search", "3"], "from 512"),
        (["--search", "600", "--state", "3"], "--state names one"),
    ],
)
def test_a_search_that_makes_no_sense_is_an_error(capsys, words, told) -> None:
    from rttrr_pin.cli import main

    assert main(["validate", "--states", "50", *words]) == 2
    assert told in capsys.readouterr().err


def test_a_state_is_printed_with_the_numbers_of_its_run(capsys) -> None:
    """The command that is offered names the number of states where it is not the usual one."""
    from rttrr_pin.cli import main

    assert main(["validate", "--states", "60"]) == 0
    assert "--states 60 --state" in capsys.readouterr().out


def test_ours_is_the_kernel_where_compiling_pays() -> None:
    """Also with a floating joint."""
    for base in ("fixed", "floating"):
        robot = rttrr_pin.load("rttrr", base=base)
        assert Ours(robot, KERNEL_FROM).kernel is not None
        assert Ours(robot, KERNEL_FROM - 1).kernel is None
