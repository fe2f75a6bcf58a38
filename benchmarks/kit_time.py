"""Claim: all checks of the kit on a plain NumPy function and RTTRR take less than 20 s, the start of pytest included.

Runs `python -m pytest examples/pytest -k test_inverse_dynamics` some times, in a process of its own each, and the whole
example, which also draws robots.

Run: python benchmarks/kit_time.py [--times N] [--save]. Exit 1 if it takes longer, or a check fails.
"""

from __future__ import annotations

import os
import re
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from common import arguments, finish

TOP = Path(__file__).parents[1]

LIMIT = 20.0
"""Seconds."""

PLUGIN = ("-p", "rttrr_pin.conformance.kit.pytest_plugin")


def run(*words: str) -> dict[str, Any]:
    """Seconds, wall and of the processor, and how many tests had which outcome."""
    folder = TOP / "examples/pytest"
    command = [sys.executable, "-m", "pytest", "-q", "-c", os.devnull, "--rootdir", str(folder), *PLUGIN]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(TOP / "src"), str(folder)])}
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [*command, "-p", "no:cacheprovider", str(folder), *words], capture_output=True, text=True, env=environment
    )
    seconds, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    outcomes = {kind: int(count) for count, kind in re.findall(r"(\d+) (passed|failed|skipped|error)", done.stdout)}
    if done.returncode:
        print(done.stdout, file=sys.stderr)
    return {"seconds": seconds, "processor_seconds": processor, **outcomes}


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--times", type=int, default=5)
    chosen = parser.parse_args()
    checks = [run("-k", "test_inverse_dynamics") for _ in range(chosen.times)]
    whole = run()
    seconds, processor = ([own.pop(key) for own in checks] for key in ("seconds", "processor_seconds"))
    figures = {
        "robot": "rttrr",
        "states": 32,
        "checks": checks[0],
        "seconds": [min(seconds), statistics.median(seconds), max(seconds)],
        "processor_seconds": [min(processor), statistics.median(processor), max(processor)],
        "whole_example": whole,
        "limit_seconds": LIMIT,
    }
    finish("kit_time", figures, chosen.save)
    failed = any("failed" in own or "error" in own for own in (*checks, whole))
    return int(failed or max(seconds) > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
