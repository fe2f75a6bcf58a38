"""Claim: the paper's 60 components are audited in under 15 s, and all its moments n_i derived in under 10 s.

Each run is a process of its own, timed from outside; the totals are those of the audit's JSON.
Run: python benchmarks/audit_paper.py [--repeats N] [--save]. Exit 1 if something is unparsed, or a time is exceeded.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from common import arguments, finish

LIMITS = {"audit": 15.0, "derive": 10.0}


def run(words: list[str]) -> float:
    """Wall time of a command [s]; an audit with findings exits with 1."""
    start = time.perf_counter()
    done = subprocess.run([sys.executable, "-m", "rttrr_pin", *words], check=False)
    assert done.returncode in (0, 1), words
    return time.perf_counter() - start


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=5)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        report, page = Path(folder) / "audit.json", Path(folder) / "n.md"
        commands = {
            "audit": ["audit", "--quiet", "--json", str(report)],
            "derive": ["derive", "--quiet", "--quantity", "n", "--markdown", str(page)],
        }
        seen: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(chosen.repeats):
            for name, words in commands.items():
                seen[name].append(run(words))
        audit = json.loads(report.read_text())
        components = audit["components"]
    findings = [finding for component in components for finding in component["findings"]]
    medians = {name: round(statistics.median(times), 2) for name, times in seen.items()}
    figures = {
        "components": len(components),
        "verdicts": dict(Counter(component["verdict"] for component in components)),
        "printed_terms": sum(component["printed_terms"] for component in components),
        "findings": len(findings),
        "kinds": dict(Counter(finding["kind"] for finding in findings)),
        "terms_of_wrong_dimension": audit["totals"]["dimensionally_wrong"],
        "seconds_median": medians,
        "seconds": {name: [round(x, 2) for x in sorted(times)] for name, times in seen.items()},
    }
    finish("audit_paper", figures, chosen.save)
    unparsed = figures["verdicts"].get("unparsed", 0)  # type: ignore[attr-defined]
    return 1 if unparsed or any(medians[name] > limit for name, limit in LIMITS.items()) else 0


if __name__ == "__main__":
    sys.exit(main())
