"""Claim: ten million rows of the RTTRR arm go from Parquet to Parquet in constant memory, most of the time in files.

Run: python benchmarks/loads_speed.py [--rows N] [--repeats R] [--save]. The input, with time, q, v and a, is made in a
temporary folder and read once before. Each run is a process of its own, whose largest memory is that of all it did,
Python and libraries included; of several the fastest is taken. "files" is what reading and writing take, decoding and
the checks of the rows included; "kernel" the arithmetic alone. Exit 1 if memory or arithmetic is beyond the claim.
"""

from __future__ import annotations

import os
import tempfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
from pyarrow import parquet

import rttrr_pin
from common import arguments, finish

ROWS, RATE = 10_000_000, 1000.0

PART = 100_000
"""Rows that are made at a time."""

MOST_MEMORY, MOST_ARITHMETIC = 500e6, 1.0
"""Bytes, and seconds for each ten million rows."""

VARIANTS: dict[str, dict[str, Any]] = {
    "tau": {"bearings": False},
    "tau, and what bearings carry": {},
    "tau, F, N, f, n, power, energy, and what bearings carry": {
        "quantities": ("tau", "F", "N", "f", "n", "power", "energy")
    },
}


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--repeats", type=int, default=3)
    chosen = parser.parse_args()
    busy = [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "motion.parquet"), Path(folder, "loads.parquet")
        write(source, chosen.rows)
        source.read_bytes()
        runs = [
            min((measured(source, target, name) for _ in range(chosen.repeats)), key=lambda run: run["seconds"])
            for name in VARIANTS
        ]
        sizes = {"input_bytes": source.stat().st_size}
    busy.append(os.getloadavg()[0])
    first = runs[0]
    figures = {"rows": chosen.rows, **sizes, "repeats": chosen.repeats, "load": busy, "runs": runs}
    finish("loads_speed", figures, chosen.save)
    within = first["peak_bytes"] < MOST_MEMORY and first["kernel"] <= MOST_ARITHMETIC * max(1.0, chosen.rows / ROWS)
    return int(not within)


def write(path: Path, rows: int) -> None:
    """Every joint in sines of its own, within its limits."""
    model = rttrr_pin.load("rttrr").model
    joints = [joint.limits for joint in model.moving]
    middle, half = (np.array([(own.upper + sign * own.lower) / 2 for own in joints])[:, None] for sign in (1.0, -1.0))
    w = 0.5 + 0.3 * np.arange(model.nv)[:, None]
    names = ["time", *(f"{key}_{name}" for key in "qva" for name in model.v_names)]
    schema = pyarrow.schema([pyarrow.field(name, pyarrow.float64()) for name in names])
    with parquet.ParquetWriter(path, schema) as file:
        for start in range(0, rows, PART):
            t = np.arange(start, min(start + PART, rows)) / RATE
            s, c = 0.9 * half * np.sin(w * t), 0.9 * half * np.cos(w * t)
            columns = [t, *(middle + s), *(w * c), *(-w * w * s)]
            file.write_table(pyarrow.table(columns, schema=schema))


def measured(source: Path, target: Path, name: str) -> dict[str, Any]:
    """One run in a process of its own."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return {"name": name, **pool.submit(run, source, target, name).result()}


def run(source: Path, target: Path, name: str) -> dict[str, Any]:
    """Its times, its memory, and the size of what it wrote."""
    report = rttrr_pin.compute_loads(rttrr_pin.load("rttrr"), source, output=target, **VARIANTS[name])
    times = dict(report.wall_time)
    seconds, files = times.pop("all"), times["read"] + times["write"]
    return {
        "seconds": seconds,
        "rows_a_second": report.rows / seconds,
        "files_share": files / seconds,
        **times,
        "peak_bytes": peak(),
        "output_bytes": target.stat().st_size,
        "passed": report.passed,
    }


def peak() -> int:
    """The most memory that this process had at a time; what getrusage says begins with that of the one that made it."""
    lines = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return int(lines["VmHWM"].split()[0]) * 1024


if __name__ == "__main__":
    raise SystemExit(main())
