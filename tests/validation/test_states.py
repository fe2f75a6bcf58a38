"""States depend on family, seed and index alone, and lie where they should."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import SAMPLINGS, Sampler
from support.serial_chains import EXAMPLES


@pytest.mark.one_in(6)
@pytest.mark.parametrize("sampling", SAMPLINGS)
@given(first=st.integers(0, 10**9), count=st.integers(1, 40), at=st.integers(0, 39))
def test_state_k_is_the_same_however_the_work_is_cut(
    rttrr: Robot, sampling: str, first: int, count: int, at: int
) -> None:
    sampler = Sampler(rttrr.model, sampling, 7, RandomPayload("tool"))
    k = at % count
    together, alone = sampler.draw(first, count), sampler.draw(first + k, 1)
    for name in "qva":
        np.testing.assert_array_equal(getattr(together, name)[k], getattr(alone, name)[0])
    np.testing.assert_array_equal(together.loads[0].f[k], alone.loads[0].f[0])
    np.testing.assert_array_equal(together.loads[0].n[k], alone.loads[0].n[0])


@pytest.mark.one_in(2)
@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize("base", ["fixed", "floating"])
@settings(max_examples=20)
@given(first=st.integers(0, 10**9), cuts=st.lists(st.integers(1, 70), max_size=6))
def test_blocks_behind_each_other_are_the_states(sampling: str, base: Any, first: int, cuts: list[int]) -> None:
    sampler = Sampler(_on_base(base), sampling, 3, RandomPayload("tool"))
    edges = [0, *sorted({*cuts}), 71]
    together = _numbers(sampler.draw(first, 71))
    parts = [_numbers(sampler.draw(first + start, stop - start)) for start, stop in pairwise(edges)]
    for x, own in zip(together, zip(*parts, strict=True), strict=True):
        np.testing.assert_array_equal(x, np.concatenate(own))


@cache
def _on_base(base: Any) -> Model:
    return rttrr_pin.load("rttrr", base=base).model


def _numbers(batch: Batch) -> list[Any]:
    return [batch.q, batch.v, batch.a, batch.loads[0].f, batch.loads[0].n]


def test_a_payload_does_not_change_the_states(rttrr: Robot) -> None:
    with_, without = Sampler(rttrr.model, payload=RandomPayload("tool")).draw(0, 9), Sampler(rttrr.model).draw(0, 9)
    np.testing.assert_array_equal(with_.q, without.q)
    np.testing.assert_array_equal(with_.a, without.a)


@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_seeds_and_states_differ(rttrr: Robot, sampling: str) -> None:
    """Two seeds, and two states of one seed, have nothing in common where the family leaves room."""
    if sampling == "zeros":
        sampling = "uniform"
    one, other = (Sampler(rttrr.model, sampling, seed).draw(0, 64) for seed in (1, 2))
    assert not np.array_equal(one.q, other.q)
    assert len({row.tobytes() for row in np.hstack([one.q, one.v, one.a])}) > 32


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_uniform_states_fill_the_limits_of_the_file(rttrr: Robot, seed: int) -> None:
    q, v = (getattr(Sampler(rttrr.model, "uniform", seed).draw(0, 4000), name) for name in "qv")
    for j, joint in enumerate(rttrr.model.moving):
        low, high, rate = joint.limits.lower, joint.limits.upper, joint.limits.velocity
        assert low <= q[:, j].min() < low + (high - low) / 100
        assert high - (high - low) / 100 < q[:, j].max() <= high
        assert rate * 0.99 < np.abs(v[:, j]).max() <= rate


def test_joints_without_limits_get_finite_ranges() -> None:
    robot = rttrr_pin.load(EXAMPLES["continuous"].replace('velocity="3"', 'velocity="0"'))
    drawn = Sampler(robot.model).draw(0, 1000)
    assert np.isfinite(drawn.q).all()
    assert (np.abs(drawn.q[:, 0]).max() > 3.0) and (np.abs(drawn.v).max(axis=0) > 0.9).all()


def test_corners_take_ends_zeros_and_right_angles(rttrr: Robot) -> None:
    """Right angles for joints that turn; nothing beyond the limits."""
    drawn = Sampler(rttrr.model, "corners").draw(0, 500)
    for j, joint in enumerate(rttrr.model.moving):
        places = {joint.limits.lower, joint.limits.upper, 0.0}
        if joint.type.rotates:
            places |= {np.pi / 2, -np.pi / 2}
        assert set(drawn.q[:, j]) == places
        assert set(drawn.v[:, j]) == {-joint.limits.velocity, 0.0, joint.limits.velocity}


def test_zeros_family_zeroes_each_subset_of_q_v_a(rttrr: Robot) -> None:
    drawn = Sampler(rttrr.model, "zeros").draw(0, 8)
    for k in range(8):
        assert [not x[k].any() for x in (drawn.q, drawn.v, drawn.a)] == [bool(k >> bit & 1) for bit in range(3)]


def test_one_joint_family_moves_one_joint(rttrr: Robot) -> None:
    drawn = Sampler(rttrr.model, "one-joint").draw(0, 10)
    for k in range(10):
        for x in (drawn.q, drawn.v, drawn.a):
            assert list(np.flatnonzero(x[k])) == [k % 5]


def test_large_velocities_dwarf_gravity(rttrr: Robot) -> None:
    drawn = Sampler(rttrr.model, "large-velocities").draw(0, 200)
    limit = max(joint.limits.velocity for joint in rttrr.model.moving)
    assert np.abs(drawn.v).max() > 50 * limit


def test_unknown_family_lists_the_known_ones(rttrr: Robot) -> None:
    with pytest.raises(UnknownNameError, match="did you mean uniform"):
        Sampler(rttrr.model, "unifrom")


@pytest.mark.parametrize("seed", [-1, 2**128, 1.5, True, None, "7"])
def test_a_seed_is_a_whole_number_in_range(rttrr: Robot, seed: Any) -> None:
    with pytest.raises(InputError, match=r"seed is .*0 to 2\^128 - 1"):
        Sampler(rttrr.model, seed=seed)
