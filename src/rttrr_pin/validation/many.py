"""Many robots in one run: each is validated, or listed with what in its file stops it."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import connection, get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Literal, get_args

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.processors import processors, use_at_most
from rttrr_pin.errors import LoadWarning, ModelMismatchError, RttrrError, UnknownNameError
from rttrr_pin.implementations import names
from rttrr_pin.loading import load
from rttrr_pin.reporting.interrupts import held_back
from rttrr_pin.reporting.results import finite
from rttrr_pin.urdf.packages import named_packages
from rttrr_pin.validation.run import validate
from rttrr_pin.validation.sampling import SAMPLINGS
from rttrr_pin.validation.states import Progress, check_count

Base = Literal["fixed", "floating"]

Verdict = Literal["agree", "disagree", "unusable"]

BASES: tuple[Base, ...] = get_args(Base)

context = get_context("spawn")


@dataclass(frozen=True, slots=True)
class Task:
    """What each robot goes through.

    Attributes:
        n_states: how many for each base.
        seed: of the generator.
        sampling: how states are drawn.
        subject: the program that is judged, by name.
        reference: the program that it is compared with, by name.
        xacro: whether xacro files are expanded, which runs the Python in them.
        xacro_args: values of their <xacro:arg>, by name.
        lenient, mimic, packages: how its file is read, see `load`.
    """

    n_states: int = 10_000
    seed: int = 0
    sampling: str = "uniform"
    subject: str = "kernel"
    reference: str = "pinocchio"
    xacro: bool = False
    xacro_args: Mapping[str, object] = field(default_factory=dict)
    lenient: bool = False
    mimic: bool = True
    packages: dict[str, str] = field(default_factory=dict)


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
        notes: what was assumed of the file, or left out.
        errors: how many `inspect` finds in the file; 0 where it is not read.
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
    notes: tuple[str, ...] = ()
    errors: int = 0


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
    named_packages(task.packages)
    if workers is not None:
        whole_number("workers", workers, 1, 10_000)
    jobs = [(name, Path(path), base, task) for name, path in sources.items() for base in BASES]
    entries: dict[int, Entry] = {}
    for number, entry in _run(jobs, min(workers or os.cpu_count() or 1, len(jobs) or 1)):
        entries[number] = entry
        if progress is not None:
            progress(len(entries))
    # What inspect finds in a file does not depend on the base: the first job of each counts it.
    errors = {entry.name: entry.errors for entry in entries.values() if entry.base == BASES[0]}
    return [replace(entries[number], errors=errors[entries[number].name]) for number in range(len(jobs))]


Job = tuple[str, Path, Base, Task]


def _run(jobs: Sequence[Job], workers: int) -> Iterator[tuple[int, Entry]]:
    """Outcomes as they come. A worker that dies costs one robot; whatever ends this ends the workers."""
    waiting = deque(enumerate(jobs))
    pool: list[_Worker] = []
    try:
        for _ in range(workers):
            with held_back():
                pool.append(_Worker(workers))
        while waiting or any(worker.busy for worker in pool):
            for slot, worker in enumerate(pool):
                if not worker.busy and waiting:
                    if not worker.process.is_alive():
                        with held_back():
                            pool[slot] = _Worker(workers)
                    pool[slot].give(*waiting.popleft())
            lines = {worker.line: worker for worker in pool if worker.busy}
            for line in connection.wait([*lines]):
                yield lines[line].outcome()  # type: ignore[index]
    finally:
        with held_back():
            for worker in pool:
                worker.process.kill()
            for worker in pool:
                worker.process.join()


class _Worker:
    """A process that takes one job after the other; it ends with the process that started it.

    It is spawned: a forked one would inherit the locks of threads that are not there.
    """

    def __init__(self, workers: int) -> None:
        self.line, child_end = context.Pipe()
        self.process = context.Process(target=_serve, args=(child_end, max(1, processors() // workers)), daemon=True)
        self._job: tuple[int, Job] | None = None
        # Ctrl-C reaches all processes of a terminal. This one answers; its workers inherit that they do not, which the
        # tracker of multiprocessing would undo if it started only now.
        resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self.process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            child_end.close()

    @property
    def busy(self) -> bool:
        """Whether it has a job whose outcome was not taken."""
        return self._job is not None

    def give(self, number: int, job: Job) -> None:
        """Hand over a job; whether it still lives is seen at the outcome."""
        self._job = number, job
        with suppress(OSError):
            self.line.send(job)

    def outcome(self) -> tuple[int, Entry]:
        """The number of the job and what came of it; that the worker died, if it did."""
        assert self._job is not None
        (number, (name, _, base, _)), self._job = self._job, None
        try:
            return number, self.line.recv()
        except (EOFError, OSError):
            self.process.join()
            code = self.process.exitcode or 0
            how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
            memory = ": was memory short?" if code == -signal.SIGKILL else ""
            return number, Entry(name, base, "unusable", defect=f"the process that ran it {how}{memory}")


def _serve(line: Connection, share: int) -> None:
    """A worker: jobs in, outcomes out, as long as there is somebody at the other end, on its share of processors."""
    use_at_most(share)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    with suppress(EOFError, OSError):
        while True:
            line.send(_entry(*line.recv()))


def _end_with_the_parent() -> None:
    """Also where that was killed, and could end nothing."""
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _entry(name: str, path: Path, base: Base, task: Task) -> Entry:
    """One robot on one base."""
    from rttrr_pin.inspection.telling import count_errors

    start = time.perf_counter()
    notes: tuple[str, ...] = ()
    errors = 0
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LoadWarning)  # the entry says it
            robot = load(
                path,
                base=base,
                xacro=task.xacro,
                xacro_args=task.xacro_args,
                lenient=task.lenient,
                mimic=task.mimic,
                packages=task.packages,
            )
        notes = tuple(note.text for note in robot.model.notes)
        errors = count_errors(robot.model.document) if base == BASES[0] else 0
        result = validate(robot, task.subject, task.reference, task.n_states, task.seed, task.sampling)
    except (RttrrError, MemoryError) as error:
        verdict: Verdict = "disagree" if isinstance(error, ModelMismatchError) else "unusable"
        defect = str(error).replace(str(path), path.name) or "there is not enough memory for it"
        seconds = time.perf_counter() - start
        return Entry(name, base, verdict, defect=defect, seconds=seconds, notes=notes, errors=errors)
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
        notes=notes,
        errors=errors,
    )


def many_data(entries: Sequence[Entry], task: Task, seconds: float) -> dict[str, Any]:
    """The outcome of many robots as data for JSON."""
    counts = Counter[str](entry.verdict for entry in entries)
    data = {
        "schema": 1,
        "passed": counts["agree"] == len(entries),
        **asdict(task),
        "verdicts": {verdict: counts[verdict] for verdict in get_args(Verdict)},
        "entries": [asdict(entry) for entry in entries],
        "seconds": seconds,
    }
    return finite(data)
