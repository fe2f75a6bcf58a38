"""Claim: small batches, columns, float32, all outputs and two threads are as fast as the one case that is shown first.

Run: python benchmarks/kernel_batches.py [--repeats R] [--only ROBOT ...] [--save]. All kinds of call and
`rneaInParallel` on one thread take turns, so that a change of the clock meets all; a ratio is the median of those of
single turns. What runs on one thread is timed by the processor time of that thread, which other programs do not add to;
what runs on several, by the clock, against `rneaInParallel` by the clock: worth nothing on a machine that does other
work, and how busy it was stands in the result. Exit 1 if torques disagree.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np

import rttrr_pin
from common import arguments, finish
from kernel_speed import AGREEMENT, ROBOTS, SEED, write
from peers_run import PEERS
from rttrr_pin.compile import Kernel
from rttrr_pin.validation.sampling import Sampler

sys.path.insert(0, str(PEERS))
import pinocchio_parallel
from protocol import read

STATES = (1_000, 100_000)

OUTPUTS = ("tau", "F", "N", "f", "n")

SHORTEST = 0.004
"""The shortest time that is measured [s]; quicker work is repeated within it."""

Clock = Callable[[], float]

REFERENCE, REFERENCE_BY_CLOCK = "rneaInParallel", "rneaInParallel, by the clock"


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=25)
    parser.add_argument("--only", nargs="+", choices=ROBOTS, default=list(ROBOTS), metavar="ROBOT")
    chosen = parser.parse_args()
    processors, busy = len(os.sched_getaffinity(0)), [os.getloadavg()[0]]
    rows = [row for name in chosen.only for count in STATES for row in measure(name, count, processors, chosen.repeats)]
    busy.append(os.getloadavg()[0])
    worst = max(row["worst"] for row in rows)
    figures = {"seed": SEED, "repeats": chosen.repeats, "processors": processors, "load": busy, "worst": worst}
    finish("kernel_batches", {**figures, "agreement": AGREEMENT, "rows": rows}, chosen.save)
    return int(not worst <= AGREEMENT)


def measure(name: str, count: int, processors: int, repeats: int) -> list[dict[str, Any]]:
    """All calls of one robot with so many states."""
    robot = rttrr_pin.load(ROBOTS[name])
    states = Sampler(robot.model, "uniform", SEED).draw(0, count)
    with tempfile.TemporaryDirectory() as folder:
        urdf, file = Path(folder, f"{name}.urdf"), Path(folder, "states.npz")
        urdf.write_text(robot.model.urdf)
        write(file, robot, states, count)
        job = read(file, urdf, 1)
        pinocchio = pinocchio_parallel.prepare(job)
        rows = (job.q, job.v, job.a)
        tau, everything = robot.compile("tau"), robot.compile(OUTPUTS)
        work: dict[str, Callable[[], object]] = {REFERENCE: pinocchio.run, REFERENCE_BY_CLOCK: pinocchio.run}
        results: dict[str, np.ndarray] = {}
        for threads in sorted({1, processors}):
            many = f", {threads} threads" if threads > 1 else ""
            orders: tuple[tuple[str, Literal["C", "F"]], ...] = (("rows", "C"), ("columns", "F"))
            for layout, order in orders:
                given = [np.array(x, order=order) for x in rows]
                out = results[layout + many] = np.empty(job.v.shape, order=order)
                work[layout + many] = into(tau, given, out, threads)
        given = [x.astype(np.float32) for x in rows]
        work["rows of float32"] = into(tau, given, np.empty(job.v.shape), 1)
        several = everything(*rows)
        results["all outputs"] = several["tau"]
        work["all outputs"] = into(everything, rows, several, 1)
        work["copy of the bytes of all outputs"] = copies(rows, several)
        times = timed(work, repeats)
        reference = pinocchio.result()
    norms = np.linalg.norm(reference, axis=1)
    worst = {what: float((np.linalg.norm(x - reference, axis=1) / norms).max()) for what, x in results.items()}
    made = [
        {
            "robot": name,
            "states": count,
            "what": what,
            "ns_per_state": 1e9 * float(np.median(taken)) / count,
            "least": 1e9 * min(taken) / count,
            "times": float(np.median(np.divide(times[REFERENCE_BY_CLOCK if "threads" in what else REFERENCE], taken))),
            "worst": worst.get(what, 0.0),
        }
        for what, taken in times.items()
    ]
    print(
        *(
            f"{row['robot']} {row['states']} {row['what']}: {row['ns_per_state']:.1f} ns, {row['times']:.1f} times"
            for row in made
        ),
        sep="\n",
        file=sys.stderr,
    )
    return made


def into(kernel: Kernel[Any], given: Any, out: Any, threads: int) -> Callable[[], object]:
    """The call that writes to arrays that are there."""
    q, v, a = given
    return lambda: kernel(q, v, a, out=out, threads=threads)


def copies(rows: Any, results: dict[str, np.ndarray]) -> Callable[[], object]:
    """Reads what a kernel reads, and writes what it writes from arrays as large."""
    sources, targets = [x.copy() for x in results.values()], [np.empty_like(x) for x in results.values()]

    def run() -> None:
        for x in rows:
            x.sum()
        for source, target in zip(sources, targets, strict=True):
            np.copyto(target, source)

    return run


def timed(work: dict[str, Callable[[], object]], repeats: int) -> dict[str, list[float]]:
    """Seconds of a call, in turns."""
    calls = {}
    for what, run in work.items():
        run()
        start = time.perf_counter()
        run()
        calls[what] = max(1, int(SHORTEST / max(time.perf_counter() - start, 1e-7)))
    seconds: dict[str, list[float]] = {what: [] for what in work}
    for _ in range(repeats):
        for what, run in work.items():
            clock: Clock = time.perf_counter if "threads" in what or "clock" in what else time.thread_time
            start = clock()
            for _ in range(calls[what]):
                run()
            seconds[what].append((clock() - start) / calls[what])
    return seconds


if __name__ == "__main__":
    sys.exit(main())
