"""Claim: the cost of inverse dynamics is linear in the joints, also where the robot is too large for straight lines.

Run: python benchmarks/kernel_joints.py [--joints N ...] [--states N] [--save]. Chains of revolute joints about random
axes at random placements, driving forces, one thread. Each size is compiled as the kernel chooses (straight lines, or
calls of the recursion's steps) and as calls; the least of several runs counts. Before anything is timed, results are
compared with those of the readable recursion, exit 1 if one is off.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

import rttrr_pin
from common import arguments, finish
from rttrr_pin import Robot
from rttrr_pin.compile import Kernel, cache
from rttrr_pin.compile.build import build
from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.quantities import STRAIGHT_LINE
from rttrr_pin.validation import Sampler

sys.path.append(str(Path(__file__).parents[1] / "tests"))

JOINTS = (1, 2, 5, 10, 20, 50, 100, 150, 200, 400)

ROUNDS, RUNS, SINGLE = 12, 3, 100
"""Rounds through all kernels, so that no size has all the bad moments; runs in each; single calls in a run."""

COMPARED = 200
"""States that are compared with the readable recursion."""


def seconds(run: Callable[[], object], runs: int) -> float:
    """The least of several runs, in processor time: with one thread that is the time on a machine that does no more."""
    least = float("inf")
    for _ in range(runs):
        start = time.thread_time()
        run()
        least = min(least, time.thread_time() - start)
    return least


@dataclass
class Timed:
    """One robot compiled in one way.

    Attributes:
        robot: the robot.
        straight_line: operations beyond which it is compiled as calls.
        states: how many states a batch has.
        figures: what was found so far.
        batch: seconds for the batch.
        alone: seconds for a state that comes alone.
    """

    robot: Robot
    straight_line: int
    states: int
    figures: dict[str, Any] = field(default_factory=dict)
    batch: float = float("inf")
    alone: float = float("inf")

    def __post_init__(self) -> None:
        """Compile, and compare with the readable recursion."""
        s = Sampler(self.robot.model, "uniform", 0).draw(0, self.states)
        self.given = (s.q, s.v, s.a)
        self.first = [np.ascontiguousarray(x[0]) for x in self.given]
        self.out, self.one = np.empty((self.states, self.robot.model.nv)), np.empty(self.robot.model.nv)
        self.kernel = Kernel(self.robot.model, "tau", straight_line=self.straight_line)
        self.figures["compile_s"] = round(seconds(lambda: self.kernel(*self.first), 1), 2)
        ours = self.kernel(*self.given, out=self.out, threads=1)[:COMPARED]
        reference = self.robot.inverse_dynamics(*(x[:COMPARED] for x in self.given)).tau
        error = np.linalg.norm(ours - reference, axis=1) / np.linalg.norm(reference, axis=1)
        self.figures["worst_eps"] = round(float(error.max()) / sys.float_info.epsilon, 1)
        program = build(self.robot.model, ["tau"], straight_line=self.straight_line)
        by_calls = isinstance(program, CallProgram)
        self.figures["kind"] = "calls" if by_calls else "lines"
        self.figures["operations"] = program.operations if by_calls else program.operations.total

    def measure(self) -> None:
        """Another few runs."""
        whole = seconds(lambda: self.kernel(*self.given, out=self.out, threads=1), RUNS) / self.states
        alone = seconds(lambda: [self.kernel(*self.first, out=self.one) for _ in range(SINGLE)], RUNS) / SINGLE
        self.batch, self.alone = min(self.batch, whole), min(self.alone, alone)
        self.figures["ns_per_state"] = round(self.batch * 1e9, 1)
        self.figures["ns_per_state_and_joint"] = round(self.batch * 1e9 / self.robot.model.nv, 1)
        self.figures["us_single_state"] = round(self.alone * 1e6, 2)


def shown(rows: dict[int, dict[str, Timed]]) -> Table:
    """One row for each size: as chosen, then as calls."""
    keys = ("kind", "compile_s", "ns_per_state", "ns_per_state_and_joint", "us_single_state")
    heads = ("", "compile s", "ns/state", "ns/joint", "us alone")
    table = Table("joints", *heads, *heads)
    for joints, row in rows.items():
        table.add_row(str(joints), *(str(timed.figures[key]) for timed in row.values() for key in keys))
    return table


def main() -> int:
    from support.serial_chains import random_chain
    from support.tolerances import EPS, ROUNDING

    parser = arguments(__doc__ or "")
    parser.add_argument("--joints", type=int, nargs="+", default=JOINTS)
    parser.add_argument("--states", type=int, default=4000)
    options = parser.parse_args()
    cache.folder = lambda: None  # compile times are those of compiling
    rows: dict[int, dict[str, Timed]] = {}
    for joints in options.joints:
        robot = rttrr_pin.load(random_chain(joints, ("revolute",) * joints))
        rows[joints] = {
            way: Timed(robot, limit, options.states) for way, limit in (("chosen", STRAIGHT_LINE), ("calls", 0))
        }
    every = [timed for row in rows.values() for timed in row.values()]
    for timed in every * ROUNDS:
        timed.measure()
    Console(stderr=True, width=120).print(shown(rows))
    figures = {joints: {way: timed.figures for way, timed in row.items()} for joints, row in rows.items()}
    finish("kernel_joints", {"states": options.states, "threads": 1, "joints": figures}, options.save)
    return int(any(timed.figures["worst_eps"] * EPS > ROUNDING for timed in every))


if __name__ == "__main__":
    sys.exit(main())
