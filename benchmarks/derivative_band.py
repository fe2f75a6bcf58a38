"""Claim: the true v, a and tau lie within the band of 95 percent in 95 percent of the rows or more.

Run: python benchmarks/derivative_band.py [--rows N] [--seeds N] [--save]. Motion of the RTTRR arm with known
derivatives, in four shapes; q is measured with noise, or in the steps of an encoder, at even times or uneven ones, and
nothing else is given. "coverage" is the share of rows and joints within the band; "width" the root mean square of half
the band over that of the error times 1.96: 1 is as wide as it must be. "trapezoids" jump in a, which no spline follows:
it is the hardest case, and no machine moves so. Exit 1 if any coverage is below 0.95.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from rttrr_pin import Robot
from rttrr_pin.core.arrays import Array
from rttrr_pin.loads.evaluation import Evaluator
from rttrr_pin.trajectories import trajectory

ROWS, SEEDS, WITHIN, WANTED = 8192, 3, 1.96, 0.95

MEASURED: tuple[tuple[str, float, float, float, float], ...] = (
    ("1 kHz, noise 1e-5", 1000.0, 1e-5, 0.0, 0.0),
    ("1 kHz, noise 1e-3", 1000.0, 1e-3, 0.0, 0.0),
    ("250 Hz, noise 1e-4", 250.0, 1e-4, 0.0, 0.0),
    ("125 Hz, noise 1e-5", 125.0, 1e-5, 0.0, 0.0),
    ("100 Hz, noise 1e-3", 100.0, 1e-3, 0.0, 0.0),
    ("500 Hz, steps of 3.8e-4", 500.0, 0.0, 2 * np.pi / 2**14, 0.0),
    ("500 Hz, steps of 1.2e-5", 500.0, 0.0, 2 * np.pi / 2**19, 0.0),
    ("250 Hz uneven, noise 1e-4", 250.0, 1e-4, 0.0, 0.3),
    ("250 Hz, exact", 250.0, 0.0, 0.0, 0.0),
)
"""What it is called, rate [Hz], noise and steps [rad or m], and how far times are off even ones, of their distance."""

Motion = tuple[Array, Array, Array]

Profile = Callable[[Array], Motion]


def quintic(s: Array) -> Motion:
    return s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2, 60 * s * (1 - s) * (1 - 2 * s)


def cycloid(s: Array) -> Motion:
    w = 2 * np.pi
    return s - np.sin(w * s) / w, 1 - np.cos(w * s), w * np.sin(w * s)


def trapezoid(s: Array) -> Motion:
    ramp, top = 0.25, 1 / 0.75
    first, last = s < ramp, s >= 1 - ramp
    q = np.where(first, top * s**2 / 2 / ramp, np.where(last, 1 - top * (1 - s) ** 2 / 2 / ramp, top * (s - ramp / 2)))
    v = np.where(first, top * s / ramp, np.where(last, top * (1 - s) / ramp, top))
    return q, v, np.where(first, top / ramp, np.where(last, -top / ramp, 0.0))


def sines(t: Array, rng: np.random.Generator) -> Motion:
    w = 2 * np.pi * np.array([0.2, 0.35, 0.5, 0.7, 0.9])
    size = rng.uniform(0.3, 1.0, len(w))
    angle = np.outer(t, w) + rng.uniform(0, 2 * np.pi, len(w))
    size /= size.sum()
    return np.sin(angle) @ size, np.cos(angle) @ (size * w), -np.sin(angle) @ (size * w**2)


def moves(profile: Profile) -> Callable[[Array, np.random.Generator], Motion]:
    """From rest to rest, with pauses."""

    def motion(t: Array, rng: np.random.Generator) -> Motion:
        q, v, a = np.zeros((3, len(t)))
        begin = place = 0.0
        while begin < t[-1]:
            T = rng.uniform(0.4, 1.5)
            way = rng.uniform(-1.0, 1.0) * T
            way = -way if abs(place + way) > 1.0 else way
            inside = (t >= begin) & (t < begin + T)
            shape = profile((t[inside] - begin) / T)
            q[inside], v[inside], a[inside] = place + way * shape[0], way * shape[1] / T, way * shape[2] / T**2
            place += way
            begin += T
            q[t >= begin] = place
            begin += rng.uniform(0.1, 0.8)
        return q, v, a

    return motion


SHAPES = {
    "sines": sines,
    "quintics": moves(quintic),
    "cycloids": moves(cycloid),
    "trapezoids": moves(trapezoid),
}


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    chosen = parser.parse_args()
    arm = rttrr_pin.load("rttrr")
    cases = [
        {"motion": shape, "measured": measured[0], **covered(arm, shape, measured, chosen.rows, chosen.seeds)}
        for shape in SHAPES
        for measured in MEASURED
    ]
    least = {key: min(case["coverage"][key] for case in cases) for key in ("v", "a", "tau")}
    widest = {key: max(case["width"][key] for case in cases) for key in ("v", "a", "tau")}
    figures = {"rows": chosen.rows, "seeds": chosen.seeds, "least_coverage": least, "widest": widest, "cases": cases}
    finish("derivative_band", figures, chosen.save)
    return int(min(least.values()) < WANTED)


def covered(arm: Robot, shape: str, measured: tuple[str, float, float, float, float], rows: int, seeds: int) -> Any:
    """Coverage and width of all rows and joints, of several seeds."""
    _, rate, noise, steps, uneven = measured
    evaluator = Evaluator(arm, (), "rows")
    off: dict[str, list[Array]] = {key: [] for key in ("v", "a", "tau")}
    half: dict[str, list[Array]] = {key: [] for key in off}
    for seed in range(seeds):
        rng = np.random.default_rng([seed, list(SHAPES).index(shape)])
        t = (np.arange(rows) + uneven * rng.uniform(-1.0, 1.0, rows)) / rate
        joints = [SHAPES[shape](t, rng) for _ in range(arm.model.nv)]
        scale = np.array([0.1 if not turns else 1.0 for turns in arm.model.rotations])
        true = [np.stack([joint[k] for joint in joints], axis=1) * scale for k in range(3)]
        q = true[0] + noise * scale * rng.standard_normal(true[0].shape)
        if steps:
            q = np.round(q / (steps * scale)) * (steps * scale)
        for block in trajectory(arm, t, q).blocks():
            part = slice(block.start, block.start + len(block))
            widths = evaluator.half_widths(block)
            assert widths is not None
            assert block.errors is not None
            sigma = np.sqrt((block.errors**2).sum(axis=-1))
            tau = arm.inverse_dynamics(block.q, block.v, block.a).tau
            exact = arm.inverse_dynamics(*(x[part] for x in true)).tau
            for key, error, width in (
                ("v", block.v - true[1][part], WITHIN * sigma[..., 1]),
                ("a", block.a - true[2][part], WITHIN * sigma[..., 2]),
                ("tau", tau - exact, widths["tau"]),
            ):
                off[key].append(np.abs(error))
                half[key].append(width)
    errors, widths = ({key: np.concatenate(x) for key, x in own.items()} for own in (off, half))
    inside = {key: errors[key] <= widths[key] for key in errors}
    return {
        "coverage": {key: round(float(x.mean()), 4) for key, x in inside.items()},
        "width": {key: round(_rms(widths[key]) / WITHIN / _rms(errors[key]), 3) for key in errors},
        "rms_error": {key: _rms(x) for key, x in errors.items()},
    }


def _rms(x: Array) -> float:
    return float(np.sqrt((x**2).mean()))


if __name__ == "__main__":
    raise SystemExit(main())
