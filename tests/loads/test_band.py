"""The band of 95 percent is what errors of q, v and a come to by the exact derivatives."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rttrr_pin import Robot
from rttrr_pin.loads import compute_loads
from rttrr_pin.loads.evaluation import Evaluator
from rttrr_pin.loads.parts import BAND
from support.trajectories import OfBlock, random_rows


def test_it_is_what_the_exact_derivatives_say(tree: Robot) -> None:
    block = random_rows(tree, 30, errors=True)
    assert block.errors is not None
    own = Evaluator(tree, ("power",)).half_widths(block)
    assert own is not None
    parts = tree.derivatives(block.q, block.v, block.a)
    J = np.stack(parts, axis=-1)  # (N, tau, degree of freedom, of q v a)
    moved = np.einsum("nijx,njxk->nijk", J, block.errors)
    np.testing.assert_allclose(own["tau"], BAND * np.sqrt((moved**2).sum(axis=(2, 3))), rtol=1e-4)
    tau = tree.inverse_dynamics(block.q, block.v, block.a).tau
    of_power = moved * block.v[:, :, None, None]
    for j in range(tree.model.nv):
        of_power[:, j, j] += tau[:, j, None] * block.errors[:, j, 1]
    np.testing.assert_allclose(own["power"], BAND * np.sqrt((of_power**2).sum(axis=(2, 3))), rtol=1e-4)


def test_what_is_measured_has_no_band(tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 10)
    report = compute_loads(tree, OfBlock(tree, block), output=tmp_path / "x.csv")
    header = (tmp_path / "x.csv").read_text().partition("\n")[0]
    assert not report.band and report.history.band_low is None and "_error" not in header
    assert all(joint.tau.peak.error is None for joint in report.joints)
    assert Evaluator(tree, ()).half_widths(block) is None


def test_what_is_known_exactly_has_a_band_of_zero(tree: Robot) -> None:
    block = random_rows(tree, 10, errors=True)
    assert block.errors is not None
    own = Evaluator(tree, ()).half_widths(replace(block, errors=block.errors * 0.0))
    assert own is not None and not own["tau"].any()


def test_peaks_of_joints_and_bearings_carry_it(tree: Robot) -> None:
    block = random_rows(tree, 20, errors=True)
    report = compute_loads(tree, OfBlock(tree, block))
    evaluator = Evaluator(tree, ("radial", "axial"))
    own = evaluator.half_widths(block)
    assert own is not None and block.errors is not None
    for j, joint in enumerate(report.joints):
        k = int(joint.tau.peak.row - block.rows[0])
        assert joint.tau.peak.error == own["tau"][k, j]
        of_rates = block.errors[int(joint.speed.row - block.rows[0]), j, 1]
        assert joint.speed.error == pytest.approx(BAND * np.linalg.norm(of_rates))
    for i, bearing in enumerate(report.bearings):
        k = int(bearing.radial.peak.row - block.rows[0])
        assert bearing.radial.peak.error == own["radial"][k, i] > 0.0
    assert not any("±" in joint.name for joint in report.joints)


def test_it_can_be_left_out(tree: Robot) -> None:
    block = random_rows(tree, 10, errors=True)
    report = compute_loads(tree, OfBlock(tree, block), band=False)
    assert not report.band and report.history.band_low is None
