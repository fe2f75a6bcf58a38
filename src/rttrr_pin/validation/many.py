"""Many robots in one run: each is validated, or listed with what in its file stops it."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal, get_args

from rttrr_pin.core.inputs import whole_number
from rttrr_pin.errors import ModelMismatchError, RttrrError, UnknownNameError
from rttrr_pin.implementations import names
from rttrr_pin.loading import load
from rttrr_pin.validation.run import validate
from rttrr_pin.validation.sampling import SAMPLINGS
from rttrr_pin.validation.states import Progress, check_count

Base = Literal["fixed", "floating"]

Verdict = Literal["agree", "disagree", "unusable"]

BASES: tuple[Base, ...] = get_args(Base)


@dataclass(frozen=True, slots=True)
class Task:
    """What each robot goes through.

    Attributes:
        n_states: how many for each base.
        seed: of the generator.
        sampling: how states are drawn.
        subject: the program that is judged, by name.
        reference: the program that it is compared with, by name.
    """

    n_states: int = 10_000
    seed: int = 0
    sampling: str = "uniform"
    subject: str = "kernel"
    reference: str = "pinocchio"


@dataclass(frozen=True, slots=True)
class Entry:
    """The outcome of one robot on one base.

    Attributes:
        name: of the robot among the sources.
        base: "fixed" or "floating".
        verdict: "agree", "disagree", or "unusable" where the file or a program stops it.
        joints: degrees of freedom.
        links: links that a joint carries.
        eps: largest normwise error of any quantity, over all links, in eps.
        of_tolerance: largest error / tolerance.
        worst: the quantity, the place and the state of that.
        defect: what stops it, or what differs; empty otherwise.
        seconds: wall time.
    """

    name: str
    base: str
    verdict: Verdict
    joints: int = 0
    links: int = 0
    eps: float = 0.0
    of_tolerance: float = 0.0
    worst: str = ""
    defect: str = ""
    seconds: float = 0.0


def validate_many(
    sources: Mapping[str, Path],
    task: Task,
    workers: int | None = None,
    progress: Progress | None = None,
) -> list[Entry]:
    """Validate each robot, on a fixed and on a floating base.

    Args:
        sources: URDF files by name.
        task: what each goes through.
        workers: processes; None takes one for each core. The outcome does not depend on it.
        progress: called with the number of entries done.

    Returns:
        Two entries for each source, in their order; none is left out.
    """
    check_count(task.n_states)  # what is wrong for every robot is an error once, not a row for each
    if task.sampling not in SAMPLINGS:
        raise UnknownNameError("sampling", task.sampling, SAMPLINGS)
    for program in (task.subject, task.reference):
        if program not in names():
            raise UnknownNameError("implementation", program, names())
    if workers is not None:
        whole_number("workers", workers, 1, 10_000)
    jobs = [(name, Path(path), base, task) for name, path in sources.items() for base in BASES]
    entries: dict[int, Entry] = {}
    for number, entry in _run(jobs, min(workers or os.cpu_count() or 1, len(jobs) or 1)):
        entries[number] = entry
        if progress is not None:
            progress(len(entries))
    return [entries[number] for number in range(len(jobs))]


def _run(jobs: Sequence[tuple[str, Path, Base, Task]], workers: int) -> Iterator[tuple[int, Entry]]:
    """Outcomes as they come; an interrupt ends the workers."""
    # A forked worker would inherit the locks of threads that are not there; a spawned one starts afresh.
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
    try:
        futures = {pool.submit(_entry, *job): number for number, job in enumerate(jobs)}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BaseException:
        for process in list(pool._processes.values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _entry(name: str, path: Path, base: Base, task: Task) -> Entry:
    """One robot on one base."""
    start = time.perf_counter()
    try:
        robot = load(path, base=base)
        result = validate(robot, task.subject, task.reference, task.n_states, task.seed, task.sampling)
    except RttrrError as error:
        verdict: Verdict = "disagree" if isinstance(error, ModelMismatchError) else "unusable"
        defect = str(error).replace(str(path), path.name)
        return Entry(name, base, verdict, defect=defect, seconds=time.perf_counter() - start)
    worst = result.worst
    return Entry(
        name,
        base,
        "agree" if result.passed else "disagree",
        joints=robot.model.nv,
        links=len(robot.link_names),
        eps=max(largest.value for largest in result.whole.values()),
        of_tolerance=worst.of_tolerance.value,
        worst=f"{worst.quantity} at {worst.at}, state {worst.of_tolerance.state}",
        seconds=time.perf_counter() - start,
    )


def many_data(entries: Sequence[Entry], task: Task, seconds: float) -> dict[str, Any]:
    """The outcome of many robots as data for JSON."""
    counts = Counter[str](entry.verdict for entry in entries)
    return {
        "schema": 1,
        "passed": counts["agree"] == len(entries),
        **asdict(task),
        "verdicts": {verdict: counts[verdict] for verdict in get_args(Verdict)},
        "entries": [asdict(entry) for entry in entries],
        "seconds": seconds,
    }
