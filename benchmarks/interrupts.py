"""Ctrl-C and SIGTERM at random times in every command: exit codes, files, processes left behind.

Each try starts a command that writes all files that it can, sends a signal after a random part of the time that the
command takes, to the process or to its whole group as a terminal does, and looks at what is left: the exit code is that
of the signal (or the command's own, where it had ended before), each file is whole or absent, what the last sentence
says of them is true, and no process is left. A signal in the first tenths of a second, before Python runs the program's
first line, ends the process by the system's own rule, or by Python's: while it sets up its streams and imports `site`
and what `.pth` files of installed packages name, it ends with exit code 1 and a fatal error of its own.

Run: python benchmarks/interrupts.py [--tries N] [--seed S] [--save]. Exit 1 if a try fails.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from common import arguments, finish

sys.path.append(str(Path(__file__).parents[1] / "tests"))
from support.processes import of_session

ROBOTS = Path(__file__).parents[1] / "urdf"

DIFFER = Path(__file__).parents[1] / "tests/data/torques_differ"

STILL = Path(__file__).parents[1] / "tests/data/still.py"
"""A program that gives zeros."""

COMMANDS: dict[str, list[str]] = {
    "validate": ["validate", "rttrr", "--json", "out.json"],
    "validate FOLDER": ["validate", str(ROBOTS), "--states", "2000", "--json", "out.json"],
    "state": ["state", "rttrr", "--json", "out.json"],
    "search": ["search", "rttrr", "--json", "out.json"],
    "laws": ["laws", "rttrr", "--json", "out.json"],
    "audit": ["audit", "--json", "a.json", "--html", "a.html", "--latex", "a.tex", "--markdown", "a.md"],
    "derive": ["derive", "trr", "--latex", "d.tex", "--markdown", "d.md", "--python", "d.py", "--c", "d.c"],
    "inspect": ["inspect", str(ROBOTS / "rttrr.urdf"), "--json", "out.json", "--fix", "fixed.urdf"],
    "inspect FOLDER": ["inspect", str(ROBOTS), "--json", "out.json", "--sarif", "out.sarif", "--junit", "out.xml"],
    "sample": ["sample", "rttrr", "-n", "5000", "-o", "states.csv"],
    "compare": ["compare", "rttrr", "trtrr", "--json", "out.json", "--html", "out.html"],
    "diagnose": [
        "diagnose",
        str(DIFFER / "fingers.urdf"),
        str(DIFFER / "pinocchio_without_mimic.csv"),
        "--json",
        "out.json",
        "--html",
        "out.html",
    ],
    "diagnose a program": ["diagnose", "trr", "--subject", f"{sys.executable} {STILL}", "--json", "out.json"],
    "new": ["new", "RTTRR", "-o", "new.urdf"],
}
"""What is run, in an empty folder."""

SIGNALS = (signal.SIGINT, signal.SIGTERM)

OF_PYTHON = "Fatal Python error: init_"
"""What Python says where it is interrupted before it runs any program."""

PATIENCE = 20.0
"""Seconds after which a process counts as left behind."""


def start(words: list[str], folder: Path, cache: Path) -> subprocess.Popen[str]:
    """A command in a session of its own, with signals as a terminal has them."""
    return subprocess.Popen(
        [sys.executable, "-m", "rttrr_pin", *words],
        cwd=folder,
        env=os.environ | {"RTTRR_PIN_CACHE": str(cache), "COLUMNS": "100", "PYTHONFAULTHANDLER": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL) and None,
    )


def whole(path: Path, wanted: str) -> bool:
    """Whether a file is what the command writes; figures such as seconds may differ in JSON."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".json":
        return text == wanted
    try:
        return list(json.loads(text)) == list(json.loads(wanted))
    except ValueError:
        return False


def at_start(code: int, number: signal.Signals, error: str) -> bool:
    """Whether it ended before the program's first line."""
    return code == -number or (code == 1 and error.startswith(OF_PYTHON))


def faults(
    process: subprocess.Popen[str], number: signal.Signals, error: str, folder: Path, complete: dict[str, Any]
) -> Iterator[str]:
    """What is wrong with what a try has left."""
    early = at_start(process.returncode, number, error)
    code, files = process.returncode, {path.name: path for path in folder.iterdir()}
    before = code == complete["code"] and set(files) == set(complete["files"])  # it had ended
    if code != 128 + number and not (before or early):
        yield f"exit code {code}: {error[-1000:]!r}"
    if "Traceback" in error and not early:
        yield f"a traceback: {error.splitlines()[-1]}"
    for name, path in files.items():
        if name not in complete["files"] or not whole(path, complete["files"][name]):
            yield f"{name} is not whole"
    if code == 128 + number:
        said = error.splitlines()[-1:] or [""]
        if ("nothing was written" in said[0]) is bool(files) or not all(name in said[0] for name in files):
            yield f"said {said[0]!r} with {', '.join(files) or 'no file'} there"
    deadline = time.monotonic() + PATIENCE
    while (left := of_session(process.pid)) and time.monotonic() < deadline:
        time.sleep(0.05)
    if left:
        os.killpg(process.pid, signal.SIGKILL)
        yield f"{len(left)} processes left"


def undisturbed(words: list[str], top: Path, cache: Path) -> dict[str, Any]:
    """What a command leaves that nobody interrupts, and how long it takes once its programs are compiled."""
    for _ in range(2):
        with tempfile.TemporaryDirectory(dir=top) as folder:
            started = time.monotonic()
            process = start(words, Path(folder), cache)
            process.communicate()
            seconds = time.monotonic() - started
            files = {path.name: path.read_text(encoding="utf-8") for path in Path(folder).iterdir()}
    return {"code": process.returncode, "files": files, "seconds": seconds}


def main() -> int:
    parser = arguments(__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--tries", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng = random.Random(options.seed)
    outcomes: dict[str, Counter[str]] = {name: Counter() for name in COMMANDS}
    failed, slowest = [], 0.0
    with tempfile.TemporaryDirectory() as place:
        top, cache = Path(place), Path(place) / "kernels"
        complete = {name: undisturbed(words, top, cache) for name, words in COMMANDS.items()}
        for k in range(options.tries):
            name, number = list(COMMANDS)[k % len(COMMANDS)], rng.choice(SIGNALS)
            to_group, delay = rng.random() < 0.5, rng.random() * 1.05 * complete[name]["seconds"]
            with tempfile.TemporaryDirectory(dir=top) as folder:
                process = start(COMMANDS[name], Path(folder), cache)
                time.sleep(delay)
                sent = time.monotonic()
                if process.poll() is None:
                    (os.killpg if to_group else os.kill)(process.pid, number)
                _, error = process.communicate()
                slowest = max(slowest, time.monotonic() - sent)
                wrong = list(faults(process, number, error, Path(folder), complete[name]))
            code = process.returncode
            early = at_start(code, number, error)
            kind = "at start" if early else "interrupted" if code == 128 + number else "had ended"
            outcomes[name][kind] += 1
            for what in wrong:
                failed.append(f"try {k}, {name}, {number.name} after {delay:.2f} s: {what}")
                print(failed[-1], file=sys.stderr)
        half_entries = [path.name for path in cache.glob("*.partial")]
    figures = {
        "tries": options.tries,
        "seed": options.seed,
        "seconds_undisturbed": {name: round(complete[name]["seconds"], 2) for name in COMMANDS},
        "outcomes": {name: dict(counts) for name, counts in outcomes.items()},
        "slowest_end_s": round(slowest, 2),
        "half_written_cache_entries": len(half_entries),
        "faults": failed,
    }
    finish("interrupts", figures, options.save)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
