"""Claim: on a million random states of RTTRR with payload, kernel and Pinocchio agree to 500 eps, normwise, per link.

Run: python benchmarks/agreement.py [--states N] [--save]. Exit 1 if the claim does not hold.
"""

from __future__ import annotations

import sys

import rttrr_pin
from common import arguments, finish
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.validation import validate

CLAIM = 500.0


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, default=1_000_000)
    chosen = parser.parse_args()
    show = sys.stderr.isatty()
    result = validate(
        rttrr_pin.load("rttrr"),
        n_states=chosen.states,
        seed=0,
        payload=rttrr_pin.RandomPayload(),
        progress=lambda done: print(f"\r{done:,} states", end="", file=sys.stderr) if show else None,
    )
    worst = {}
    for quantity in QUANTITIES:
        row = max((row for row in result.rows if row.quantity == quantity), key=lambda row: row.relative.value)
        closest = max((row for row in result.rows if row.quantity == quantity), key=lambda row: row.of_tolerance.value)
        worst[quantity] = {
            "worst_eps": round(row.relative.value, 2),
            "at": row.at,
            "state": row.relative.state,
            "worst_of_tolerance": round(closest.of_tolerance.value, 4),
        }
    holds = result.passed and all(figure["worst_eps"] <= CLAIM for figure in worst.values())
    figures = {
        "states": chosen.states,
        "seed": 0,
        "payload": "random",
        "worst": worst,
        "claim_eps": CLAIM,
        "holds": holds,
        "verdict": "agree" if result.passed else "disagree",
        "seconds": round(result.seconds, 1),
    }
    finish("agreement", figures, chosen.save)
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())
