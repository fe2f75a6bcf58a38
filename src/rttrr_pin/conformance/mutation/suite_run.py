"""The plugin for pytest that runs a user's tests once for each of our wrong dynamics (see `pytest_suite`)."""

from __future__ import annotations

import json
import pickle
import pkgutil
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from _pytest.runner import runtestprotocol  # what plugins that run tests again use

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.errors import told
from rttrr_pin.implementations import Batch

LEAST, TIMES = 10.0, 10.0
"""A mutant has as many seconds, or as many times what right dynamics take, whichever is more."""


class Program:
    """What stands in place of the user's function: the dynamics of a variant, of one state or a batch.

    Attributes:
        variant: the one at work.
        calls: how often it was called.
    """

    __name__ = "inverse_dynamics"

    def __init__(self, variant: Variant, quantities: Sequence[str]) -> None:
        self.variant, self.quantities, self.calls = variant, quantities, 0

    def __call__(self, q: Any, v: Any, a: Any) -> Any:
        """The driving forces, of the shape of v; or several quantities by name."""
        self.calls += 1
        arrays = [np.array(x, dtype=np.float64) for x in (q, v, a)]
        model, shape = self.variant.model, arrays[1].shape[:-1]
        sizes = (model.nq, model.nv, model.nv)
        q, v, a = (x.reshape(-1, n) for x, n in zip(arrays, sizes, strict=True))  # fails for another robot
        values = self.variant.evaluate(Batch(model, q, v, a))
        found: dict[str, Array] = {key: values[key].reshape(*shape, *values[key].shape[1:]) for key in self.quantities}
        return found["tau"] if tuple(found) == ("tau",) else found


class Run:
    """The tests, run with one mutant after the other."""

    def __init__(self, job: dict[str, Any]) -> None:
        model: Model = job["model"]
        self.job, self.right = job, Variant(model)
        self.program = Program(self.right, job["quantities"])

    @pytest.hookimpl(tryfirst=True)
    def pytest_fixture_setup(self, fixturedef: Any, request: Any) -> Any:
        """The fixture that the tests have their function from."""
        if self.job["function"] is not None or fixturedef.argname != self.job["fixture"]:
            return None
        fixturedef.cached_result = (self.program, fixturedef.cache_key(request), None)
        return self.program

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool | None:
        """In place of running each test once."""
        if session.testsfailed or session.config.option.collectonly:
            return None  # pytest says why nothing was collected
        if self.job["function"] is not None:
            try:
                self._replace(self.job["function"])
            except (Exception, SystemExit) as error:  # the user's own module is imported
                self._write({"unknown": told(error)})
                return True
        start = time.monotonic()
        failed, items = [], []
        for item in session.items:
            before = self.program.calls
            if self._fails(item):
                failed.append(item.nodeid)
            if self.program.calls > before:
                items.append(item)
        # a test that fails without calling the function says nothing about it, and is not asked again
        failed = [name for name in failed if name in {item.nodeid for item in items}]
        self._write({"calls": len(items), "failed": failed})
        if items and not failed:
            self._all(items, max(LEAST, TIMES * (time.monotonic() - start)))
        return True

    def _all(self, items: list[pytest.Item], seconds: float) -> None:
        """Each mutant, until a test fails; those that failed last are run first."""
        hypotheses = hypotheses_of(self.right.model)
        for index, numbers in self.job["mutants"]:
            self.program.variant = hypotheses[index].apply(self.right, numbers)
            by = self._seen_by(items, seconds)
            if by is not None:
                items.remove(by)
                items.insert(0, by)
            self._write({"seen": by is not None, "by": None if by is None else by.nodeid})

    def _seen_by(self, items: Sequence[pytest.Item], seconds: float) -> pytest.Item | None:
        with np.errstate(all="ignore"), _limited(seconds):
            return next((item for item in items if self._fails(item)), None)

    def _fails(self, item: pytest.Item) -> bool:
        """Run one test, with all fixtures set up anew."""
        return any(report.failed for report in runtestprotocol(item, log=False, nextitem=None))

    def _replace(self, function: str) -> None:
        """In its module, and in every module that has imported it."""
        original = pkgutil.resolve_name(function)
        for module in list(sys.modules.values()):
            for name, value in list(getattr(module, "__dict__", {}).items()):
                if value is original:
                    setattr(module, name, self.program)

    def _write(self, line: dict[str, Any]) -> None:
        with Path(self.job["done"]).open("a") as file:
            file.write(json.dumps(line) + "\n")


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """An exception in the test that runs once the time is over: a program that never ends is seen."""

    def over(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"more than {seconds:.0f} s")

    before = signal.signal(signal.SIGALRM, over)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def pytest_addoption(parser: pytest.Parser) -> None:
    """The file that says what is to be run."""
    parser.addoption("--rttrr-mutation-job", help="Written by `rttrr-pin mutate`.")


def pytest_configure(config: pytest.Config) -> None:
    """Take over the running of tests."""
    job = pickle.loads(Path(config.getoption("--rttrr-mutation-job")).read_bytes())
    config.pluginmanager.register(Run(job), "rttrr-mutation")
