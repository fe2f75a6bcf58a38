"""Claim: of the files that robots are published with, none that Pinocchio loads stops us; those loaded are right.

Files are not part of this repository. FOLDER holds `OWNER__NAME/path/of/file.urdf`, and `repositories.json`, a list of
records with `repo` ("OWNER/NAME") and `commit`. Each file goes through the steps of `STEPS` in a worker process.

Run: python benchmarks/real_files.py FOLDER [--last STEP] [--subject NAME] [--states N] [--limit SECONDS]
[--workers N] [--details FILE] [--save]. Times are processor time, so that a busy machine does not alter them.
Exit 1 if one disagrees, crashes, or Pinocchio loads it and we cannot go on.
"""

from __future__ import annotations

import inspect as signatures
import json
import os
import re
import resource
import sys
import tempfile
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from common import arguments, finish

STEPS = ("pinocchio", "plain", "lenient", "inspect", "validate fixed", "validate floating")
"""What each file goes through; the last three with the robot of the first way that loaded it."""

MEMORY = 8 * 2**30
"""Bytes of address space of a worker."""

PATIENCE = 20
"""Times the limit that a worker may take on the clock: one that waits for ever uses no processor time."""

SLOW = 5.0
"""Seconds; a step that takes longer is listed."""

NO_SUCH_OPTION = "this version has no such option"

LONGEST = 220
"""Characters of a reason."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one step.

    The verdict is "ok", "refused", "mismatch" where Pinocchio built another model than the file describes, "disagree",
    "crash", or "time" where the limit ran out.
    """

    step: str
    verdict: str
    seconds: float
    reason: str = ""
    detail: str = ""


def masked(text: str) -> str:
    """A message without what differs from file to file: names, numbers, lines."""
    text = re.sub(r"\"[^\"]*\"|'[^']*'|(?<=element )<[^>]*>", "'…'", " ".join(text.split()))
    text = re.sub(r"(?<![A-Za-z_])[-+]?\d[\d_,]*(\.\d*)?([eE][-+]?\d+)?(?![A-Za-z])", "#", text)
    text = re.sub(r": (there are|did you mean) .*", "", text)
    text = re.sub(r"\b(links?|joints?) [\w./-]*_[\w./-]*", r"\1 …", text)
    return text if len(text) <= LONGEST else text[:LONGEST] + "..."


def reason(error: BaseException, path: Path) -> str:
    """The kind of an error: its message, masked, without the place in the file; of a wrong model, what differs."""
    if differences := getattr(error, "differences", None):
        return "; ".join(sorted({masked(line).partition(":")[0] for line in differences}))
    text = str(error)
    source = getattr(error, "source", str(path))
    text = re.sub(rf"^{re.escape(source)}(, line \d+)?: ", "", text)
    element = getattr(error, "element", "")
    if element and text.startswith(f"{element}: "):
        text = f"{element.split()[0]}: {text.removeprefix(f'{element}: ')}"
    name = "" if getattr(error, "source", None) else f"{type(error).__name__}: "
    return masked(name + text.replace(str(path), "…").replace(path.name, "…"))


def attempt(step: str, path: Path, action: Callable[[], str]) -> Outcome:
    """One step; an error of this package is a refusal, or of the model that Pinocchio built; any other is a crash."""
    from rttrr_pin.errors import ModelMismatchError, RttrrError

    start = time.process_time()
    verdict, why, detail = "ok", "", ""
    try:
        if detail := action():
            verdict, why = "disagree", masked(detail)
    except Exception as error:
        refusal = RttrrError if step != "pinocchio" else Exception  # its loader raises what it likes
        verdict = "refused" if isinstance(error, refusal) else "crash"
        if isinstance(error, ModelMismatchError):
            verdict = "mismatch"
        why, detail = reason(error, path), f"{type(error).__name__}: {error}"
    return Outcome(step, verdict, round(time.process_time() - start, 3), why, detail)


@dataclass(frozen=True, slots=True)
class Task:
    """What each file goes through: up to which step, and how it is validated."""

    last: str = STEPS[-1]
    subject: str = "kernel"
    states: int = 20

    @property
    def steps(self) -> tuple[str, ...]:
        """The steps up to the last."""
        return STEPS[: STEPS.index(self.last) + 1]


