"""Claim: the laws of mechanics hold on 1,000 random trees of 1 to 6 joints of all types, 1,000 states each.

Half of them float. Each carries random payloads in both kinds of axes; joints have armature, damping, friction.

Run: python benchmarks/laws.py [--trees N] [--states N] [--save]. Exit 1 if a law is violated.
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
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.laws import check_laws

sys.path.append(str(Path(__file__).parents[1] / "tests"))

LARGEST = 6
BASES = ("fixed", "floating")


def one(job: tuple[int, int]) -> tuple[int, str, dict[str, tuple[float, int, int]], Counter[str]]:
    """Seed, base, by law its largest error / bound, violations and numbers, and the joint types of one tree."""
    from support.trees import random_tree

    seed, states = job
    base = BASES[seed // LARGEST % 2]
    robot = rttrr_pin.load(random_tree(seed, 1 + seed % LARGEST), base=base)  # type: ignore[arg-type]
    moving = [joint for joint in robot.model.joints if joint.nv]
    robot = robot.with_joint_effects(
        {joint.name: JointEffects(0.25, joint.dynamics.damping, joint.dynamics.friction) for joint in moving}
    )
    report = check_laws(robot, n_states=states, seed=seed, sampling="mixed")
    seen = {row.law.id: (row.error_over_bound.value, row.violations, row.numbers * states) for row in report.rows}
    kinds = Counter(joint.type.name + (" following" if joint.mimic else "") for joint in robot.model.joints)
    return seed, base, seen, kinds


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--trees", type=int, default=1000)
    parser.add_argument("--states", type=int, default=1000)
    chosen = parser.parse_args()
    start = time.perf_counter()
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        results = list(pool.map(one, [(seed, chosen.states) for seed in range(chosen.trees)], chunksize=4))
    laws = results[0][2]
    kinds: Counter[str] = sum((result[3] for result in results), Counter())
    violations = [
        {"seed": seed, "base": base, "law": law, "states": seen[law][1]}
        for seed, base, seen, _ in results
        for law in laws
        if seen[law][1]
    ]
    figures = {
        "trees": chosen.trees,
        "joints": f"1 to {LARGEST}",
        "states_per_tree": chosen.states,
        "joint_types": dict(sorted(kinds.items())),
        "laws": {
            law: {
                "numbers": sum(result[2][law][2] for result in results),
                "violations": sum(result[2][law][1] for result in results),
                "worst_error_over_bound": round(max(result[2][law][0] for result in results), 4),
            }
            for law in laws
        },
        "violations": violations,
        "seconds": round(time.perf_counter() - start, 1),
    }
    finish("laws", figures, chosen.save)
    return int(bool(violations))


if __name__ == "__main__":
    sys.exit(main())
