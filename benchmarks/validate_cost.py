"""Claim: the memory of `rttrr-pin validate` does not grow with the number of states; and what 100,000 states cost.

Each run is a process of its own, timed from outside, its peak memory as the system accounts for it.
Run: python benchmarks/validate_cost.py [--repeats N] [--save]. Exit 1 if memory grows by more than 2 percent.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time

from common import arguments, finish

STATES = (1_000, 10_000, 100_000, 300_000)
GROWTH = 1.02


def run(states: int) -> tuple[float, float]:
    """Wall time [s] and peak memory [MiB] of one run."""
    words = [sys.executable, "-m", "rttrr_pin", "validate", "--states", str(states), "--quiet"]
    start = time.perf_counter()
    process = subprocess.Popen(words)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    if os.waitstatus_to_exitcode(status) != 0:
        raise SystemExit(f"validate --states {states} did not agree")
    return wall, usage.ru_maxrss / 1024


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=5)
    chosen = parser.parse_args()
    run(STATES[0])  # fills the disk cache
    seen: dict[int, list[tuple[float, float]]] = {states: [] for states in STATES}
    for _ in range(chosen.repeats):
        for states in STATES:
            seen[states].append(run(states))
    rows = [
        {
            "states": states,
            "wall_s": [round(f(wall for wall, _ in runs), 2) for f in (min, statistics.median, max)],
            "peak_mib": [round(f(peak for _, peak in runs), 1) for f in (min, statistics.median, max)],
        }
        for states, runs in seen.items()
    ]
    medians = [statistics.median(peak for _, peak in seen[states]) for states in STATES]
    growth = medians[-1] / medians[1]  # from the first run that fills whole blocks
    finish("cost", {"columns": "min, median, max", "rows": rows, "growth": round(growth, 4)}, chosen.save)
    return 0 if growth <= GROWTH else 1


if __name__ == "__main__":
    sys.exit(main())
