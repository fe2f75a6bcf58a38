"""Claim: where v and a are derived, the true load lies within the band in at least 95 percent of the rows.

Run: python benchmarks/error_band.py [--rows N] [--save]. Motions whose derivatives are known are sampled with noise; v
and a are derived from that, and loads with their bands from those. Compared with the loads of the true q, v, a: the
share that lies within, of all numbers and of the worst column, and the root mean square of error / standard deviation,
which is 1 where a band is as wide as the error, and less where it is wider. Errors of neighbouring rows are alike, so
that the worst column has few of its own. Exit 1 if a share of all numbers is below the claim.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from rttrr_pin.core.arrays import Array
from rttrr_pin.loads.evaluation import Evaluator
from rttrr_pin.loads.parts import BAND
from rttrr_pin.trajectories import Block, trajectory

SHARE = 0.95

SEED = 0

ROBOTS = {"rttrr": "rttrr", "arm6": "urdf/levels/arm6.urdf"}

NOISES: tuple[tuple[float, float], ...] = ((1000.0, 1e-6), (1000.0, 1e-5), (250.0, 1e-5), (250.0, 1e-4), (100.0, 1e-4))
"""Rows a second, and standard deviation of the noise of q [rad or m]."""

QUANTITIES = ("tau", "f", "n", "power")

Motion = Callable[[Array, int, np.random.Generator], tuple[Array, Array, Array]]


def sines(t: Array, nv: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Three sines of up to 1 Hz in each degree of freedom."""
    q, v, a = np.zeros((3, len(t), nv))
    for _ in range(3):
        w, phase, size = (
            2 * np.pi * rng.uniform(0.1, 1.0, nv),
            rng.uniform(0, 2 * np.pi, nv),
            rng.uniform(0.02, 0.1, nv),
        )
        s, c = size * np.sin(np.outer(t, w) + phase), size * np.cos(np.outer(t, w) + phase)
        q, v, a = q + s, v + w * c, a - w * w * s
    return q, v, a


def quintics(t: Array, nv: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """From rest to rest in a second, then a pause of half a second, over and over."""
    poses = rng.uniform(-0.2, 0.2, (int(t[-1] / 1.5) + 2, nv))
    k = (t / 1.5).astype(int)
    s = np.clip(t - 1.5 * k, 0.0, 1.0)[:, None]
    steps = poses[k + 1] - poses[k]
    moved, rate = 10 * s**3 - 15 * s**4 + 6 * s**5, 30 * s**2 - 60 * s**3 + 30 * s**4
    return poses[k] + steps * moved, steps * rate, steps * (60 * s - 180 * s**2 + 120 * s**3)


MOTIONS: dict[str, Motion] = {"sines": sines, "rest to rest": quintics}


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--rows", type=int, default=20_000)
    chosen = parser.parse_args()
    cases = [
        case(robot, motion, rate, noise, chosen.rows)
        for robot in ROBOTS
        for motion in MOTIONS
        for rate, noise in NOISES
    ]
    least = min(share for own in cases for share in own["inside"].values())
    finish("error_band", {"rows": chosen.rows, "seed": SEED, "least": least, "cases": cases}, chosen.save)
    return int(not least >= SHARE)


def case(name: str, motion: str, rate: float, noise: float, rows: int) -> dict[str, Any]:
    """One robot, one motion, one noise."""
    robot = rttrr_pin.load(ROBOTS[name])
    rng = np.random.default_rng(SEED)
    t = np.arange(rows) / rate
    q, v, a = MOTIONS[motion](t, robot.model.nv, rng)
    noisy = trajectory(robot, t, q + noise * rng.normal(size=q.shape))
    evaluator = Evaluator(robot, QUANTITIES)
    errors: dict[str, list[Array]] = {key: [] for key in QUANTITIES}
    for block in noisy.blocks():
        own = slice(block.start, block.start + len(block))
        true = evaluator.of(Block(block.start, block.rows, block.time, q[own], v[own], a[own]))
        found, half_widths = evaluator.of(block), evaluator.half_widths(block)
        assert half_widths is not None
        for key in QUANTITIES:
            with np.errstate(invalid="ignore", divide="ignore"):
                ratio = np.abs(found[key] - true[key]) / half_widths[key]
            errors[key].append(np.nan_to_num(ratio.reshape(len(block), -1), nan=0.0, posinf=np.inf))
    joined = {key: np.concatenate(parts) for key, parts in errors.items()}
    return {
        "robot": name,
        "motion": motion,
        "rate": rate,
        "noise": noise,
        "inside": {key: float((x <= 1.0).mean()) for key, x in joined.items()},
        "worst_column": {key: float((x <= 1.0).mean(axis=0).min()) for key, x in joined.items()},
        "rms": {key: float(np.sqrt(((BAND * x) ** 2).mean())) for key, x in joined.items()},
    }


if __name__ == "__main__":
    raise SystemExit(main())
