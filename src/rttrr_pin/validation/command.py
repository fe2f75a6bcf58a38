"""`rttrr-pin validate`, `rttrr-pin state` and `rttrr-pin search`."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.text import Text

from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import flag, outcome, page, robot, seed
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, Output, progress, write_json
from rttrr_pin.reporting.results import counted, finite
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.catalogue import one_or_several
from rttrr_pin.validation.options import RunOptions, conditions, drawn, payload, programs

if TYPE_CHECKING:
    from rttrr_pin.validation.run import Validation

STATES = 10_000
"""Compared unless another number is asked for."""


@click.command
@robot("A bundled robot's name, the path of a URDF, or example:NAME; several at once: a folder, example:all.")
@programs
@click.option("--states", default=STATES, help="How many states to compare; of a table all of its own.")
@drawn
@outcome
@page
@flag("--full", help="Show a row for each joint and link.")
def validate(
    states: int, json: str | None, html: str | None, figures: str | None, quiet: bool, full: bool, **run: Any
) -> int:
    """Judge one program by another on random states: tau, F, N, f, n at every joint and link.

    Several robots each go through a fixed and a floating base, and those that cannot be compared are listed with what
    in their file stops them.

    Exit code: 0 agree, 1 disagree, 2 unusable input (of several robots, at least one).
    """
    from rttrr_pin.validation import run as comparing
    from rttrr_pin.validation.report import show_validation

    run["robot"], robots = one_or_several(run["robot"])
    options = RunOptions(**run)
    if robots:
        options.check_targets({"--json": json, "--html": html}, robots.values())
        return _validate_several(robots, options, states, json, html, figures, quiet, full)
    loaded = options.load(json, others={"--html": html})
    with progress(states, quiet) as advance:
        result = comparing.validate(
            loaded, n_states=states, sampling=options.sampling, progress=advance, **options.chosen()
        )
    result = replace(result, notes=(*result.notes, *_faults(loaded, options)))
    write_json(json, result.to_dict)
    why = None if result.passed else options.diagnosis(_failed(result))
    if html is not None or figures is not None:
        _write_page(loaded, result, options, why, html, figures)
    console = Output(quiet=quiet or "-" in (json, html), soft_wrap=False)
    show_validation(result, console, f"{options.command('state')} --index", full)
    if why is not None:
        console.print(Text(f"why: {why}"), soft_wrap=True)
    return AGREE if result.passed else DISAGREE


@click.command
@robot()
@click.option("--index", default=0, help="Which state: the number that `validate` prints.")
@click.option("--convention", help="Show also what crosses each joint as another program says it, such as mujoco.")
@programs
@drawn
@outcome
def state(index: int, convention: str | None, json: str | None, quiet: bool, **run: Any) -> int:
    """Print one of the states of `validate` in full: every number, and who is right by interval arithmetic.

    Exit code: 0 agree, 1 disagree, 2 unusable input.
    """
    from rttrr_pin.validation.report import show_state
    from rttrr_pin.validation.state import compare_state
    from rttrr_pin.validation.wrenches import show_wrenches, wrenches_of

    options = RunOptions(**run)
    report = compare_state(options.load(json), index, sampling=options.sampling, **options.chosen())
    wrenches = None if convention is None else wrenches_of(report, convention)
    write_json(json, lambda: report.to_dict() | (finite({"wrenches": wrenches.to_dict()}) if wrenches else {}))
    console = Output(quiet=quiet or json == "-", soft_wrap=False)
    show_state(report, console)
    if wrenches is not None:
        show_wrenches(wrenches, console)
    return AGREE if report.passed else DISAGREE


@click.command
@robot()
@programs
@click.option("--evaluations", default=20_000, help="About how many states to look at.")
@seed
@payload
@conditions
@outcome
def search(evaluations: int, json: str | None, quiet: bool, **run: Any) -> int:
    """Look for the state at which two programs differ most, instead of waiting for chance.

    Exit code: 0 agree even there, 1 disagree, 2 unusable input.
    """
    from rttrr_pin.validation.report import show_search
    from rttrr_pin.validation.search import search_worst_state

    options = RunOptions(**run)
    robot = options.load(json)
    with progress(evaluations, quiet) as advance:
        worst = search_worst_state(robot, evaluations=evaluations, progress=advance, **options.chosen())
    write_json(json, worst.to_dict)
    show_search(worst, Output(quiet=quiet or json == "-", soft_wrap=False))
    return AGREE if worst.passed else DISAGREE


def _failed(result: Validation) -> int:
    """The number of the first reference that the subject differs from."""
    return next(k for k, one in enumerate(result.references) if not one.passed)


def _write_page(
    robot: Robot, result: Validation, options: RunOptions, why: str | None, html: str | None, figures: str | None
) -> None:
    """The page, with the worst state in full."""
    from rttrr_pin.reporting.html import write_page
    from rttrr_pin.validation.page import validation_page
    from rttrr_pin.validation.state import compare_state

    index = result.worst.of_tolerance.state
    worst = compare_state(robot, index, sampling=options.sampling, **options.chosen())
    commands = (f"{options.command('state')} --index {index}", *([] if why is None else [why]))
    write_page(lambda: validation_page(result, robot, worst, commands), html, figures)


def _faults(robot: Robot, options: RunOptions) -> list[str]:
    """That both programs compute what the file says does not mean that the file says what a body can be."""
    from rttrr_pin.inspection.telling import count_errors

    errors = count_errors(robot.model.document)
    look = options.command("inspect", ("xacro", "xacro_arg", "package"))
    return [f"inspect finds {counted(errors, 'error')} in this file: {look}"] if errors else []


def _validate_several(
    sources: dict[str, Path],
    options: RunOptions,
    states: int,
    json: str | None,
    html: str | None,
    figures: str | None,
    quiet: bool,
    full: bool,
) -> int:
    """One table for many robots."""
    from rttrr_pin.validation.many import BASES, Task, many_data, validate_many
    from rttrr_pin.validation.report_many import show_many

    own = ("--subject", "--reference", "--seed", "--sampling")
    allowed = (*own, "--xacro", "--xacro-arg", "--lenient", "--no-mimic", "--package")
    refused = [word for word in options.unusual() if word.startswith("--") and word not in allowed]
    refused += (
        ["--full"] * full
        + ["--figures"] * (figures is not None)
        + ["--reference more than once"] * (len(options.reference) > 1)
    )
    if refused:
        raise InputError(f"{', '.join(refused)} goes with one robot, and several are named: name one, or leave it out")
    task = Task(states, options.seed, options.sampling, options.subject, options.reference[0], **options.reading())
    start = time.perf_counter()
    with progress(len(sources) * len(BASES), quiet, "runs") as advance:
        entries = validate_many(sources, task, progress=advance)
    seconds = time.perf_counter() - start
    write_json(json, lambda: many_data(entries, task, seconds))
    if html is not None:
        from rttrr_pin.reporting.html import write_page
        from rttrr_pin.validation.page_many import many_page

        write_page(lambda: many_page(entries, task, seconds), html)
    show_many(entries, task, seconds, Output(quiet=quiet or "-" in (json, html)))
    verdicts = {entry.verdict for entry in entries}
    return DISAGREE if "disagree" in verdicts else UNUSABLE if "unusable" in verdicts else AGREE