class Passage:
    """One file on its way through the steps; the later ones use the robot of the first way that loaded it."""

    def __init__(self, path: Path, task: Task) -> None:
        self.path, self.task = path, task
        self.robot: Any = None
        self.options: dict[str, Any] = {}
        self.actions: dict[str, Callable[[], str]] = {
            "pinocchio": self.build,
            "plain": self.load,
            "lenient": self.load_lenient,
            "inspect": self.inspect,
            "validate fixed": lambda: self.validate("fixed"),
            "validate floating": lambda: self.validate("floating"),
        }

    def steps(self) -> Iterator[str]:
        """The steps that those before them allow."""
        return (step for step in self.task.steps if self._allows(step))

    def take(self, step: str) -> Outcome:
        """Take one step."""
        return attempt(step, self.path, self.actions[step])

    def _allows(self, step: str) -> bool:
        """Whether a step has something to do after those before it."""
        if step in ("pinocchio", "plain", "lenient"):
            return self.robot is None
        if step == "validate fixed":  # without a joint there is nothing to compare
            return self.robot is not None and bool(self.robot.joint_names)
        return self.robot is not None

    def build(self) -> str:
        """What Pinocchio makes of the file."""
        import pinocchio

        pinocchio.buildModelFromUrdf(str(self.path))
        return ""

    def load(self, **options: Any) -> str:
        """Read the file as it is."""
        import rttrr_pin

        self.options = options
        self.robot = rttrr_pin.load(self.path, **options)
        return ""

    def load_lenient(self) -> str:
        """Read the file with assumptions, where this version can."""
        import rttrr_pin
        from rttrr_pin.errors import InputError

        if "lenient" not in signatures.signature(rttrr_pin.load).parameters:
            raise InputError(NO_SUCH_OPTION)
        return self.load(lenient=True)

    def inspect(self) -> str:
        """Inspect the file; its findings are no matter here."""
        import rttrr_pin

        rttrr_pin.inspect(self.robot).summary()
        return ""

    def validate(self, base: str) -> str:
        """Compare with Pinocchio; what differs most, or ""."""
        import rttrr_pin

        robot = rttrr_pin.load(self.path, base=base, **self.options) if base != "fixed" else self.robot
        result = rttrr_pin.validate(robot, self.task.subject, n_states=self.task.states)
        worst = result.worst
        return "" if result.passed or worst is None else f"beyond the tolerance: {worst.quantity} at {worst.at}"


def serve(connection: Connection, task: Task) -> None:
    """A worker: paths in; out comes each step's name before it is taken and its outcome after, at the end None."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)  # urdfdom writes there
    while (path := connection.recv()) is not None:
        passage = Passage(Path(path), task)
        for step in passage.steps():
            connection.send(step)
            connection.send(passage.take(step))
        connection.send(None)


class Worker:
    """A process that takes one file at a time, and a new one after a file that ended it."""

    def __init__(self, task: Task, limit: float) -> None:
        self.task, self.limit = task, limit
        self._start()

    def _start(self) -> None:
        context = get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, self.task), daemon=True)
        self.process.start()
        theirs.close()

    def outcomes(self, path: Path) -> list[Outcome]:
        """Of each step until the last, or until one ends the process or takes too long."""
        seen, step = list[Outcome](), STEPS[0]
        self.connection.send(str(path))
        while True:
            try:
                if not self._answers():
                    verdict, why = "time", f"takes longer than {self.limit:g} s"
                    break
                message = self.connection.recv()
            except EOFError:
                self.process.join()
                verdict, why = "crash", f"the process ended with code {self.process.exitcode}"
                break
            if message is None:
                return seen
            if isinstance(message, Outcome):
                seen.append(message)
            else:
                step = message
        seen.append(Outcome(step, verdict, self.limit if verdict == "time" else 0.0, why, why))
        self.process.kill()
        self.process.join()
        self._start()
        return seen

    def _answers(self) -> bool:
        """Whether the next message comes within the limit."""
        used, clock = self._processor_time(), time.monotonic()
        while not self.connection.poll(0.5):
            if self._processor_time() - used > self.limit or time.monotonic() - clock > PATIENCE * self.limit:
                return False
        return True

    def _processor_time(self) -> float:
        """Seconds that the process has used, as Linux tells."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:  # it has ended, which the pipe tells next
            return 0.0
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def stop(self) -> None:
        """End the process."""
        self.connection.send(None)
        self.process.join()


def loaded(outcomes: list[Outcome]) -> str:
    """The way that loaded a file, "" where none did."""
    return next((o.step for o in outcomes if o.step in ("plain", "lenient") and o.verdict == "ok"), "")


def run(files: list[Path], task: Task, limit: float, workers: int) -> Iterator[list[Outcome]]:
    """The outcomes of each file, in their order."""
    own = threading.local()
    started: list[Worker] = []

    def one(path: Path) -> list[Outcome]:
        if not hasattr(own, "worker"):
            own.worker = Worker(task, limit)
            started.append(own.worker)
        return own.worker.outcomes(path)  # type: ignore[no-any-return]

    with ThreadPoolExecutor(workers) as pool:
        yield from pool.map(one, files)
    for worker in started:
        worker.stop()


