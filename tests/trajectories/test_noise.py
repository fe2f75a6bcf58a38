"""Noise is told from motion."""

from __future__ import annotations

import numpy as np

import rttrr_pin
from rttrr_pin.trajectories.noise import white_noise
from support.logs import excitation


def test_noise_is_told_from_motion() -> None:
    arm = rttrr_pin.load("rttrr")
    rng = np.random.default_rng(5)
    t = np.arange(0, 10, 1e-3)
    tau = arm.inverse_dynamics(*excitation(arm.model, t, 2)).tau
    sizes = np.array([0.01, 0.05, 0.5, 0.001, 2.0])
    np.testing.assert_allclose(white_noise(t, tau + sizes * rng.standard_normal(tau.shape)), sizes, rtol=0.1)
    slow = slice(None, None, 100)
    assert np.isnan(white_noise(t[slow], tau[slow])).all()  # 10 Hz: what differences see is motion
    filtered = np.apply_along_axis(np.convolve, 0, rng.standard_normal(tau.shape), np.ones(20) / 20, "same")
    assert np.isnan(white_noise(t, tau + filtered)).all()
