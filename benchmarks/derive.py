"""Claim: all joint moments n_i of RTTRR are derived in symbols, and written as LaTeX, in less than 10 seconds.

First the derived forms are held against the numeric recursion, as Python; then each robot is derived in a process of
its own, timed from outside. Run: python benchmarks/derive.py [--repeats N] [--save]. Exit 1 if it takes longer.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from rttrr_pin.derivation import derive
from rttrr_pin.derivation.writers import WRITERS

MOST_SECONDS = 10.0

WORDS = {"n": ["--quantity", "n"], "n, tau, M, C, g": []}

ROBOTS = ("rttrr", "trr", "trtr", "trtrr", "trttr")

SAME = 1e-12
"""Normwise, of two ways to round the same polynomial."""


def check(name: str) -> int:
    """The number of terms; leaves where the forms do not give what the recursion gives."""
    robot = rttrr_pin.load(name)
    derivation = derive(robot)
    module: dict[str, Any] = {}
    exec(WRITERS["python"](derivation), module)
    q, v, a = np.random.default_rng(0).normal(size=(3, 100, robot.model.nv))
    result = robot.inverse_dynamics(q, v, a)
    for ours, theirs in ((module["n"](q, v, a), result.n), (module["M"](q), robot.mass_matrix(q))):
        if np.linalg.norm(ours - theirs) > SAME * np.linalg.norm(theirs):
            raise SystemExit(f"{name}: the derived forms are wrong")
    return derivation.count()


def seconds(words: list[str]) -> float:
    """Wall time of one command."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-m", "rttrr_pin", "derive", *words, "--quiet"], check=True)
    return time.perf_counter() - start


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=3)
    chosen = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        target = str(Path(folder, "model.tex"))
        for name in ROBOTS:
            row: dict[str, Any] = {"robot": name, "terms": check(name)}
            for label, words in WORDS.items():
                runs = [seconds([name, *words, "--latex", target]) for _ in range(chosen.repeats)]
                row[label] = [round(f(runs), 2) for f in (min, statistics.median, max)]
            rows.append(row)
    finish("derive", {"columns": "wall_s: min, median, max, process start included", "rows": rows}, chosen.save)
    return 0 if max(row["n"][1] for row in rows) <= MOST_SECONDS else 1


if __name__ == "__main__":
    sys.exit(main())
