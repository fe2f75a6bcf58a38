"""Claim: on random trees over 60 orders of magnitude no verdict is false, and no planted error of 1e-6 is overlooked.

Masses, centres of mass, tensors, places, coordinates, rates, accelerations and payloads have sizes from 1e-30 to 1e30,
either sign, and zeros among them; every other tree floats, every third has masses such as Pinocchio can add up. The
recursion is compared with the kernel (all quantities; tau alone, whose inertia is regrouped), with Pinocchio and MuJoCo
where they build the robot, and with Lagrange's equations. What is false is said in `tests/support/extremes.py`.

Run: nice python benchmarks/extreme_trees.py [--trees N] [--first SEED] [--workers N] [--save]. Exit 1 if one is false.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from common import arguments, finish

sys.path.append(str(Path(__file__).parents[1] / "tests"))


def main() -> int:
    from support.extremes import LARGEST, ORDERS, PLANTED, false_verdicts

    parser = arguments(__doc__ or "")
    parser.add_argument("--trees", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    chosen = parser.parse_args()
    start = time.perf_counter()
    seeds = range(chosen.first, chosen.first + chosen.trees)
    total, false = Counter[str](), list[str]()
    with ProcessPoolExecutor(chosen.workers, mp_context=get_context("spawn")) as pool:
        for count, found in pool.map(false_verdicts, seeds, chunksize=50):
            total += count
            false += found
    figures = {
        "trees": total.pop("trees"),
        "joints": f"1 to {LARGEST}",
        "orders_of_magnitude": 2 * ORDERS,
        "planted": PLANTED,
        "false_alarms": sum(line.startswith("false") for line in false),
        "blind_spots": sum(line.startswith("blind") for line in false),
        "counts": dict(sorted(total.items())),
        "found": false[:20],
        "seconds": round(time.perf_counter() - start, 1),
    }
    finish("extreme_trees", figures, chosen.save)
    return int(bool(false))


if __name__ == "__main__":
    sys.exit(main())
