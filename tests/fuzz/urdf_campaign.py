"""Damaged URDFs, a hundred thousand of them: no crash, no hang, no file accepted whose numbers its text does not say.

Each case is made from the campaign's seed and its own number, so that `--first N --count 1` repeats one. A case passes
if `rttrr_pin.load` raises an error of the package, or returns a model that says, number by number, what a second reader
finds in the text (second_reader.py), within a second. Of the accepted ones a share is also held against the model that
Pinocchio builds; where Pinocchio reads another number than the text has, our check must say so. Workers are processes:
one that dies or hangs is noticed, and what it was at is written down.

Run: python -m tests.fuzz.urdf_campaign [--seed S] [--first N] [--count N] [--workers N] [--no-examples] [--save].
Exit 1 if a case fails. Without the example robots the cases are those of a machine that has not installed them.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import re
import resource
import sys
import tempfile
import time
import warnings
from collections import Counter, deque
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from .mutations import mutate
from .second_reader import differences
from .seeds import SMALL, seeds

SLOW = 1.0
"""Seconds of processor time that reading one file may take."""

LARGE = 500.0
"""Megabytes that it may take."""

HANGS = 20.0
"""Seconds after which a worker that does not move on is ended."""

PINOCCHIO_SHARE = 1.0
"""Of the accepted files."""

ENOUGH = 200
"""Failures after which a campaign stops."""

CHUNK = 250
"""Cases given to a worker at a time."""

FAILURES = Path(__file__).parents[2] / "benchmarks/results/fuzz_urdf_failures"
"""Where the texts of failures are kept."""

LOADING, PINOCCHIO = 0, 1


def case(seed: int, index: int, texts: dict[str, str]) -> str:
    """The damaged text of a number; what is no UTF-8 is in surrogate escapes."""
    rng = random.Random(f"{seed}:{index}")
    small = rng.random() < 0.6  # they are quick, and hold more kinds of joints
    return mutate(texts[rng.choice(list(SMALL if small else texts))], rng)


def load(text: str, folder: Path) -> Any:
    """By its text; from a file where it is no text but bytes."""
    import rttrr_pin

    try:
        text.encode()
    except UnicodeEncodeError:
        path = folder / "case.urdf"
        path.write_bytes(text.encode(errors="surrogateescape"))
        return rttrr_pin.load(path, friction=True)
    return rttrr_pin.load(text, friction=True)


def check(text: str, folder: Path, ask_pinocchio: Any) -> dict[str, Any]:
    """What became of a case: its kind, the seconds it took, and what is wrong with that."""
    from rttrr_pin.errors import RttrrError

    before, started, failure = peak_memory(), time.process_time(), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            model = load(text, folder).model
        kind, line = "accepted", True
    except RttrrError as error:
        model, kind, line = None, refusal(error), getattr(error, "line", None) is not None
    except Exception as error:
        model, kind, line = None, "crashed", True
        failure = f"{type(error).__name__}: {error}"
    seconds, megabytes = time.process_time() - started, peak_memory() - before
    if model is not None:
        failure = "; ".join(differences(text.encode(errors="surrogateescape"), model))
        if not failure:
            answer, failure = ask_pinocchio(model)
            kind += answer
    if seconds > SLOW:
        failure = failure or f"took {seconds:.2f} s"
    if megabytes > LARGE:
        failure = failure or f"took {megabytes:.0f} MB"
    return {"kind": kind, "line": line, "seconds": seconds, "megabytes": megabytes, "failure": failure}


def peak_memory() -> float:
    """The most that this process has taken so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def refusal(error: Exception) -> str:
    """The message without what is particular to the case."""
    message = str(error).splitlines()[0]
    message = re.sub(r"^(<string>|/\S*case\.urdf)(, line \d+)?: ((link|joint|robot)( \".*?\")?: )?", "", message)
    message = re.sub(r"<(\w+) (\w+)=\".*?\">", r"<\1>", message)
    message = re.sub(r"(attribute|through|_ is) .*", r"\1", re.sub(r"'.*?'|\".*?\"|<[^>]*>|[-+.\d]+", "_", message))
    return f"{type(error).__name__}: {re.split('[:(;,]', message)[0].strip()[:60]}"


