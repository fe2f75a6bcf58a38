"""Claim: in float32 a kernel computes about twice the states in the same time, and keeps its bound, which is tight.

Run: python benchmarks/kernel_float32.py [--proven N] [--repeats N] [--save]. Speed: tau on one thread, rows and columns
of each type, and rows of float64 read by the kernel in float32, in turns in one process; least CPU time. Proof: at
random states that float32 holds, errors of tau against enclosures, as shares of the bound; beside it the allowance of a
program in float32 of which nothing is known. Exit 1 if an error exceeds its bound.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from kernel_speed import ROBOTS
from rttrr_pin import Robot
from rttrr_pin.exact import enclose
from rttrr_pin.implementations import Batch, default_allowance
from rttrr_pin.implementations.allowance import SINGLE
from rttrr_pin.validation import Sampler

STATES = (1_000, 100_000)

SHARE = 0.05
"""Seconds of work in one measurement."""


def cpu_time(run: Callable[[], object], calls: int) -> float:
    """Seconds of one call."""
    start = time.thread_time()
    for _ in range(calls):
        run()
    return (time.thread_time() - start) / calls


def speed(robot: Robot, count: int, repeats: int) -> dict[str, Any]:
    """Nanoseconds of CPU time a state, and how many times as fast float32 is."""
    states = Sampler(robot.model, "uniform", 0).draw(0, count)
    double, single = robot.compile("tau"), robot.compile("tau", dtype="float32")
    rows = {dtype: [x.astype(dtype) for x in (states.q, states.v, states.a)] for dtype in ("float64", "float32")}
    columns = {dtype: [np.ascontiguousarray(x.T).T for x in arrays] for dtype, arrays in rows.items()}
    kernels = {"float64": double, "float32": single}
    work: dict[str, Callable[[], object]] = {}
    for dtype, kernel in kernels.items():
        out = np.empty((count, robot.model.nv), dtype)
        out_columns = np.empty((robot.model.nv, count), dtype).T
        work[f"{dtype}, rows"] = lambda k=kernel, x=rows[dtype], out=out: k(*x, out=out, threads=1)
        work[f"{dtype}, columns"] = lambda k=kernel, x=columns[dtype], out=out_columns: k(*x, out=out, threads=1)
    work["float64 rows to float32"] = lambda: single(*rows["float64"], out=out, threads=1)
    for run in work.values():
        run()  # compiles
    calls = {what: max(1, int(SHARE / cpu_time(run, 5))) for what, run in work.items()}
    least = dict.fromkeys(work, float("inf"))
    for _ in range(repeats):
        for what, run in work.items():
            least[what] = min(least[what], cpu_time(run, calls[what]))
    ns = {what: round(1e9 * seconds / count, 2) for what, seconds in least.items()}
    ratios = {layout: round(ns[f"float64, {layout}"] / ns[f"float32, {layout}"], 2) for layout in ("rows", "columns")}
    ratios["float64 rows to float32"] = round(ns["float64, rows"] / ns["float64 rows to float32"], 2)
    return {"states": count, "ns_per_state": ns, "times_as_fast": ratios}


def proof(robot: Robot, count: int) -> dict[str, float]:
    """Errors of tau in float32 beside the bound, and beside what any program in float32 is allowed."""
    drawn = Sampler(robot.model, "uniform", 1).draw(0, count)
    q, v, a = (x.astype(np.float32).astype(float) for x in (drawn.q, drawn.v, drawn.a))
    result = robot.compile(("tau", "tau_bound"), dtype="float32")(q, v, a)
    tau, bound = (result[name].astype(float) for name in ("tau", "tau_bound"))
    true = enclose(robot.model, q, v, a, (), "read").tau
    error = np.maximum(np.maximum(tau - true.lower, true.upper - tau), 0.0)
    beyond = np.maximum(np.maximum(true.lower - tau, tau - true.upper), 0.0)
    allowed = default_allowance(Batch(robot.model, q, v, a), SINGLE)["tau"]
    return {
        "states": count,
        "largest_share_of_bound": float((beyond / bound).max()),
        "bound_times_largest_error": float((bound.max(axis=0) / error.max(axis=0)).max()),
        "bound_times_error_median": float(np.median(bound / error)),
        "allowance_times_bound_median": float(np.median(allowed / bound)),
        "largest_error_of_tau": float((error / np.linalg.norm(tau, axis=1, keepdims=True)).max()),
        "largest_bound_of_tau": float((bound / np.linalg.norm(tau, axis=1, keepdims=True)).max()),
    }


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--proven", type=int, default=2_000, metavar="N", help="states of each robot")
    parser.add_argument("--repeats", type=int, default=15)
    chosen = parser.parse_args()
    robots: dict[str, dict[str, Any]] = {}
    for name, source in ROBOTS.items():
        robot = rttrr_pin.load(source)
        robots[name] = {
            "speed": [speed(robot, count, chosen.repeats) for count in STATES],
            "proof": proof(robot, chosen.proven),
        }
        print(f"{name}: {robots[name]}", file=sys.stderr, flush=True)
    holds = all(own["proof"]["largest_share_of_bound"] <= 1.0 for own in robots.values())
    finish("kernel_float32", {"repeats": chosen.repeats, "holds": holds, "robots": robots}, chosen.save)
    return int(not holds)


if __name__ == "__main__":
    sys.exit(main())
