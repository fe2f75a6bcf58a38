"""Parts of a batch on threads: each once, wherever; what one raises is raised, and nothing is kept or left waiting."""

from __future__ import annotations

import gc
import os
import signal
import threading
import time
import weakref

import pytest

from rttrr_pin.compile import threads
from rttrr_pin.compile.threads import PART, run


class Parts:
    """A task that writes down what it is asked for."""

    def __init__(self) -> None:
        self.asked: list[tuple[int, int]] = []

    def __call__(self, start: int, stop: int) -> bool:
        self.asked.append((start, stop))
        time.sleep(0.0002)  # so that others take parts as well
        return start <= 20_000 < stop


@pytest.mark.parametrize("count", [1, 2, 3, 7])
@pytest.mark.parametrize("rows", [1, 63, 600, PART, PART + 1, 2 * PART + 1, 20_000, 20_001, 100_000])
def test_every_state_is_in_one_part(rows: int, count: int) -> None:
    task = Parts()
    assert run(task, rows, count) == (rows > 20_000)
    parts = sorted(task.asked)
    assert [start for start, _ in parts] == [0, *(stop for _, stop in parts[:-1])] and parts[-1][1] == rows
    assert all(0 < stop - start <= PART for start, stop in parts)


def test_threads_get_as_many_parts() -> None:
    task = Parts()
    run(task, 100_000, 2)
    assert len(task.asked) % 2 == 0
    sizes = {stop - start for start, stop in task.asked}
    assert max(sizes) - min(sizes) < 64 * len(task.asked)


@pytest.mark.parametrize("where", [0, 30_000, 99_999])
def test_what_a_part_raises_is_raised_and_ends_the_rest(where: int) -> None:
    asked = []

    def task(start: int, stop: int) -> bool:
        asked.append(start)
        if start <= where < stop:
            raise MemoryError(where)
        return False

    for _ in range(3):  # threads live on
        with pytest.raises(MemoryError, match=str(where)):
            run(task, 100_000, 3)
    assert run(Parts(), 100_000, 3)


def test_several_callers_share_the_threads() -> None:
    tasks = [Parts() for _ in range(6)]
    callers = [threading.Thread(target=run, args=(task, 50_000, 3)) for task in tasks]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    for task in tasks:
        assert sum(stop - start for start, stop in task.asked) == 50_000
    assert sum(thread.name.startswith("rttrr-pin") for thread in threading.enumerate()) <= 6


def test_a_task_is_not_kept() -> None:
    task = Parts()
    run(task, 50_000, 3)
    gone = weakref.ref(task)
    del task
    for _ in range(100):
        gc.collect()
        if gone() is None:
            return
        time.sleep(0.01)  # a thread that came too late for a part lets go of the task in its turn
    raise AssertionError("a thread keeps the task")


def test_ctrl_c_is_heard_between_parts() -> None:
    """In the thread that called, whichever thread computes."""
    if threading.current_thread() is not threading.main_thread() or os.name != "posix":
        return
    asked = []

    def task(start: int, stop: int) -> bool:
        asked.append(start)
        if len(asked) == 5:
            os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.001)
        return False

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            run(task, 1000 * PART, 2)
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(asked) < 500


def test_few_numbers_stay_on_this_thread() -> None:
    assert threads.count(None, 1000) == 1
    assert threads.count(3, 1000) == 3
