"""Logs as a robot would write them: sums of sines within its limits, with noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rttrr_pin import Robot
from rttrr_pin.core.model import Model
from rttrr_pin.validation.sampling import Ranges

FREQUENCIES = 2 * np.pi * np.array([0.2, 0.35, 0.5, 0.7, 0.9])


def excitation(model: Model, t: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a of each joint at times, at 0.8 of its range or its largest rate."""
    rng, ranges, w = np.random.default_rng(seed), Ranges.of(model), FREQUENCIES
    q, v, a = np.zeros((3, len(t), model.nv))
    for j in range(model.nv):
        size = rng.uniform(0.3, 1.0, len(w))
        half = (ranges.upper[j] - ranges.lower[j]) / 2
        size *= min(0.8 * half / size.sum(), 0.8 * ranges.rate[j] / (size * w).sum())
        angle = np.outer(t, w) + rng.uniform(0, 2 * np.pi, len(w))
        q[:, j] = ranges.lower[j] + half + np.sin(angle) @ size
        v[:, j], a[:, j] = np.cos(angle) @ (size * w), -np.sin(angle) @ (size * w**2)
    return q, v, a


def write_log(
    path: Path,
    real: Robot,
    seed: int = 0,
    rate: float = 1000.0,
    seconds: float = 10.0,
    of_q: float = 1e-5,
    of_tau: float = 0.05,
    offset: float = 0.0,
    times: np.ndarray | None = None,
    header: str = "time",
    columns: str = "",
    unit: float = 1.0,
) -> Path:
    """A log of a robot whose first tau has an offset; with the true v and a too, where `columns` says so."""
    t = np.arange(0.0, seconds, 1.0 / rate) if times is None else times
    q, v, a = excitation(real.model, t, seed)
    rng = np.random.default_rng(seed + 1000)
    tau = real.inverse_dynamics(q, v, a).tau + of_tau * rng.standard_normal(q.shape)
    tau[:, 0] += offset
    parts = {"q": q + of_q * rng.standard_normal(q.shape), "v": v, "a": a, "tau": tau}
    kept = [key for key in parts if key in ("q", "tau") or key in columns]
    names = [f"{key}_{name}" for key in kept for name in real.model.v_names]
    table = np.hstack([t[:, None] / unit, *(parts[key] for key in kept)])
    np.savetxt(path, table, "%.12g", ",", header=",".join([header, *names]), comments="")
    return path
