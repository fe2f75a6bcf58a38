"""Derived rates and accelerations: near the true ones, inside their band, and the same in blocks of any size."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.errors import InputError
from rttrr_pin.trajectories import Block, Trajectory, trajectory
from support.logs import excitation

WITHIN = 1.96
"""Standard deviations of 95 percent of a normal distribution."""


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def joined(motion: Trajectory, size: int = 4096) -> Block:
    blocks = list(motion.blocks(size))
    arrays = {key: np.concatenate([getattr(own, key) for own in blocks]) for key in ("rows", "time", "q", "v", "a")}
    return Block(0, **arrays, errors=np.concatenate([own.errors for own in blocks]))


def band(block: Block) -> np.ndarray:
    """Standard deviations of q, v, a, (N, nv, 3)."""
    assert block.errors is not None
    return np.sqrt((block.errors**2).sum(axis=-1))


def errors(block: Block, true: tuple[np.ndarray, ...]) -> np.ndarray:
    return np.stack([block.q - true[0], block.v - true[1], block.a - true[2]], axis=-1)


@pytest.mark.one_in(2)
@pytest.mark.parametrize(("rate", "noise"), [(1000.0, 1e-5), (1000.0, 1e-3), (250.0, 1e-5), (100.0, 1e-4)])
@pytest.mark.parametrize("uneven", [False, True])
def test_the_band_covers_the_truth_and_is_no_wider_than_it_must(
    arm: Robot, rate: float, noise: float, uneven: bool
) -> None:
    rng = np.random.default_rng(2)
    t = np.arange(4000) / rate
    t = t + uneven * rng.uniform(0.0, 0.5 / rate, len(t))
    true = excitation(arm.model, t, 1)
    motion = trajectory(arm, t, true[0] + noise * rng.standard_normal(true[0].shape))
    block = joined(motion)
    off, sigma = errors(block, true), band(block)
    assert ((np.abs(off) <= WITHIN * sigma).mean(axis=(0, 1)) > 0.95).all()
    assert (np.sqrt((sigma**2).mean(axis=(0, 1))) < 4.0 * np.sqrt((off**2).mean(axis=(0, 1)))).all()
    assert motion.differentiation is not None
    np.testing.assert_allclose(motion.differentiation.noise, noise, rtol=0.1)


def test_numbers_do_not_depend_on_the_size_of_blocks(arm: Robot) -> None:
    t = np.arange(7000) / 500.0
    q = excitation(arm.model, t, 1)[0] + 1e-4 * np.random.default_rng(0).standard_normal((7000, 5))
    motion = trajectory(arm, t, q)
    first, told = joined(motion), motion.differentiation
    for size in (100, 2047, 10**6):
        other = joined(motion, size)
        for key in ("rows", "time", "q", "v", "a", "errors"):
            assert np.array_equal(getattr(first, key), getattr(other, key)), key
        assert motion.differentiation == told


def test_only_what_is_missing_is_derived(arm: Robot) -> None:
    t = np.arange(3000) / 500.0
    q, v, a = excitation(arm.model, t, 1)
    rng = np.random.default_rng(0)
    block = joined(trajectory(arm, t, q, v + 1e-4 * rng.standard_normal(v.shape)))
    assert np.array_equal(block.q, q)
    assert block.errors is not None and not block.errors[..., 0, :].any()
    assert (np.abs(errors(block, (q, v, a)))[..., 1:] <= WITHIN * band(block)[..., 1:]).mean() > 0.95
    block = joined(trajectory(arm, t, q + 1e-5 * rng.standard_normal(v.shape), a=a))
    assert np.array_equal(block.a, a)
    assert (np.abs(errors(block, (q, v, a)))[..., :2] <= WITHIN * band(block)[..., :2]).mean() > 0.95
    assert next(trajectory(arm, t, q, v, a).blocks()).errors is None


def test_a_cut_off_is_kept_and_told(arm: Robot) -> None:
    t = np.arange(3000) / 500.0
    w = 2 * np.pi * np.array([2.0, 4.0, 30.0, 40.0, 2.0])
    motion = trajectory(arm, t, 0.01 * np.sin(np.outer(t, w)), cutoff=10.0)
    a = joined(motion).a[500:-500] / w**2 / 0.01
    assert motion.differentiation is not None
    np.testing.assert_allclose(motion.differentiation.cutoff, 10.0, rtol=0.01)
    assert "cut-off 10 Hz as wanted" in motion.differentiation.summary()
    size = np.sqrt(2.0 * (a**2).mean(axis=0))
    np.testing.assert_allclose(size[[0, 1, 4]], 1.0, atol=0.02)
    assert (size[2:4] < 0.05).all()


def test_splines_do_not_cross_gaps(arm: Robot) -> None:
    t = np.arange(3000) / 500.0
    true = excitation(arm.model, t, 1)
    kept = np.r_[0:1000, 1300:1310, 1500:3000]
    motion = trajectory(arm, t[kept], true[0][kept] + 1e-5 * np.random.default_rng(0).standard_normal((2510, 5)))
    block = joined(motion)
    assert len(block) == 2500
    assert {own.kind: own.count for own in motion.findings} == {"gap": 2, "short part": 10}
    index = np.round(block.time * 500).astype(int)
    assert (np.abs(errors(block, tuple(x[index] for x in true))) <= WITHIN * band(block)).mean() > 0.95


def test_too_few_rows_to_derive_from_are_refused(arm: Robot) -> None:
    t = np.arange(30) / 100.0
    with pytest.raises(InputError, match="lacks v and a, and no 40 rows follow each other"):
        list(trajectory(arm, t, np.zeros((30, 5))).blocks())


def test_a_joint_that_stands_still_is_at_rest(arm: Robot) -> None:
    t = np.arange(500) / 100.0
    block = joined(trajectory(arm, t, np.full((500, 5), 0.1)))
    assert np.abs(block.v).max() < 1e-12 and np.abs(block.a).max() < 1e-10
    assert band(block)[..., 2].max() < 1e-8


def test_rates_of_floating_joints_must_be_given() -> None:
    robot = rttrr_pin.load("trr", base="floating")
    q = np.tile(np.r_[np.zeros(6), 1.0, np.zeros(3)], (50, 1))
    with pytest.raises(InputError, match="rates of root_joint are no derivatives of q"):
        trajectory(robot, np.arange(50.0), q)
    t = np.arange(500) / 100.0
    v = np.sin(t)[:, None] * np.ones(9)
    block = next(trajectory(robot, t, np.tile(q[0], (500, 1)), v).blocks())
    np.testing.assert_allclose(block.a, np.cos(t)[:, None] * np.ones(9), atol=1e-4)


def test_filtered_noise_is_said_and_a_cut_off_has_a_band_that_holds(arm: Robot) -> None:
    """Noise that a filter took over five rows is stronger at low frequencies than the residual says."""
    t = np.arange(6000) / 1000.0
    true = excitation(arm.model, t, 1)
    noise = np.random.default_rng(0).standard_normal(true[0].shape)
    filtered = np.apply_along_axis(np.convolve, 0, noise, np.ones(5) / np.sqrt(5.0), "same")
    motion = trajectory(arm, t, true[0] + 1e-4 * filtered)
    list(motion.blocks())
    assert motion.differentiation is not None
    assert motion.differentiation.doubtful == arm.joint_names
    assert motion.differentiation.summary().endswith("name a cut-off")
    motion = trajectory(arm, t, true[0] + 1e-4 * filtered, cutoff=6.0)
    block = joined(motion)
    off, sigma = errors(block, true), band(block)
    assert ((np.abs(off) <= WITHIN * sigma).mean(axis=(0, 1)) > 0.93).all()
    assert (np.sqrt((sigma**2).mean(axis=(0, 1))) < 2.0 * np.sqrt((off**2).mean(axis=(0, 1)))).all()
    assert motion.differentiation is not None
    assert not motion.differentiation.doubtful
