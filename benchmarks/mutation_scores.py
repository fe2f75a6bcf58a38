"""Claim: suites with the tolerances and states of public ones let wrong dynamics pass; rounding bounds let none pass.

Each suite is told as data (`rttrr_pin.conformance.Tolerances`) and asked on robots of the levels. What is public:

- adam, tests/conftest.py and test_jax.py: one random state, |q| and |v| up to 2.5; bias force and gravity term within
  1e-4 absolute, and the mass matrix, here unit accelerations to the same tolerance (it has 1e-5).
- MuJoCo Warp, inverse_test.py: one state, rates of 0.01, qfrc_inverse within 5e-3 + 5e-3 of it.
- Gravity alone: ten poses within 1e-6, as examples in readme files do.

Run: python benchmarks/mutation_scores.py [--save]. Exit 1 if the suite at rounding bounds lets one pass.
"""

from __future__ import annotations

import sys
from typing import Any

from common import arguments, finish
from rttrr_pin.conformance import MutationScore, Tolerances, level_robot, mutate
from rttrr_pin.conformance.mutation.mutation import grouped

ROBOTS = ("rttrr", "arm6", "floating")

SUITES = {
    "adam": Tolerances(("rates", "gravity", "units"), 1, 1e-4, rates=2.5),
    "mujoco_warp": Tolerances(("random",), 1, 5e-3, 5e-3, rates=0.01),
    "gravity": Tolerances(("gravity",), 10, 1e-6),
    "loose": Tolerances(("random",), 10, 1e-2),
    "usual": Tolerances(("random",), 10, 1e-6),
    "rounding": Tolerances(("random",), 100, None),
}

SIZES = {"10 %": 0.1, "1 %": 0.01}
"""How wrong numbers are that may be any, such as a mass."""


def figures_of(score: MutationScore) -> dict[str, Any]:
    """The score by kind, and the largest of what passes."""
    largest = [group[0] for group in grouped(score.passing)[:3]]
    return {
        "mutants": len(score.mutants),
        "passing": len(score.passing),
        "kinds": {name: [total - seen, total] for name, (seen, total) in score.kinds.items()},
        "largest": [{"sentence": own.sentence, "relative": own.relative} for own in largest],
        "seconds": score.seconds,
    }


def main() -> int:
    chosen = arguments(__doc__ or "").parse_args()
    found: dict[str, Any] = {}
    for name, suite in SUITES.items():
        found[name] = {"suite": suite.sentence, "robots": {}}
        for robot in ROBOTS:
            scores = {label: mutate(level_robot(robot), suite, size=size) for label, size in SIZES.items()}
            found[name]["robots"][robot] = {label: figures_of(score) for label, score in scores.items()}
            print(*(score.summary() for score in scores.values()), sep="\n", file=sys.stderr, flush=True)
    finish("mutation_scores", {"suites": found}, chosen.save)
    return int(any(x["passing"] for own in found["rounding"]["robots"].values() for x in own.values()))


if __name__ == "__main__":
    sys.exit(main())
