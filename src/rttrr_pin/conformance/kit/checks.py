"""Checks of a program's inverse dynamics, one by one, each with an id: levels, laws, references."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from rttrr_pin.conformance.judging import PRECISIONS, Wanted, judge
from rttrr_pin.conformance.kit.assertions import of_levels, reason
from rttrr_pin.conformance.levels import LEVELS, cases
from rttrr_pin.core.arguments import choice, whole_number
from rttrr_pin.errors import ImplementationError, ModelMismatchError, RefusalError, UnknownNameError
from rttrr_pin.implementations import Implementation, make_implementation
from rttrr_pin.implementations.registry import Source, make_references
from rttrr_pin.laws.law import Law
from rttrr_pin.laws.run import LAWS, check_laws
from rttrr_pin.robot import Robot
from rttrr_pin.validation.run import validate


@dataclass(frozen=True, slots=True)
class Options:
    """How checks are run.

    Attributes:
        n_states: states of each check.
        seed: of the states.
        levels: ids of those that are checked; None for all.
        laws: ids of laws, or their beginnings, such as "E"; None for all that need nothing but a program's results.
        references: programs that are compared with.
        precision: "float64" or "float32", in whose rounding levels are judged; "auto" finds it out.
        diagnose: whether a failure says why.
    """

    n_states: int = 32
    seed: int = 0
    levels: tuple[str, ...] | None = None
    laws: tuple[str, ...] | None = None
    references: tuple[str, ...] = ("pinocchio",)
    precision: Wanted = "auto"
    diagnose: bool = True

    def __post_init__(self) -> None:
        """Check what was passed.

        Raises:
            InputError: a number cannot be used, or there is no such precision.
            UnknownNameError: there is no such level or law.
        """
        whole_number("n_states", self.n_states, 1, 10**6, "10^6", "--rttrr-states")
        whole_number("seed", self.seed, 0, 2**128 - 1, "2^128 - 1", "--rttrr-seed")
        choice("precision", self.precision, "auto", *PRECISIONS, option="--rttrr-precision")
        for own in self.levels or ():
            if own not in [level.id for level in LEVELS]:
                raise UnknownNameError("level", own, [level.id for level in LEVELS])
        for own in self.laws or ():
            if not own or not any(law.id.startswith(own) for law in SUBJECTS):
                raise UnknownNameError("law of a program's results", own, [law.id for law in SUBJECTS])


SUBJECTS = tuple(law for law in LAWS if law.reads)
"""The laws that can be checked on any program."""


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """One check of a program.

    Attributes:
        general_id: such as `rttrr-level-gravity`.
        name: of the robot.
        robot: whose dynamics are checked.
        run: does it; returns why it does not apply, else an empty text.
    """

    general_id: str
    name: str
    robot: Robot = field(repr=False)
    run: Callable[[Source, Implementation], str] = field(repr=False)

    @property
    def id(self) -> str:
        """With the robot's name, such as `rttrr-level-gravity-my_arm`."""
        return f"{self.general_id}-{self.name}"

    def __call__(self, subject: Source) -> None:
        """Run it on a program; the test is skipped where that does not offer what is asked.

        Args:
            subject: all that `validate` takes: a function f(q, v, a) of `robot`, or one of the `Model` that makes it.

        Raises:
            AssertionError: the program is wrong; the message says why.
            ImplementationError: it fails.
        """
        __tracebackhide__ = True
        import pytest

        try:
            left_out = self.run(subject, make_implementation(subject, self.robot.model))
        except RefusalError as error:
            left_out = str(error)
        if left_out:
            pytest.skip(left_out)


def checks(robots: Sequence[Robot] | None, options: Options) -> Iterator[Check]:
    """All checks of some robots: levels that apply, laws, references. None: the robots of the levels."""
    # names alone: the states are drawn when a check is run; where no level is wanted, those of the robots
    asked = cases(robots, options.levels or None, 1, options.seed)
    for case in asked if options.levels != () else ():
        yield _level(case.level.id, case.name, case.robot, options)
    names = {id(case.robot): (case.name, case.robot) for case in asked}
    for name, robot in names.values():
        for law in SUBJECTS:
            if options.laws is None or law.id.startswith(options.laws):
                yield _law(law, name, robot, options)
        for reference in options.references:
            yield _reference(reference, name, robot, options)


def _level(level: str, name: str, robot: Robot, options: Options) -> Check:
    def run(subject: Source, program: Implementation) -> str:
        __tracebackhide__ = True
        [case] = cases([robot], [level], options.n_states, options.seed)
        result = judge(case, program, options.precision)
        if result.failed:
            raise AssertionError(of_levels(subject, program, [(case, result)], (), options.diagnose))
        return result.message if result.outcome == "not offered" else ""

    return Check(f"rttrr-level-{level}", name, robot, run)


def _law(law: Law, name: str, robot: Robot, options: Options) -> Check:
    def run(subject: Source, program: Implementation) -> str:
        __tracebackhide__ = True
        lacking = [key for key in law.reads if key not in program.quantities]
        if lacking:
            return f"{program.name} gives no {', '.join(lacking)}"
        report = check_laws(robot, program, options.n_states, options.seed, payload=None, select=law.id)
        if not report.passed:
            [row] = report.rows
            worst = row.error_over_bound
            line = (
                f"{report.subject} violates the law of {name}: {law.name} ({law.id}) in {row.violations:,} of "
                f"{report.n_states:,} states, by up to {worst.value:.2g} times what rounding explains, in state "
                f"{worst.state}\n{law.statement}"
            )
            raise AssertionError(_with_reason(line, subject, program, robot, options))
        return ""

    return Check(f"rttrr-law-{_words(law.name)}", name, robot, run)


def _words(name: str) -> str:
    """A name as a part of an id."""
    return "-".join(re.findall(r"[a-z]+", name.lower().replace("'", "")))


def _reference(reference: str, name: str, robot: Robot, options: Options) -> Check:
    def run(subject: Source, program: Implementation) -> str:
        __tracebackhide__ = True
        try:
            [other] = make_references(reference, robot.model)
        except UnknownNameError:
            raise
        except ImplementationError as error:
            if isinstance(error, ModelMismatchError):
                return f"{reference} does not take {name} as it is: {error.differences[0]}"
            return str(error)
        report = validate(robot, program, other, options.n_states, options.seed)
        if not report.passed:
            worst = report.worst
            line = (
                f"{report.summary()}\nthe worst is {worst.quantity} at {worst.at} in state "
                f"{worst.of_tolerance.state}, {worst.of_tolerance.value:.2g} times what rounding explains"
            )
            raise AssertionError(_with_reason(line, subject, program, robot, options))
        return ""

    return Check(f"rttrr-reference-{reference}", name, robot, run)


def _with_reason(line: str, subject: Source, program: Implementation, robot: Robot, options: Options) -> str:
    why = reason(subject, program, robot) if options.diagnose else ""
    return f"{line}\n{why}".rstrip()
