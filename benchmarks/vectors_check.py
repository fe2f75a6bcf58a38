"""Claim: every enclosure of the bundled vectors holds, and is two neighbouring doubles wide at most but near zero.

1,000 states of each level and robot are written by `rttrr_pin.conformance.write_vectors`, and read from the files by
`vectors_mpmath.py`, which imports nothing of rttrr_pin and computes tau, F, N, f, n in mpmath with 60 digits by another
way. Counted are the true values outside their two doubles. A true value that is itself a double, and so an end of its
enclosure, may be off it by what 60 digits leave: `SLACK` of the largest number of its quantity.

Run: python benchmarks/vectors_check.py [--states N] [--levels ID ...] [--folder FOLDER] [--save]. Exit 1 on a miss.
"""

from __future__ import annotations

import csv
import json
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from mpmath import mpf

import vectors_mpmath
from common import arguments, finish

QUANTITIES = ("tau", "F", "N", "f", "n")
SLACK = mpf(10) ** -45
BLOCK = 10
EPS = 2.0**-52


@cache
def robot(folder: str) -> vectors_mpmath.Robot:
    return vectors_mpmath.Robot(Path(folder))


def block(job: tuple[str, list[list[float]], list[list[float]]]) -> dict[str, dict[str, float]]:
    """Counts and the worst of some states, by quantity; states and true values as rows of the tables have them."""
    folder, states, truths = job
    model = robot(folder)
    links = [own["link"] for own in model.meta["payload"]]
    out = {key: {"numbers": 0, "outside": 0, "inside": 0, "at_an_end": 0, "worst": 0.0} for key in QUANTITIES}
    for row, truth in zip(states, truths, strict=True):
        numbers = iter(row)
        q, v, a = ([next(numbers) for _ in model.meta["order"][key]] for key in "qva")
        payload = {link: ([next(numbers) for _ in range(3)], [next(numbers) for _ in range(3)]) for link in links}
        values = model(q, v, a, payload)
        count = sum(map(len, values.values()))
        assert len(truth) == 2 * count
        lowers, uppers = iter(truth[:count]), iter(truth[count:])
        for key in QUANTITIES:
            largest = max(map(abs, values[key]), default=mpf(0))
            for x in values[key]:
                lower, upper = mpf(next(lowers)), mpf(next(uppers))
                own = out[key]
                own["numbers"] += 1
                miss = max(lower - x, x - upper)
                if miss < -SLACK * largest:
                    own["inside"] += 1
                elif miss <= SLACK * largest:
                    own["at_an_end"] += 1
                else:
                    own["outside"] += 1
                    own["worst"] = max(own["worst"], float(miss / abs(x) / EPS))
    return out


def rows_of(path: Path) -> tuple[list[str], list[list[str]]]:
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    return header, rows


def check(folder: Path, pool: ProcessPoolExecutor) -> dict[str, Any]:
    """One robot: each enclosure against mpmath, and how wide it is."""
    start = time.perf_counter()
    meta = json.loads((folder / "meta.json").read_text())
    of_states, state_rows = rows_of(folder / "states.csv")
    of_truth, truth_rows = rows_of(folder / "truth.csv")
    assert [row[:2] for row in state_rows] == [row[:2] for row in truth_rows]
    hexadecimal = [k for k, name in enumerate(of_states) if name.startswith("hex_")]
    ends = [k for k, name in enumerate(of_truth) if name.startswith("hex_")]
    numbers = [[float.fromhex(row[k]) for k in hexadecimal] for row in state_rows]
    truths = [[float.fromhex(row[k]) for k in ends] for row in truth_rows]
    jobs = [(str(folder), numbers[k : k + BLOCK], truths[k : k + BLOCK]) for k in range(0, len(numbers), BLOCK)]
    parts = list(pool.map(block, jobs))
    quantities = {
        key: {name: (max if name == "worst" else sum)(part[key][name] for part in parts) for name in parts[0][key]}
        for key in QUANTITIES
    }
    widths: dict[str, int] = {}
    for level in meta["levels"]:
        for name, count in level["widths"].items():
            widths[name] = widths.get(name, 0) + count
    return {
        "levels": [level["id"] for level in meta["levels"]],
        "states": len(numbers),
        "links": len(meta["links"]),
        "numbers": sum(own["numbers"] for own in quantities.values()),
        "outside": sum(own["outside"] for own in quantities.values()),
        "widths": widths,
        "quantities": quantities,
        "seconds": round(time.perf_counter() - start, 1),
    }


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, default=1000, help="of each level and robot")
    parser.add_argument("--levels", nargs="*", help="all unless some are named")
    parser.add_argument("--folder", type=Path, help="vectors that are there, instead of new ones")
    chosen = parser.parse_args()
    figures: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = chosen.folder
        if folder is None:
            from rttrr_pin.conformance import write_vectors

            folder = Path(temporary)
            write_vectors(folder, levels=chosen.levels, n_states=chosen.states)
        with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
            for own in sorted(path.parent for path in folder.glob("*/meta.json")):
                figures[own.name] = check(own, pool)
                print(f"{own.name}: {figures[own.name]}", file=sys.stderr, flush=True)
    states, numbers, outside = (sum(own[key] for own in figures.values()) for key in ("states", "numbers", "outside"))
    totals = {"digits": vectors_mpmath.DIGITS, "states": states, "numbers": numbers, "outside": outside}
    finish("vectors_check", totals | {"robots": figures}, chosen.save)
    return 1 if outside else 0


if __name__ == "__main__":
    sys.exit(main())