def tally(names: list[str], results: list[list[Outcome]]) -> dict[str, Any]:
    """Counts over some files."""
    counts: Counter[str] = Counter()
    for outcomes in results:
        by_step = {outcome.step: outcome for outcome in outcomes}
        way = loaded(outcomes)
        pinocchio = by_step["pinocchio"].verdict == "ok"
        counts["files"] += 1
        counts["pinocchio"] += pinocchio
        counts[way or "refused"] += 1
        counts["pinocchio_loads_we_refuse"] += pinocchio and not way
        counts["we_load_pinocchio_refuses"] += bool(way) and not pinocchio
        compared = [outcome for outcome in outcomes if outcome.step.startswith("validate")]
        counts["validated"] += bool(compared)
        counts["agree"] += bool(compared) and all(outcome.verdict == "ok" for outcome in compared)
        counts["mismatch"] += any(outcome.verdict == "mismatch" for outcome in compared)
        counts["disagree"] += any(outcome.verdict == "disagree" for outcome in compared)
        counts["crash"] += any(outcome.verdict == "crash" for outcome in outcomes)
        counts["time"] += any(outcome.verdict == "time" for outcome in outcomes)
        counts["inspected"] += "inspect" in by_step and by_step["inspect"].verdict == "ok"
    return {name: counts[name] for name in names if name == "files" or counts[name]}


COLUMNS = [
    "files", "pinocchio", "plain", "lenient", "refused", "pinocchio_loads_we_refuse", "we_load_pinocchio_refuses",
    "validated", "agree", "mismatch", "disagree", "crash", "time", "inspected",
]  # fmt: skip
"""Numbers of files; of those that were "validated": "agree" on both bases, without a joint on the floating one;
"mismatch", "disagree" on one."""


def reasons(names: list[str], results: list[list[Outcome]]) -> list[dict[str, Any]]:
    """What stopped files, by step and kind, most frequent first."""
    found: dict[tuple[str, str, str, bool], list[str]] = defaultdict(list)
    for name, outcomes in zip(names, results, strict=True):
        pinocchio = outcomes[0].verdict == "ok"
        for outcome in outcomes:
            if outcome.verdict != "ok" and NO_SUCH_OPTION not in outcome.reason:
                found[outcome.step, outcome.verdict, outcome.reason, pinocchio].append(name)
    return [
        {"step": step, "verdict": verdict, "pinocchio_loads": pinocchio, "reason": why}
        | {"files": len(where), "repositories": len({name.split("/")[0] for name in where}), "example": where[0]}
        for (step, verdict, why, pinocchio), where in sorted(
            found.items(), key=lambda item: (STEPS.index(item[0][0]), -len(item[1]))
        )
    ]


def kept(details: Path | None) -> dict[str, list[Outcome]]:
    """The outcomes by file that a run before wrote, so that one that was stopped can go on."""
    if details is None or not details.exists():
        return {}
    lines = map(json.loads, details.read_text().splitlines())
    return {line["file"]: [Outcome(**step) for step in line["steps"]] for line in lines}


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--last", choices=STEPS, default=STEPS[-1], help="the last step to take")
    parser.add_argument("--subject", default="kernel", help="the program that validate judges")
    parser.add_argument("--states", type=int, default=20)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds that a step may take")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--details", type=Path, help="a line of JSON for each file; those there are kept")
    chosen = parser.parse_args()
    task = Task(chosen.last, chosen.subject, chosen.states)
    listed = json.loads((chosen.folder / "repositories.json").read_text())
    commits = {entry["repo"]: entry["commit"] for entry in listed}
    files = sorted(path for path in chosen.folder.rglob("*") if path.suffix.lower() == ".urdf" and path.is_file())
    names = [path.relative_to(chosen.folder).as_posix() for path in files]
    known = kept(chosen.details)
    new = [file for file, name in zip(files, names, strict=True) if name not in known]
    with tempfile.TemporaryDirectory() as cache, open(chosen.details or os.devnull, "a") as details:  # noqa: PTH123
        os.environ["XDG_CACHE_HOME"] = cache
        for file, outcomes in zip(new, run(new, task, chosen.limit, chosen.workers), strict=True):
            name = file.relative_to(chosen.folder).as_posix()
            known[name] = outcomes
            line = {"file": name, "steps": [asdict(outcome) for outcome in outcomes]}
            print(json.dumps(line), file=details, flush=True)
    results = [known[name] for name in names]
    by_repository: dict[str, list[list[Outcome]]] = defaultdict(list)
    for name, each in zip(names, results, strict=True):
        by_repository[name.split("/")[0].replace("__", "/", 1)].append(each)
    figures = {
        "task": asdict(task),
        "limit_s": chosen.limit,
        "lenient_option": not any(NO_SUCH_OPTION in o.reason for each in results for o in each),
        "counts": tally(COLUMNS, results),
        "repositories": [
            {"repo": repo, "commit": commits.get(repo, "")[:12]} | tally(COLUMNS, each)
            for repo, each in by_repository.items()
        ],
        "stopped": reasons(names, results),
        "slow": [
            {"file": name, "step": outcome.step, "seconds": round(outcome.seconds, 1)}
            for name, each in zip(names, results, strict=True)
            for outcome in each
            if outcome.seconds > SLOW
        ],
        "processor_seconds": round(sum(outcome.seconds for each in results for outcome in each), 1),
    }
    finish("real_files", figures, chosen.save)
    counts = figures["counts"]
    return int(any(counts.get(name) for name in ("disagree", "crash", "time", "pinocchio_loads_we_refuse")))


if __name__ == "__main__":
    sys.exit(main())
