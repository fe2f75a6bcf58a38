"""What locked joints take, in one call for all states, is what `rnea` leaves in Pinocchio's data state by state."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations import Evaluation, pinocchio_wrenches
from rttrr_pin.implementations.pinocchio import Pinocchio
from rttrr_pin.implementations.pinocchio_loop import StateByState
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.validation import Sampler
from support.trees import random_tree

COUNT = 60


def models(program: Pinocchio) -> Sequence[object]:
    return list(program._wrenches.values())


def one_by_one(robot: Robot) -> Pinocchio:
    """Pinocchio, told that no model of locked joints fits in memory."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pinocchio_wrenches, "MOST_BYTES", 0)
        program = Pinocchio(robot.model)
        for loaded in ((), (len(robot.model.links) - 1,)):
            assert isinstance(program._programs(loaded), StateByState)
    return program


def both(robot: Robot, batch: Batch) -> tuple[Evaluation, Evaluation]:
    at_once = Pinocchio(robot.model)
    results = at_once.evaluate(batch), one_by_one(robot).evaluate(batch)
    assert not any(isinstance(one, StateByState) for one in models(at_once))
    return results


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_of_links_that_nothing_is_fixed_to_the_bits_are_those_of_the_data(base: str) -> None:
    """F is mass times the same acceleration, which the data has about another point."""
    robot = rttrr_pin.load("rttrr", base=base)
    x, y = both(robot, Sampler(robot.model, "mixed").draw(0, COUNT))
    moving = [i for i, joint in enumerate(robot.model.joints) if joint.nv]
    assert np.array_equal(x.values["tau"], y.values["tau"])
    for key in ("N", "f", "n"):
        assert np.array_equal(x.values[key][:, moving], y.values[key][:, moving]), key
    assert x.values["F"] == pytest.approx(y.values["F"], rel=1e3 * EPS, abs=1e3 * EPS * np.abs(y.values["F"]).max())


@pytest.mark.one_in(4)
@pytest.mark.parametrize("payload", [None, "link", "base"])
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", range(8))
def test_the_two_ways_agree_within_what_the_recursion_rounds(seed: int, base: str, payload: str | None) -> None:
    """Branches, followers, fixed links on the base and on others, payloads on any link."""
    robot = rttrr_pin.load(random_tree(100 + seed, 9), base=base)
    batch = Sampler(robot.model, "mixed").draw(0, COUNT)
    if payload is not None:
        rng, links = np.random.default_rng(seed), len(robot.model.links)
        loads = tuple(
            Load(int(rng.integers(links)), *rng.normal(size=(2, COUNT, 3)) * 1e2, payload == "base") for _ in range(3)
        )
        batch = Batch(robot.model, batch.q, batch.v, batch.a, loads)
    x, y = both(robot, batch)
    for key in QUANTITIES:
        error = x.values[key] - y.values[key]
        size = np.abs(error) if key == "tau" else np.linalg.norm(error, axis=-1)
        assert (size <= x.allowance[key] + y.allowance[key]).all(), key


def test_how_a_robot_is_cut_into_models_changes_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = rttrr_pin.load("rttrr")
    batch = Sampler(robot.model, payload=RandomPayload()).draw(0, COUNT)
    whole = Pinocchio(robot.model).evaluate(batch).values
    monkeypatch.setattr(pinocchio_wrenches, "FREEDOMS", 12)
    program = Pinocchio(robot.model)
    cut = program.evaluate(batch).values
    assert len(program._programs((5,))._models) > 8
    assert all(np.array_equal(whole[key], cut[key]) for key in QUANTITIES)


def test_states_without_payload_are_those_of_a_robot_without_one() -> None:
    """Alone or beside others, to the bit, and zeros are zeros: a feather weighs more than nothing."""
    robot = rttrr_pin.load("rttrr")
    batch = Sampler(robot.model).draw(0, COUNT)
    force = np.random.default_rng(0).normal(size=(COUNT, 3)) * (np.arange(COUNT) % 3 > 0)[:, None]
    program = Pinocchio(robot.model)
    without = program.evaluate(batch).values
    loaded = program.evaluate(Batch(robot.model, batch.q, batch.v, batch.a, (Load(5, force, 0 * force),))).values
    some = slice(0, COUNT, 3)
    assert all(np.array_equal(without[key][some], loaded[key][some]) for key in QUANTITIES)
    assert not without["f"][:, 5].any() and loaded["f"][1, 5] == pytest.approx(force[1])


@pytest.mark.parametrize("size", [1e-60, 1.0, 1e60])
def test_payloads_of_any_size_come_through(size: float) -> None:
    robot = rttrr_pin.load("rttrr", gravity=(0, 0, 0))
    still, force = np.zeros((3, 5)), np.random.default_rng(1).normal(size=(3, 3)) * size
    batch = Batch(robot.model, Sampler(robot.model).draw(0, 3).q, still, still, (Load(5, force, 2 * force),))
    values = Pinocchio(robot.model).evaluate(batch).values
    for i in range(6):
        assert np.linalg.norm(values["f"][:, i], axis=1) == pytest.approx(np.linalg.norm(force, axis=1), rel=100 * EPS)
    assert np.array_equal(values["n"][:, 5], 2 * force)
