"""A suite of the user's for pytest, run once for each of our wrong dynamics in place of the function that it tests.

One process runs all of them (`suite_run`): it collects the tests once, runs them with right dynamics, and then for each
mutant until one fails.
"""

from __future__ import annotations

import json
import os
import pickle
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rttrr_pin.conformance.mutation.mutants import Mutants
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, InputError, listed

FIXTURE = "inverse_dynamics"
"""The fixture that is replaced, unless another or a function is named."""

POLL = 0.1
"""Seconds between two looks at how far the tests are."""

TAIL = 3000
"""Characters of what pytest printed that an error shows."""


@dataclass(frozen=True, slots=True)
class PytestSuite:
    """Tests that are run by pytest. They call f(q, v, a), of one state or a batch, by a fixture or as a function.

    Attributes:
        arguments: of pytest, such as ("tests/test_dynamics.py", "-k", "fast"); a text is split as by a shell.
        function: the function that the tests call, such as "my_package.dynamics:inverse_dynamics"; it is replaced in
            every module that has imported it. None where they have it from a fixture.
        fixture: the name of that fixture.
        quantities: what the function returns: tau alone as an array; several as a dict by quantity.
        progress: called with the number of mutants done.
    """

    arguments: str | Sequence[str]
    function: str | None = None
    fixture: str = FIXTURE
    quantities: tuple[str, ...] = ("tau",)
    progress: Callable[[int], None] | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check what was passed.

        Raises:
            InputError: it cannot be used.
        """
        try:
            words = shlex.split(self.arguments) if isinstance(self.arguments, str) else list(self.arguments)
        except ValueError as error:
            raise InputError(
                f"the arguments of pytest are {self.arguments!r}: {error}; expected words as a shell splits them",
                options={"the arguments of pytest are": "--pytest is"},
            ) from None
        object.__setattr__(self, "arguments", tuple(map(os.fspath, words)))
        object.__setattr__(self, "quantities", tuple(key for key in QUANTITIES if key in self.quantities))
        if self.function is not None and ":" not in self.function:
            raise InputError(f"function is {self.function!r}: expected a module and a name, my_module:my_function")

    @property
    def payload(self) -> bool:
        """A function f(q, v, a) takes none."""
        return False

    @property
    def sentence(self) -> str:
        """What is run."""
        return shlex.join(["pytest", *self.arguments])

    def sees(self, mutants: Mutants) -> Iterator[bool]:
        """Of each mutant whether a test fails on it.

        Raises:
            ImplementationError: pytest cannot be run, no test calls the function, or one fails with right dynamics.
        """
        with tempfile.TemporaryDirectory() as folder:
            job, done, printed = (Path(folder) / name for name in ("job", "done.jsonl", "printed"))
            own = {
                "model": mutants.robot.model,
                "mutants": [(one.index, one.numbers) for one in mutants.found],
                "quantities": self.quantities,
                "function": self.function,
                "fixture": self.fixture,
                "done": str(done),
            }
            job.write_bytes(pickle.dumps(own))
            done.touch()
            self._run(job, done, printed)
            yield from _outcomes(done, printed, len(mutants.found), self)

    def _run(self, job: Path, done: Path, printed: Path) -> None:
        """Run pytest to its end."""
        module = "rttrr_pin.conformance.mutation.suite_run"
        words = [sys.executable, "-m", "pytest", "-p", module, "--rttrr-mutation-job", str(job), *self.arguments]
        words += ["-p", "no:cacheprovider", *(["-n0"] if _has_xdist() else [])]
        paths = [str(Path(__file__).parents[3]), *filter(None, [os.environ.get("PYTHONPATH")])]  # of this very package
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
        with printed.open("wb") as out:
            child = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=out, stderr=out, env=environment)
        try:
            while child.poll() is None:
                time.sleep(POLL)
                if self.progress is not None:
                    self.progress(done.read_bytes().count(b"\n"))
        finally:
            child.kill()
            child.wait()


def _has_xdist() -> bool:
    from importlib.util import find_spec

    return find_spec("xdist") is not None


def _outcomes(done: Path, printed: Path, count: int, suite: PytestSuite) -> list[bool]:
    """What was written of each mutant, behind a line about the run with right dynamics."""
    lines: list[dict[str, Any]] = [json.loads(line) for line in done.read_text().splitlines()]
    if lines and "unknown" in lines[0]:
        raise ImplementationError(
            f"{suite.sentence}: function {suite.function} cannot be imported there: {lines[0]['unknown']}; expected "
            "my_module:my_function, as the tests import it"
        )
    if lines and lines[0].get("calls") == 0:
        what = f"fixture {suite.fixture!r}" if suite.function is None else f"function {suite.function}"
        raise ImplementationError(
            f"{suite.sentence}: no test calls the {what}; name what they call by --function my_module:my_function, or "
            "the fixture that they have it from by --fixture"
        )
    failed = lines[0]["failed"] if lines else []
    if failed:
        raise ImplementationError(
            f"{suite.sentence}: {len(failed)} of its tests fail with right dynamics of this robot in place of yours, "
            f"so that a failure says nothing: leave them out by -k or --deselect\n  {listed(failed, 5, chr(10) + '  ')}"
        )
    if len(lines) != count + 1:
        text = printed.read_text(errors="replace").strip()
        raise ImplementationError(f"{suite.sentence} ended before its time:\n{text[-TAIL:]}")
    return [bool(line["seen"]) for line in lines[1:]]