def ask(model: Any, stage: Any, chance: float) -> tuple[str, str]:
    """Pinocchio's model of the same text against ours: what came of it, and what is wrong with that."""
    from rttrr_pin.errors import ImplementationError, ModelMismatchError
    from rttrr_pin.implementations import make_implementation

    if chance > PINOCCHIO_SHARE:
        return "", ""
    stage.value = PINOCCHIO
    try:
        make_implementation("pinocchio", model)
    except ModelMismatchError as error:
        what = re.sub("(link|joint) '.*?'", r"\1", error.differences[0]).split(":")[0]
        return f", Pinocchio's model differs: {what}", ""
    except ImplementationError:
        return ", Pinocchio refuses", ""
    except Exception as error:
        return ", the oracle crashed", f"the oracle crashed: {type(error).__name__}: {error}"
    finally:
        stage.value = LOADING
    return ", Pinocchio agrees", ""


def serve(texts: dict[str, str], seed: int, line: Any, at: Any, stage: Any) -> None:
    """A worker: lists of numbers in, what became of each case of these texts out."""
    with Path(os.devnull).open("w") as nowhere:  # Pinocchio writes what it thinks of a file to stderr
        os.dup2(nowhere.fileno(), 2)
    with tempfile.TemporaryDirectory() as folder:
        load(SMALL["one"], Path(folder))  # loads yourdfpy, which is no part of a case's time
        while (indices := line.recv()) is not None:
            tally = []
            for index in indices:
                at.value = index
                chance = random.Random(f"pinocchio:{seed}:{index}").random()
                text = case(seed, index, texts)
                tally.append(check(text, Path(folder), lambda model, chance=chance: ask(model, stage, chance)))
            line.send(tally)


class Worker:
    """A process that runs cases, watched from outside: it may die, or never come back."""

    def __init__(self, seed: int, serve: Any) -> None:
        self.seed, self.indices, self.serve = seed, [], serve
        self.start()

    def start(self) -> None:
        """Start the process."""
        context = multiprocessing.get_context("spawn")
        self.at, self.stage = context.Value("q", -1, lock=False), context.Value("i", LOADING, lock=False)
        self.line, theirs = context.Pipe()
        self.process = context.Process(target=self.serve, args=(self.seed, theirs, self.at, self.stage), daemon=True)
        self.process.start()
        theirs.close()

    def give(self, indices: list[int]) -> None:
        """Hand over cases; one list at a time."""
        self.indices, self.last, self.moved = indices, -1, time.monotonic() + 60.0  # a minute to import
        self.line.send(indices)

    def results(self) -> dict[int, dict[str, Any]] | None:
        """What became of the cases given, once all are done.

        Raises:
            EOFError: the process died.
            TimeoutError: it stands still.
        """
        if self.line.poll():
            return dict(zip(self.indices, self.line.recv(), strict=True))
        if self.at.value != self.last:
            self.last, self.moved = self.at.value, time.monotonic() + (60.0 if self.at.value < 0 else 0.0)
        if not self.process.is_alive():
            raise EOFError
        if time.monotonic() - self.moved > HANGS:
            raise TimeoutError
        return None

    def replace(self, error: Exception) -> tuple[int, str]:
        """End the process and start another; the case it was at, and what happened there."""
        self.process.join(1.0 if isinstance(error, EOFError) else 0.0)
        self.process.kill()
        self.process.join()
        how = "hung" if isinstance(error, TimeoutError) else f"the process died ({self.process.exitcode})"
        lost = self.at.value, f"{how} in {'Pinocchio' if self.stage.value == PINOCCHIO else 'load'}"
        self.start()
        return lost


