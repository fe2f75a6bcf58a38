"""Claim: all URDFs of example-robot-data are accounted for: compared on both bases, or stopped by a named defect.

Run: pip install 'rttrr-pin[robots]', then python benchmarks/example_robots.py [--states N] [--save].
Exit 1 if one disagrees.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import asdict
from importlib import metadata

from common import arguments, finish
from rttrr_pin.urdf.catalogue import examples
from rttrr_pin.validation import Task, validate_many


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, default=10_000)
    chosen = parser.parse_args()
    start = time.perf_counter()
    entries = validate_many(examples(), Task(chosen.states))
    verdicts = Counter(entry.verdict for entry in entries)
    figures = {
        "states": chosen.states,
        "example-robot-data": metadata.version("example-robot-data"),
        "files": len({entry.name for entry in entries}),
        "verdicts": dict(verdicts),
        "worst_eps": max(entry.eps for entry in entries),
        "worst_of_tolerance": max(entry.of_tolerance for entry in entries),
        "seconds": round(time.perf_counter() - start, 1),
        "entries": [{key: value for key, value in asdict(entry).items() if value != ""} for entry in entries],
    }
    finish("example_robots", figures, chosen.save)
    return int(verdicts["disagree"] > 0)


if __name__ == "__main__":
    sys.exit(main())
