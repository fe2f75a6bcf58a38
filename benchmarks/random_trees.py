"""Claim: 1,000 random trees of 1 to 60 joints of all types agree with Pinocchio, fixed and floating.

Run: python benchmarks/random_trees.py [--trees N] [--states N] [--save]. Exit 1 if one disagrees.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import rttrr_pin
from common import arguments, finish
from rttrr_pin.validation import validate

sys.path.append(str(Path(__file__).parents[1] / "tests"))

LARGEST = 60


def one(job: tuple[int, int]) -> tuple[int, list[str], bool, float, float, Counter[str]]:
    """Seed, bases that disagree, worst normwise error in eps and error / tolerance, and the joint types of one tree."""
    from support.trees import random_tree

    seed, states = job
    text = random_tree(seed, 1 + seed % LARGEST)
    bad, eps, share, kinds = [], 0.0, 0.0, Counter[str]()
    for base in ("fixed", "floating"):
        robot = rttrr_pin.load(text, base=base, friction=True)  # type: ignore[arg-type]
        result = validate(robot, n_states=states, seed=seed, sampling="mixed")
        if not result.passed:
            bad.append(base)
        eps = max(eps, *(seen.value for seen in result.whole.values()))
        share = max(share, *(row.of_tolerance.value for row in result.rows))
        kinds.update(joint.type.name + (" following" if joint.mimic else "") for joint in robot.model.joints)
    return seed, bad, bool(bad), eps, share, kinds


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--trees", type=int, default=1000)
    parser.add_argument("--states", type=int, default=20)
    chosen = parser.parse_args()
    start = time.perf_counter()
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        results = list(pool.map(one, [(seed, chosen.states) for seed in range(chosen.trees)], chunksize=4))
    kinds: Counter[str] = sum((result[5] for result in results), Counter())
    figures = {
        "trees": chosen.trees,
        "joints": f"1 to {LARGEST}",
        "states_per_tree_and_base": chosen.states,
        "joint_types": dict(sorted(kinds.items())),
        "disagree": [{"seed": seed, "bases": bad} for seed, bad, *_ in results if bad],
        "worst_eps": round(max(result[3] for result in results), 1),
        "worst_of_tolerance": round(max(result[4] for result in results), 4),
        "seconds": round(time.perf_counter() - start, 1),
    }
    finish("random_trees", figures, chosen.save)
    return int(bool(figures["disagree"]))


if __name__ == "__main__":
    sys.exit(main())
