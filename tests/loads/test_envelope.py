"""Envelopes are what their definitions say, of whole arrays, in whatever blocks the rows come."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import InputError, Robot, RttrrError, Wrench, load
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.loads import LoadReport, compute_loads
from rttrr_pin.loads.bearings import axes
from rttrr_pin.loads.sums import Means
from rttrr_pin.trajectories import Block
from support.trajectories import FIRST_ROW, OfBlock, random_rows


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else every trajectory here would be a single block."""
    monkeypatch.setattr("rttrr_pin.loads.run.weighted.__defaults__", (17,))


def data(report: LoadReport) -> dict[str, Any]:
    """All but the time that it took."""
    own = report.to_dict()
    del own["wall_time"], own["outputs"]
    return own


@pytest.mark.parametrize(
    ("end", "sizes"), [(".csv", (1,)), (".csv", (10_000,)), (".parquet", (7, 1, 30)), (".npz", (7, 1, 30))]
)
def test_the_same_bits_in_whatever_blocks(end: str, sizes: tuple[int, ...], tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 90, errors=True, payload=True)
    asked = ("tau", "F", "n", "power", "energy")
    results = []
    for own in (sizes, (90,)):
        file = tmp_path / f"{len(results)}{end}"
        report = compute_loads(tree, OfBlock(tree, block, own), quantities=asked, output=file)
        results.append((data(report), file.read_bytes()))
    assert results[0] == results[1]


def test_means_are_what_their_formulas_say(tree: Robot) -> None:
    block = random_rows(tree, 300, seed=3)
    report = compute_loads(tree, OfBlock(tree, block))
    result = tree.inverse_dynamics(block.q, block.v, block.a)
    t, T = block.time, block.time[-1] - block.time[0]
    for j, joint in enumerate(report.joints):
        tau, v = result.tau[:, j], block.v[:, j]
        assert joint.tau.rms == pytest.approx((np.trapezoid(tau**2, t) / T) ** 0.5, rel=1e-12)
        assert joint.tau.cubic_mean == pytest.approx((np.trapezoid(abs(tau) ** 3, t) / T) ** (1 / 3), rel=1e-12)
        by_rate = (np.trapezoid(abs(v * tau**3), t) / np.trapezoid(abs(v), t)) ** (1 / 3)
        assert joint.gear_torque == pytest.approx(by_rate, rel=1e-12)
        assert joint.mean_speed == pytest.approx(np.trapezoid(abs(v), t) / T, rel=1e-12)
        assert joint.energy_in - joint.energy_back == pytest.approx(np.trapezoid(tau * v, t), rel=1e-9)
        assert joint.reversals == np.count_nonzero(np.sign(v[1:]) != np.sign(v[:-1]))
        peak = int(np.argmax(abs(tau)))
        assert (joint.tau.peak.value, joint.tau.peak.row) == (tau[peak], peak + FIRST_ROW)
        assert joint.power.value == (tau * v)[np.argmax(abs(tau * v))]


def test_a_bearing_carries_what_is_across_its_axis(tree: Robot) -> None:
    """And the drive what is along its freedom, of the axis's own joint alone."""
    block = random_rows(tree, 40, seed=1)
    report = compute_loads(tree, OfBlock(tree, block))
    result = tree.inverse_dynamics(block.q, block.v, block.a)
    u = axes(tree.model)
    for i, own in enumerate(report.bearings):
        f, n = result.f[:, i], result.n[:, i]
        axial, torsion = f @ u[i], n @ u[i]
        radial, tilting = np.linalg.norm(np.cross(f, u[i]), axis=1), np.linalg.norm(np.cross(n, u[i]), axis=1)
        for level, x in ((own.axial, axial), (own.torsion, torsion), (own.radial, radial), (own.tilting, tilting)):
            k = int(np.argmax(abs(x)))
            assert level.peak.value == pytest.approx(x[k], rel=1e-12)
            assert level.rms == pytest.approx((np.trapezoid(x**2, block.time) / np.ptp(block.time)) ** 0.5, rel=1e-12)


def test_the_drive_carries_along_the_freedom_of_a_joint() -> None:
    robot = load("rttrr").with_joint_effects({"joint_1": JointEffects(armature=0.3)})
    block = random_rows(robot, 30)
    report = compute_loads(robot, OfBlock(robot, block))
    result = robot.inverse_dynamics(block.q, block.v, block.a)
    carried = np.abs(result.tau - result.tau_joint).max(axis=0)
    along = [own.torsion if own.kind == "bearing" else own.axial for own in report.bearings if own.kind != "flange"]
    np.testing.assert_allclose([abs(level.peak.value) for level in along], carried, rtol=1e-12)


@pytest.mark.parametrize("exponent", [-900, -300, 300, 900])
def test_powers_of_large_and_small_numbers_are_not_lost(exponent: int) -> None:
    """Multiplied by a power of two, means are multiplied by it, bit by bit, though their cubes are no float64."""
    rng = np.random.default_rng(0)
    x, rates, weights = rng.normal(size=(3, 20)), rng.normal(size=(3, 20)), rng.uniform(size=20)
    plain, scaled = Means(3), Means(3)
    for part in (slice(0, 3), slice(3, 20)):
        plain.add(abs(x[:, part]), weights[part], abs(rates[:, part]))
        scaled.add(abs(np.ldexp(x[:, part], exponent)), weights[part], abs(np.ldexp(rates[:, part], exponent)))
    for name in ("rms", "cubic", "mean_rates", "cubic_by_rate"):
        np.testing.assert_array_equal(getattr(scaled, name), np.ldexp(np.array(getattr(plain, name)), exponent))


