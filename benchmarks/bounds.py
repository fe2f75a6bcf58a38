"""Claim: no error exceeds the kernel's bound, proven by intervals, on a million states of RTTRR, 100,000 of others.

The kernel with bounds computes tau, F, N, f, n, and another one tau alone, with inertia moved between links; the
recursion in intervals of 192 bits encloses the true values of the same states. A bound counts as kept only if all of
the interval of the error lies within it. Results: violations, bound over true error (median and least), and the time
with bounds over that of the plain kernel.

Run: python benchmarks/bounds.py [--states N] [--others N] [--robots NAME ...] [--time] [--save]. Exit 1 on a violation.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from statistics import median
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish, result
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.exact.intervals import precision
from rttrr_pin.exact.straight_line import straight_line
from rttrr_pin.validation import Sampler

ROBOTS = ("rttrr", "trr", "trtr", "trtrr", "trttr", "example:panda", "example:talos_reduced")
ALONE = "tau alone"
BLOCK = 1000
BITS = 192
COLUMNS = (*QUANTITIES, ALONE)
EPS = float(np.finfo(float).eps)


@cache
def kernel(name: str) -> tuple[Any, Any, Any, Any]:
    """The robot, its kernel without and with bounds, and one of tau and its bound alone."""
    robot = rttrr_pin.load(name)
    bounds = tuple(f"{quantity}_bound" for quantity in QUANTITIES)
    return (
        robot,
        robot.compile(QUANTITIES),
        robot.compile((*QUANTITIES, *bounds)),
        robot.compile(("tau", "tau_bound")),
    )


def block(job: tuple[str, int, int]) -> tuple[str, int, dict[str, tuple[int, np.ndarray, float, float, float]]]:
    """Violations, sampled ratios bound / error, and the largest error and bound in eps of the vector, by quantity."""
    name, first, count = job
    robot, _, bounded, alone = kernel(name)
    states = Sampler(robot.model, "uniform", 0, rttrr_pin.RandomPayload(robot.link_names[-1])).draw(first, count)
    wrench = [rttrr_pin.Wrench(x.f, x.n, robot.link_names[x.link]) for x in states.loads]
    computed = bounded(states.q, states.v, states.a, payload=wrench, threads=1)
    tau = alone(states.q, states.v, states.a, payload=wrench, threads=1)
    computed |= {ALONE: tau["tau"], f"{ALONE}_bound": tau["tau_bound"]}
    prepare, columns = straight_line(robot.model, tuple((load.link, load.in_base) for load in states.loads), "doubles")
    inputs = np.hstack([states.q, states.v, states.a, *(x for load in states.loads for x in (load.f, load.n))])
    ends = np.cumsum([0, *(computed[quantity][0].size for quantity in COLUMNS)])
    values, bounds = (np.hstack([computed[q + end].reshape(count, -1) for q in COLUMNS]) for end in ("", "_bound"))
    results = [*columns, *columns[: robot.model.nv]]
    errors, kept = np.empty_like(values), np.empty(values.shape, dtype=bool)
    with precision(BITS):
        run = prepare()
        for row, state in enumerate(inputs.tolist()):
            truth = run(state)
            distances = [abs(truth[k] - x) for k, x in zip(results, values[row].tolist(), strict=True)]
            errors[row] = [float(x) for x in distances]
            kept[row] = [x <= bound for x, bound in zip(distances, bounds[row].tolist(), strict=True)]
    figures = {}
    for quantity, first_, last in zip(COLUMNS, ends, ends[1:], strict=False):
        x, error, bound = (y[:, first_:last] for y in (values, errors, bounds))
        size = np.linalg.norm(x, axis=1)
        size[size == 0.0] = np.inf
        wrong = error > 0.0
        ratios = np.sort(bound[wrong] / error[wrong])
        worst, widest = (float((y.max(axis=1) / size).max() / EPS) for y in (error, bound))
        broken = int((~kept[:, first_:last]).sum())
        figures[quantity] = (broken, ratios[:: max(1, len(ratios) // 200)], ratios.min(initial=np.inf), worst, widest)
    return name, count, figures


def cost(name: str) -> float:
    """Time with bounds over time without, the median of repeats taken in turn."""
    robot, plain, bounded, _ = kernel(name)
    states = Sampler(robot.model, "uniform", 0).draw(0, 20_000)
    ratios = []
    for _ in range(7):
        times = []
        for run in (plain, bounded):
            start = time.perf_counter()
            run(states.q, states.v, states.a, threads=1)
            times.append(time.perf_counter() - start)
        ratios.append(times[1] / times[0])
    return median(ratios)


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, default=1_000_000)
    parser.add_argument("--others", type=int, default=100_000)
    parser.add_argument("--robots", nargs="*", default=ROBOTS)
    parser.add_argument("--time", action="store_true", help="measure the cost again, and keep what else was saved")
    chosen = parser.parse_args()
    if chosen.time:
        saved = result("bounds")
        for name, robot in saved["robots"].items():
            robot["time_with_bounds_over_plain"] = round(cost(name), 2)
        finish("bounds", {key: saved[key] for key in ("violations", "robots")}, chosen.save)
        return 0
    figures: dict[str, Any] = {}
    violations = 0
    for name in chosen.robots:
        start = time.perf_counter()
        states = chosen.states if name == "rttrr" else chosen.others
        jobs = [(name, first, min(BLOCK, states - first)) for first in range(0, states, BLOCK)]
        with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
            results = list(pool.map(block, jobs))
        quantities = {}
        for quantity in COLUMNS:
            parts = [part[quantity] for _, _, part in results]
            ratios = np.concatenate([part[1] for part in parts])
            quantities[quantity] = {
                "violations": sum(part[0] for part in parts),
                "bound_over_error_median": round(float(np.median(ratios)), 1) if len(ratios) else None,
                "bound_over_error_least": round(min(float(part[2]) for part in parts), 2),
                "largest_error_eps": round(max(part[3] for part in parts), 2),
                "largest_bound_eps": round(max(part[4] for part in parts), 1),
            }
            violations += quantities[quantity]["violations"]
        figures[name] = {
            "states": sum(count for _, count, _ in results),
            "quantities": quantities,
            "time_with_bounds_over_plain": round(cost(name), 2),
            "seconds": round(time.perf_counter() - start, 1),
        }
        print(f"{name}: {figures[name]}", file=sys.stderr, flush=True)
    finish("bounds", {"violations": violations, "robots": figures}, chosen.save)
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
