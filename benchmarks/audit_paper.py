"""Claim: the paper's 60 components are audited in under 15 s.

Each run is a process of its own, timed from outside; the totals are those of the audit's JSON.
Run: python benchmarks/audit_paper.py [--repeats N] [--save]. Exit 1 if something is unparsed, or it takes longer.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from common import arguments, finish

MOST_SECONDS = 15.0


def run(report: Path) -> float:
    """Wall time of one audit [s]; findings make it exit with 1."""
    start = time.perf_counter()
    words = [sys.executable, "-m", "rttrr_pin", "audit", "--quiet", "--json", str(report)]
    done = subprocess.run(words, check=False)
    assert done.returncode in (0, 1), words
    return time.perf_counter() - start


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=5)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "audit.json"
        times = sorted(run(report) for _ in range(chosen.repeats))
        audit = json.loads(report.read_text())
    median = round(statistics.median(times), 2)
    figures = audit["totals"] | {
        "printed_terms": sum(component["printed_terms"] for component in audit["components"]),
        "seconds_median": median,
        "seconds": [round(x, 2) for x in times],
    }
    finish("audit_paper", figures, chosen.save)
    return 1 if figures["unparsed"] or median > MOST_SECONDS else 0


if __name__ == "__main__":
    sys.exit(main())