def test_peaks_are_at_states_that_have_them(tree: Robot) -> None:
    block = random_rows(tree, 50, seed=7, payload=True)
    report = compute_loads(tree, OfBlock(tree, block))
    for j, joint in enumerate(report.joints):
        assert joint.tau.peak.state is not None
        state = report.states[joint.tau.peak.state]
        tau = tree.inverse_dynamics(state.q, state.v, state.a, state.payload).tau[j]
        assert tau == joint.tau.peak.value and (state.row, state.time) == (joint.tau.peak.row, joint.tau.peak.time)
        assert f"peak tau of {joint.name}" in state.name
    assert [state.time for state in report.states] == sorted({state.time for state in report.states})


@pytest.mark.parametrize("count", [1, 2, 1023, 1025, 5000])
def test_history_and_samples_are_of_all_rows(count: int) -> None:
    robot = load("rttrr")
    base = random_rows(robot, count, errors=True)
    report = compute_loads(robot, OfBlock(robot, base, (999,)), bearings=False)
    tau, history = robot.compile("tau")(base.q, base.v, base.a), report.history
    starts = np.arange(0, count, history.rows)
    assert len(history.time) == len(starts) <= 1024 and history.rows < max(2, 4 * count / 1024)
    np.testing.assert_array_equal(history.low, np.minimum.reduceat(tau, starts))
    np.testing.assert_array_equal(history.high, np.maximum.reduceat(tau, starts))
    assert history.band_low is not None and history.band_high is not None
    assert (history.band_low <= history.low).all() and (history.band_high >= history.high).all()
    assert (np.diff(history.time) > 0).all()
    samples = report.samples
    step = int(samples.row[1] - samples.row[0]) if count > 1 else 1
    every = np.arange(0, count, step)
    assert len(samples.row) <= 2048 and (step == 1 or len(samples.row) > 1000)
    np.testing.assert_array_equal(samples.row, every + FIRST_ROW)
    np.testing.assert_array_equal(samples.tau, tau[every])


def test_speeds_within_their_band_of_zero_are_no_reversals() -> None:
    robot = load("trr")
    t = np.linspace(0.0, 1.0, 401)
    v = np.tile(np.cos(2 * np.pi * t), (robot.model.nv, 1)).T
    block = random_rows(robot, len(t), errors=True)
    assert block.errors is not None
    jitter = 1e-3 * (-1.0) ** np.arange(len(t))[:, None]
    noisy = replace(block, time=t, v=np.where(abs(v) < 0.05, jitter, v))
    sure = replace(noisy, errors=block.errors * 1e-9)
    blurred = replace(noisy, errors=np.zeros_like(block.errors) + 0.03 * np.tri(3))
    counts = [[j.reversals for j in compute_loads(robot, OfBlock(robot, own)).joints] for own in (sure, blurred)]
    assert all(count > 10 for count in counts[0]) and counts[1] == [2] * robot.model.nv


def test_all_still_and_one_row() -> None:
    robot = load("rttrr")
    zero = np.zeros((40, 5))
    for count in (1, 3, 40):
        block = Block(0, np.arange(count), np.arange(count) * 1.0, zero[:count], zero[:count], zero[:count])
        report = compute_loads(robot, OfBlock(robot, block))
        tau = robot.inverse_dynamics(zero[0], zero[0], zero[0]).tau
        assert [joint.tau.rms for joint in report.joints] == pytest.approx(abs(tau))
        assert all(joint.gear_torque is None and joint.mean_speed == 0.0 for joint in report.joints)
        assert {joint.tau.peak.row for joint in report.joints} == {0}  # the first of all that are as large
        assert report.passed and report.rows == count and report.seconds == count - 1
        assert not any("speed" in state.name for state in report.states)


def test_a_load_that_overflows_names_its_row(tmp_path: Path) -> None:
    robot = load("rttrr")
    block = random_rows(robot, 40)
    block.v[33] = 1e200
    with pytest.raises(RttrrError, match=rf"rows, row {33 + FIRST_ROW}: tau overflows, where \|v\| reaches 1e\+200"):
        compute_loads(robot, OfBlock(robot, block), output=tmp_path / "x.csv", bearings=False)
    assert list(tmp_path.iterdir()) == []


def test_a_payload_of_the_trajectory_takes_no_other() -> None:
    robot = load("rttrr")
    motion = OfBlock(robot, random_rows(robot, 5, payload=True))
    with pytest.raises(InputError, match="rows has a payload of its own, at tool, and a payload is passed too"):
        compute_loads(robot, motion, payload=Wrench((0, 0, 1)))


def test_a_body_is_what_its_weight_and_inertia_are() -> None:
    """A point mass at the tool carries a wrench of M (a - g) there; a still one its weight."""
    robot = load("rttrr")
    still = random_rows(robot, 20)
    still = replace(still, v=still.v * 0, a=still.a * 0)
    weight = Wrench((0.0, 0.0, 2.0 * 9.81), expressed_in="base")
    by_wrench = compute_loads(robot, OfBlock(robot, still), payload=weight)
    carrying = robot.with_payload_body(2.0)
    by_body = compute_loads(carrying, OfBlock(carrying, still))
    for one, other in zip(by_wrench.joints, by_body.joints, strict=True):
        assert one.tau.rms == pytest.approx(other.tau.rms, rel=1e-12)
