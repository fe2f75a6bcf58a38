"""A program's way through the levels."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import count
from typing import TYPE_CHECKING

import numpy as np

from rttrr_pin.conformance.judging import PRECISIONS, Wanted, ask, judged, precision_of, without_numbers
from rttrr_pin.conformance.levels import Case, cases
from rttrr_pin.conformance.results import Conformance, LevelResult
from rttrr_pin.core.arguments import choice
from rttrr_pin.errors import ImplementationError, InputError, RttrrError, shortened
from rttrr_pin.implementations import Evaluation, Implementation, label, make_implementation
from rttrr_pin.implementations.allowance import SINGLE
from rttrr_pin.implementations.function import Function, name_of
from rttrr_pin.implementations.program import Program
from rttrr_pin.implementations.registry import Source, for_one_robot, is_table
from rttrr_pin.robot import Robot
from rttrr_pin.validation.run import versions

if TYPE_CHECKING:
    from rttrr_pin.core.arrays import Array
    from rttrr_pin.implementations.allowance import Precision

Progress = Callable[[int], None]

Answer = Evaluation | LevelResult
"""Numbers, or an outcome without any."""


def conform(
    subject: Source,
    robots: Sequence[Robot] | None = None,
    levels: Sequence[str] | None = None,
    n_states: int = 32,
    seed: int = 0,
    precision: Wanted = "auto",
    diagnose: bool = True,
    progress: Progress | None = None,
) -> Conformance:
    """Find out how far a program gets through the levels (`LEVELS`).

    Args:
        subject: the program: all that `validate` takes but a table, which has states of its own. To be asked with
            several robots it must be told which: a class or a function of one argument, the `Model`, that makes a
            function f(q, v, a) or an `Implementation`; or a command with `{urdf}` in it (`program.PLACES`).
        robots: own robots, each asked the levels that apply to it; None for the robots of the levels.
        levels: ids of those that are wanted; None for all.
        n_states: states of each case.
        seed: of the states.
        precision: "float64" or "float32", in whose rounding it is judged; "auto" finds it out from its numbers.
        diagnose: whether to say why a level fails.
        progress: called with the number of cases judged, and explained, so far.

    Returns:
        The outcome of each case, and the level reached.

    Raises:
        InputError: an argument cannot be used, or the program is made for one robot and several are asked.
        UnknownNameError: there is no such program, or no such level.
        ImplementationError: it can be made for none of the robots, or offers none of the levels.
    """
    begin = time.perf_counter()
    choice("precision", precision, "auto", *PRECISIONS)
    _check_lists(robots, levels)
    _check_subject(subject, robots)
    asked = cases(robots, levels, n_states, seed)
    programs = _programs(subject, asked, precision)
    answers = _answers(asked, programs)
    numbers = [own.values for own in answers if isinstance(own, Evaluation)]
    _check_offered(asked, programs, answers)
    own = _precision(precision, list(programs.values()), numbers)
    results = []
    for case, answer in zip(asked, answers, strict=True):
        results.append(_judged(case, programs[id(case.robot)], answer, own))
        if progress is not None:
            progress(len(results))
    if diagnose:
        results = _explained(asked, programs, results, own, progress)
    made = [one for one in programs.values() if isinstance(one, Implementation)]
    return Conformance(
        subject=_label(subject, made[0]),
        results=tuple(results),
        precision=own.name,
        printed=min((one.digits for one in made if isinstance(one, Program) and one.digits), default=None),
        own_robots=robots is not None,
        n_states=len(asked[0].batch),
        seed=int(seed),
        notes=tuple(dict.fromkeys(note for one in made for note in getattr(one, "notes", ()))),
        seconds=time.perf_counter() - begin,
        versions=versions(made[:1]),
    )


def _check_lists(robots: object, levels: object) -> None:
    """Robots and ids come in lists."""
    for name, value, kind in (("robots", robots, Robot), ("levels", levels, str)):
        if value is None:
            continue
        several = isinstance(value, list | tuple) and len(value) > 0
        if not several or not all(isinstance(one, kind) for one in value):  # type: ignore[attr-defined]
            raise InputError(f"{name} is {shortened(repr(value))}: pass a list of {kind.__name__}, or None for all")


def _check_subject(subject: Source, robots: Sequence[Robot] | None) -> None:
    """What cannot be asked states of ours, or not with several robots."""
    if is_table(subject):
        raise InputError(
            f"{subject} is a table, with states of its own, and levels have theirs: "
            "name a program or a function, or ask `validate` and `diagnose` about the table"
        )
    if for_one_robot(subject) and (robots is None or len(robots) != 1):
        what = f"{len(robots)} are named" if robots is not None else "levels have several"
        call = f"conform({_named(subject)}, [robot])"
        raise InputError(
            f"{_named(subject)} is made for one robot, and {what}: name the robot, {call}, or a program that is told "
            "which: a function of the model, or a command with {urdf} in it",
            {call: "rttrr-pin conform SUBJECT ROBOT"},
        )


def _named(subject: Source) -> str:
    return name_of(subject) if callable(subject) else str(subject)


def _programs(subject: Source, asked: Sequence[Case], precision: Wanted) -> dict[int, Implementation | RttrrError]:
    """The program, made for each robot; or why it cannot be."""
    made: dict[int, Implementation | RttrrError] = {}
    for case in asked:
        if id(case.robot) not in made:
            try:
                program = make_implementation(subject, case.robot.model)
                if isinstance(program, Program):
                    program.rest()
                if isinstance(program, Function) and (precision != "auto" or program.type != np.float32):
                    program.type, program.notes = np.dtype(np.float64), ()  # judged as is wanted, whatever it returns
                made[id(case.robot)] = program
            except RttrrError as error:
                made[id(case.robot)] = error
    errors = [own for own in made.values() if isinstance(own, RttrrError)]
    if len(errors) == len(made):
        raise errors[0]
    return made


def _answers(asked: Sequence[Case], programs: dict[int, Implementation | RttrrError]) -> list[Answer]:
    """What is said of each case, robot by robot, so that of a command's programs one runs at a time."""
    found: dict[int, Answer] = {}
    for robot, program in programs.items():
        for k, case in enumerate(asked):
            if id(case.robot) == robot:
                found[k] = _answer(case, program)
        if isinstance(program, Program):
            program.rest()
    return [found[k] for k in range(len(asked))]


