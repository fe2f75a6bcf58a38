"""Damaged and hostile files of equations, tens of thousands of them: no crash, none above 2 s or 500 MB.

Each case is made from the campaign's seed and its own number, so that `--first N --count 1` repeats one. It passes if
`audit` of it ends in a result, whose sheet and table can be written, or in an error of the package.

Run: python -m tests.fuzz.text_campaign [--seed S] [--first N] [--count N] [--workers N] [--save]. Exit 1 if a case fails.
"""

from __future__ import annotations

import io
import os
import re
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .text_cases import HOSTILE, SEEDS, case
from .urdf_campaign import campaign

SLOW, LARGE = 2.0, 500
"""Seconds of processor time, and megabytes beyond what the program takes by itself, for one file."""


def megabytes() -> float:
    """The most that this process ever took."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def check(ending: str, data: bytes, folder: Path) -> dict[str, Any]:
    """What became of a case, the seconds it took, and what is wrong with that."""
    from rttrr_pin.auditing import audit, read_publication
    from rttrr_pin.auditing.errata import errata
    from rttrr_pin.auditing.report import show_audit, show_equations
    from rttrr_pin.errors import RttrrError
    from rttrr_pin.reporting.files import as_json
    from rttrr_pin.reporting.output import Output

    path = folder / f"case{ending}"
    path.write_bytes(data)
    before, started, failure = megabytes(), time.process_time(), ""
    try:
        result = audit(read_publication(path))
        shown = io.StringIO()
        for show in (show_audit, show_equations):
            show(result, Output(file=shown, width=80))
        for text in (as_json(result.to_dict()), errata(result, "markdown"), errata(result, "latex"), shown.getvalue()):
            text.encode()
        commands = re.findall(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", shown.getvalue())
        failure = f"{commands[0]!r} reaches the terminal" if commands else ""
        kind = " ".join(sorted({str(component.verdict) for component in result.components})) or "no component"
    except RttrrError as error:
        kind = re.sub(r"'.*?'|\".*?\"|[-+.\d]+|\[\[?\w+\]?\]", "_", str(error).partition(": ")[2])[:50]
        failure = "" if len(str(error)) < 3000 else f"a message of {len(str(error))} characters"
    except Exception as error:
        kind, failure = "crashed", f"{type(error).__name__}: {str(error)[:200]}"
    seconds, more = time.process_time() - started, megabytes() - before
    if seconds > SLOW or more > LARGE:
        failure = failure or f"took {seconds:.2f} s and {more:.0f} MB"
    return {"kind": kind, "seconds": seconds, "megabytes": more, "failure": failure}


def serve(seed: int, line: Any, at: Any, stage: Any) -> None:
    """A worker: lists of numbers in, what became of each case out."""
    with tempfile.TemporaryDirectory() as folder:
        check(".toml", next(iter(SEEDS.values())).encode(), Path(folder))  # the imports are no part of a case
        while (indices := line.recv()) is not None:
            tally = []
            for index in indices:
                at.value = index
                tally.append(check(*case(seed, index), Path(folder)))
            line.send(tally)


def summary(seed: int, numbers: range, outcomes: Iterable[tuple[int, dict[str, Any]]]) -> dict[str, Any]:
    """The figures of a campaign."""
    kinds, failures, slowest, largest = Counter[str](), [], (0.0, -1), (0.0, -1)
    for done, (index, outcome) in enumerate(outcomes, start=1):
        kinds[outcome["kind"]] += 1
        slowest = max(slowest, (outcome["seconds"], index))
        largest = max(largest, (outcome.get("megabytes", 0.0), index))
        if outcome["failure"]:
            failures.append({"case": index, "what": outcome["failure"][:300]})
            print(index, outcome["failure"][:300], file=sys.stderr)
        if done % 5000 == 0:
            print(f"{done:,} cases, {len(failures)} failures", file=sys.stderr)
    return {
        "seed": seed,
        "cases": [numbers.start, numbers.stop - 1],
        "damaged": list(SEEDS),
        "hostile": list(HOSTILE),
        "failures": sorted(failures, key=lambda failure: failure["case"]),
        "worst_seconds": round(slowest[0], 3),
        "worst_case": slowest[1],
        "most_megabytes_more": round(largest[0], 1),
        "largest_case": largest[1],
        "ends": dict(kinds.most_common(40)),
    }


def main() -> int:
    from benchmarks.common import arguments, finish

    parser = arguments(__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.count)
    figures = summary(options.seed, numbers, campaign(options.seed, numbers, options.workers, serve))
    finish("fuzz_texts", figures, options.save)
    return 1 if figures["failures"] else 0


if __name__ == "__main__":
    sys.exit(main())
