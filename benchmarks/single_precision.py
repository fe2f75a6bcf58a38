"""Claim: programs in float32 use a small part of the float32 bound, and a mass off by 0.1 % is far beyond it.

Two programs in NumPy's float32, our recursion and Featherstone's in spatial vectors, at states of every level: their
largest error beside the bound. Then one link's mass is 0.1 % too large, each in turn: how far F of that link is beyond
the bound, the least over the links of each robot.

Run: python benchmarks/single_precision.py [--states N] [--save]. Exit 1 if a right program is beyond a fifth of it.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from common import arguments, finish
from rttrr_pin.conformance import Case, cases
from rttrr_pin.core.arrays import norm
from rttrr_pin.implementations import default_allowance
from rttrr_pin.implementations.allowance import SINGLE

sys.path.append(str(Path(__file__).parents[1] / "tests"))
from support.single import SingleRecursion, SingleSpatial, single_ratios, with_mass

FACTOR, FAULTED = 1.001, 300


def seen(case: Case) -> list[float]:
    """For each massive link, F of that link with a mass off by `FACTOR`: the largest error / bound."""
    model, batch = case.robot.model, case.batch
    bound, right = default_allowance(batch, SINGLE)["F"], batch.recursion[0].F
    found = []
    for link, own in enumerate(model.links):
        if own.mass:
            wrong = SingleRecursion(with_mass(model, link, FACTOR)).evaluate(batch).values["F"]
            found.append(float((norm(wrong - right)[:, link] / bound[:, link]).max()))
    return found


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, default=10_000)
    chosen = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for case in cases(n_states=chosen.states):
        programs = (SingleRecursion, SingleSpatial) if not case.batch.loads else (SingleRecursion,)
        rows.append({"case": case.id, "of_bound": {own.name: max(single_ratios(case, own)) for own in programs}})
    for row, case in zip(rows, cases(n_states=FAULTED), strict=True):
        row["mass_off"] = {"least": min(found := seen(case)), "most": max(found)}
    worst = max(x for row in rows for x in row["of_bound"].values())
    finish("single_precision", {"states": chosen.states, "worst": worst, "rows": rows}, chosen.save)
    return int(not 0.0 < worst < 0.2 or not np.isfinite(worst))


if __name__ == "__main__":
    sys.exit(main())