def _precision(
    wanted: Wanted, programs: Sequence[Implementation | RttrrError], numbers: Sequence[Mapping[str, Array]]
) -> Precision:
    """That which is wanted; else that of a function's arrays, or what the numbers look like."""
    if wanted != "auto":
        return PRECISIONS[wanted]
    types = [one.type for one in programs if isinstance(one, Function)]
    return SINGLE if types and all(own == np.float32 for own in types) else precision_of(numbers)


def _answer(case: Case, program: Implementation | RttrrError) -> Answer:
    return without_numbers(case, program) if isinstance(program, RttrrError) else ask(case, program)


def _check_offered(
    asked: Sequence[Case], programs: dict[int, Implementation | RttrrError], answers: Sequence[Answer]
) -> None:
    """A program that refuses all is no judged one."""
    refused = [own for own in answers if isinstance(own, LevelResult) and own.outcome == "not offered"]
    if len(refused) == len(asked):
        raise ImplementationError(f"none of what was asked is offered; {refused[0].id}: {refused[0].message}")


def _judged(case: Case, program: Implementation | RttrrError, answer: Answer, precision: Precision) -> LevelResult:
    if isinstance(answer, LevelResult) or isinstance(program, RttrrError):
        assert isinstance(answer, LevelResult)
        return answer
    return judged(case, program, answer, precision)


def _explained(
    asked: Sequence[Case],
    programs: dict[int, Implementation | RttrrError],
    results: list[LevelResult],
    precision: Precision,
    progress: Progress | None,
) -> list[LevelResult]:
    """The outcomes, with the cause where numbers failed."""
    failing = {}
    for k, (case, result) in enumerate(zip(asked, results, strict=True)):
        program = programs[id(case.robot)]
        if result.outcome == "fail" and not isinstance(program, RttrrError):
            failing[k] = (case, program, result)
    if not failing:
        return results
    from rttrr_pin.conformance.causes import with_causes  # a thousand hypotheses, which a program that passes needs not

    steps = count(len(results) + 1)
    advance = None if progress is None else lambda: progress(next(steps))
    found = dict(zip(failing, with_causes(list(failing.values()), precision, advance), strict=True))
    return [found.get(k, result) for k, result in enumerate(results)]


def _label(subject: Source, program: Implementation) -> str:
    """Name and version; of a command as it was typed."""
    return label(program) if not isinstance(subject, str | os.PathLike) or program.version else str(subject)
