"""Damaged and hostile texts, tens of thousands of them: no crash, none above 2 s or 500 MB.

Files of equations (TOML, YAML, and LaTeX, Python and expressions in them), tables of results (CSV, JSON lines), replies
of programs, manifests of packages, and words of the command line. Each case is made from the campaign's seed and its
own number, so that `--first N --count 1` repeats one. It passes if reading it, and what follows with its result, ends
in a result that can be shown and written, or in an error of the package.

Run: python -m tests.fuzz.text_campaign [--seed S] [--first N] [--count N] [--workers N] [--save]. Exit 1 if a case fails.
"""

from __future__ import annotations

import io
import json
import os
import random
import re
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import chdir, redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .reader_cases import QUANTITIES, READERS, ROBOT, other_case, table
from .text_cases import HOSTILE, SEEDS, text_case
from .urdf_campaign import campaign, peak_memory

if TYPE_CHECKING:
    from rttrr_pin import Robot

SLOW, LARGE = 2.0, 500
"""Seconds of processor time, and megabytes beyond what the program takes by itself, for one file."""


OTHERS = 0.5
"""The share of texts that are no files of equations."""


def case(seed: int, index: int) -> tuple[str, bytes]:
    """How the file of a number is called at its end, and what is in it."""
    rng = random.Random(f"texts:{seed}:{index}")
    return other_case(rng) if rng.random() < OTHERS else text_case(rng)


def _audited(path: Path) -> tuple[str, str]:
    """What became of a file of equations, and what a terminal shows of it."""
    from rttrr_pin.auditing import audit, read_publication
    from rttrr_pin.auditing.errata import errata
    from rttrr_pin.auditing.report import show_audit, show_equations
    from rttrr_pin.reporting.files import as_json
    from rttrr_pin.reporting.output import Output

    result = audit(read_publication(path))
    shown = io.StringIO()
    for show in (show_audit, show_equations):
        show(result, Output(file=shown, width=80))
    for text in (as_json(result.to_dict()), errata(result, "markdown"), errata(result, "latex"), shown.getvalue()):
        text.encode()
    return " ".join(sorted({str(component.verdict) for component in result.components})) or "no component", (
        shown.getvalue()
    )


@cache
def _robot() -> Robot:
    import rttrr_pin

    return rttrr_pin.load(ROBOT)


def _compared(path: Path) -> tuple[str, str]:
    """A table of results against the recursion."""
    from rttrr_pin.reporting.files import as_json
    from rttrr_pin.validation import validate

    result = validate(_robot(), path, "recursion")
    as_json(result.to_dict()).encode()
    return f"compared: {result.passed}", result.summary()


def _replied(path: Path) -> tuple[str, str]:
    """What a program writes, whatever it is asked."""
    from rttrr_pin.implementations.program import Program

    program = Program(["cat", str(path)], _robot().model, seconds=1.0)
    return f"replied: {' '.join(program.quantities)}", "\n".join(program.notes)


def _packaged(path: Path) -> tuple[str, str]:
    """A manifest of a package, which is looked for by its name."""
    from rttrr_pin.urdf.packages import MANIFEST, find_package, forget_packages

    folder = path.parent / "some_package"
    folder.mkdir(exist_ok=True)
    path.replace(folder / MANIFEST)
    forget_packages()
    return f"package: {find_package('p', folder, {}) is not None}", ""


def _ran(path: Path) -> tuple[str, str]:
    """A command line, in a folder of its own."""
    from rttrr_pin.cli import main

    words, out, err = json.loads(path.read_text()), io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as folder, chdir(folder), redirect_stdout(out), redirect_stderr(err):
        code = main(words)
    assert code in (0, 1, 2), f"exit code {code}"
    said = len(err.getvalue()) - 2 * sum(map(len, words))  # a message may repeat what the user has typed
    assert said < LONGEST, f"{said} characters on stderr"
    return f"exit code {code}", "" if "-" in words else out.getvalue() + err.getvalue()  # JSON and files, as they are


READ: dict[str, Callable[[Path], tuple[str, str]]] = {
    ".toml": _audited,
    ".yaml": _audited,
    ".csv": _compared,
    ".jsonl": _compared,
    ".replies": _replied,
    ".xml": _packaged,
    ".words": _ran,
}
"""What is done with a file, by the ending of its name."""

LONGEST = 3000
"""Characters of a message."""


def check(ending: str, data: bytes, folder: Path) -> dict[str, Any]:
    """What became of a case, the seconds it took, and what is wrong with that."""
    from rttrr_pin.errors import RttrrError

    path = folder / f"case{ending}"
    path.write_bytes(data)
    before, started, failure = peak_memory(), time.process_time(), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            kind, shown = READ[ending](path)
        commands = re.findall(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", shown)
        failure = f"{commands[0]!r} reaches the terminal" if commands else ""
    except RttrrError as error:
        kind = re.sub(r"'.*?'|\".*?\"|[-+.\d]+|\[\[?\w+\]?\]", "_", str(error).partition(": ")[2])[:50]
        failure = "" if len(str(error)) < LONGEST else f"a message of {len(str(error))} characters"
    except (Exception, SystemExit) as error:
        kind, failure = "crashed", f"{type(error).__name__}: {str(error)[:200]}"
    seconds, more = time.process_time() - started, peak_memory() - before
    if seconds > SLOW or more > LARGE:
        failure = failure or f"took {seconds:.2f} s and {more:.0f} MB"
    return {"kind": f"{ending} {kind}", "seconds": seconds, "megabytes": more, "failure": failure}


def serve(seed: int, line: Any, at: Any, stage: Any) -> None:
    """A worker: lists of numbers in, what became of each case out."""
    with tempfile.TemporaryDirectory() as folder:
        warm = [(".toml", next(iter(SEEDS.values()))), (".words", '["state", "trr", "--subject", "recursion"]')]
        for ending, text in [*warm, *((".csv", table(quantities)) for quantities in QUANTITIES)]:
            check(ending, text.encode(), Path(folder))  # imports and compiling are no part of a case
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
        "others": list(READERS),
        "failures": sorted(failures, key=lambda failure: failure["case"]),
        "worst_seconds": round(slowest[0], 3),
        "worst_case": slowest[1],
        "most_megabytes_more": round(largest[0], 1),
        "largest_case": largest[1],
        "ends": dict(kinds.most_common(60)),
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