def campaign(seed: int, numbers: range, workers: int, serve: Any) -> Iterator[tuple[int, dict[str, Any]]]:
    """What became of each case, by the workers' function; the order is that in which they come back."""
    todo = deque(list(numbers[k : k + CHUNK]) for k in range(0, len(numbers), CHUNK))
    pool = [Worker(seed, serve) for _ in range(min(workers, len(todo)))]
    while todo or any(worker.indices for worker in pool):
        for worker in pool:
            if not worker.indices:
                if todo:
                    worker.give(todo.popleft())
                continue
            try:
                results = worker.results()
            except (EOFError, TimeoutError, ConnectionError) as error:
                index, what = worker.replace(error)
                yield index, {"kind": what, "line": True, "seconds": 0.0, "megabytes": 0.0, "failure": what}
                todo.appendleft([other for other in worker.indices if other != index])
                worker.indices = []
                continue
            if results is not None:
                yield from results.items()
                worker.indices = []
        time.sleep(0.02)
    for worker in pool:
        worker.line.send(None)
        worker.process.join()  # one that is left behind ends with this process


def summary(
    texts: dict[str, str], seed: int, numbers: range, outcomes: Iterable[tuple[int, dict[str, Any]]]
) -> dict[str, Any]:
    """The figures of a campaign; each failure as a line, and its text as a file."""
    kinds, no_line, failures = Counter[str](), Counter[str](), []
    worst, largest, total, started = (0.0, -1), 0.0, 0.0, time.monotonic()
    for done, (index, outcome) in enumerate(outcomes, start=1):
        kinds[outcome["kind"]] += 1
        no_line[outcome["kind"]] += not outcome["line"]
        worst, total = max(worst, (outcome["seconds"], index)), total + outcome["seconds"]
        largest = max(largest, outcome["megabytes"])
        if outcome["failure"]:
            failures.append({"case": index, "what": outcome["failure"][:500]})
            keep(seed, index, texts)
        if len(failures) >= ENOUGH:
            print(f"stopped after {ENOUGH} failures", file=sys.stderr)
            break
        if done % 10_000 == 0:
            print(f"{done:,} cases, {len(failures)} failures, {time.monotonic() - started:.0f} s", file=sys.stderr)
    accepted = {kind: count for kind, count in kinds.most_common() if kind.startswith("accepted")}
    refused = {kind: count for kind, count in kinds.most_common() if kind not in accepted}
    return {
        "seed": seed,
        "cases": [numbers.start, numbers.stop - 1],
        "seeds": list(texts),
        "accepted": sum(accepted.values()),
        "refused": sum(refused.values()),
        "failures": sorted(failures, key=lambda failure: failure["case"]),
        "worst_seconds": round(worst[0], 4),
        "worst_case": worst[1],
        "worst_megabytes": round(largest, 1),
        "mean_milliseconds": round(1e3 * total / max(len(numbers), 1), 3),
        "accepted_and_pinocchio": accepted,
        "refused_by_kind": refused,
        "refused_without_line": {kind: count for kind, count in no_line.most_common() if count},
    }


def keep(seed: int, index: int, texts: dict[str, str]) -> None:
    FAILURES.mkdir(parents=True, exist_ok=True)
    (FAILURES / f"{seed}_{index}.urdf").write_bytes(case(seed, index, texts).encode(errors="surrogateescape"))


def main() -> int:
    from benchmarks.common import arguments, finish

    parser = arguments(__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--no-examples", action="store_true", help="damage no example robots")
    options = parser.parse_args()
    numbers, texts = range(options.first, options.first + options.count), seeds(not options.no_examples)
    outcomes = campaign(options.seed, numbers, options.workers, partial(serve, texts))
    figures = summary(texts, options.seed, numbers, outcomes)
    finish("fuzz_urdf_no_examples" if options.no_examples else "fuzz_urdf", figures, options.save)
    return 1 if figures["failures"] else 0


if __name__ == "__main__":
    sys.exit(main())
