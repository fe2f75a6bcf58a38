"""Claim: on random trees over 60 orders of magnitude no verdict is false, and no planted error of 1e-6 is overlooked.

Masses, centres of mass, tensors, places, coordinates, rates, accelerations and payloads have sizes from 1e-30 to 1e30,
either sign, and zeros among them; every other tree floats, every third has masses such as Pinocchio can add up. The
recursion is compared with the kernel (all quantities; tau alone, whose inertia is regrouped), with Pinocchio and MuJoCo
where they build the robot, and with Lagrange's equations. What is false, and of which share of the trees the kernels
are traced, is said in `tests/support/extremes.py`.

A false verdict is printed at once. With --save the result is written every minute, and where Ctrl-C or SIGTERM ends the
run: always whole, of so many trees as are done; --resume goes on from there.

Run: nice python benchmarks/extreme_trees.py [--trees N] [--first SEED] [--workers N] [--save] [--resume]. Exit 1 if one
is false.
"""

from __future__ import annotations

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from common import arguments, finish, result

sys.path.append(str(Path(__file__).parents[1] / "tests"))

NAME = "extreme_trees"

EVERY = 60.0
"""Seconds from one saved result to the next."""

CHUNK = 20
"""Trees that a worker is given at once."""

SHOWN = 20
"""False verdicts that are kept."""


class Tally:
    """What was found on consecutive trees."""

    def __init__(self, first: int) -> None:
        self.first, self.seconds = first, 0.0
        self.total, self.false = Counter[str](), list[str]()

    @classmethod
    def of(cls, saved: dict[str, Any]) -> Tally:
        """What a run has saved."""
        tally = cls(saved["first"])
        tally.total = Counter(saved["counts"]) + Counter({"trees": saved["trees"]})
        tally.false, tally.seconds = list(saved["found"]), saved["seconds"]
        return tally

    @property
    def next(self) -> int:
        """The seed of the tree that comes next."""
        return self.first + self.total["trees"]

    def add(self, count: Counter[str], false: list[str]) -> None:
        """Take in the next tree."""
        self.total += count
        self.false += false
        for line in false:
            print(line, file=sys.stderr, flush=True)

    def figures(self) -> dict[str, Any]:
        """As they are saved."""
        from support.extremes import KERNELS, LARGEST, ORDERS, PLANTED

        counts = dict(sorted(self.total.items()))
        return {
            "trees": counts.pop("trees", 0),
            "first": self.first,
            "joints": f"1 to {LARGEST}",
            "orders_of_magnitude": 2 * ORDERS,
            "planted": PLANTED,
            "kernels_of_one_tree_in": KERNELS,
            "false_alarms": sum(line.startswith("false") for line in self.false),
            "blind_spots": sum(line.startswith("blind") for line in self.false),
            "counts": counts,
            "found": self.false[:SHOWN],
            "seconds": round(self.seconds, 1),
        }


def found(seeds: range, workers: int) -> Iterator[tuple[Counter[str], list[str]]]:
    """What there is on each tree, in the order of the seeds; signals are the business of this process alone."""
    from support.extremes import false_verdicts

    with ProcessPoolExecutor(workers, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        try:
            yield from pool.map(false_verdicts, seeds, chunksize=CHUNK)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--trees", type=int, default=100_000, help="all together, those of a resumed run as well")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--resume", action="store_true", help="go on where the saved run ended")
    chosen = parser.parse_args()
    tally = Tally.of(result(NAME)) if chosen.resume else Tally(chosen.first)
    before, started, saved = tally.seconds, time.perf_counter(), 0.0
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        for count, false in found(range(tally.next, tally.first + chosen.trees), chosen.workers):
            tally.add(count, false)
            now = time.perf_counter() - started
            tally.seconds = before + now
            if now - saved > EVERY:
                saved = now
                print(f"{tally.total['trees']:,} trees, {len(tally.false)} false, {now:.0f} s", file=sys.stderr)
                finish(NAME, tally.figures(), chosen.save, show=False)
    except KeyboardInterrupt:
        print(f"interrupted after {tally.total['trees']:,} trees", file=sys.stderr)
    finish(NAME, tally.figures(), chosen.save)
    return int(bool(tally.false))


if __name__ == "__main__":
    sys.exit(main())
