"""`rttrr-pin validate` and `rttrr-pin state`."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from rttrr_pin.errors import InputError
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, Output, progress, write_json
from rttrr_pin.urdf.sources import EXAMPLE, examples, robots_in
from rttrr_pin.validation import options as o
from rttrr_pin.validation.many import BASES, Task, validate_many
from rttrr_pin.validation.report import many_data, show_many, show_state, show_validation
from rttrr_pin.validation.run import validate as run_validation
from rttrr_pin.validation.state import compare_state

STATES = 10_000
"""Compared unless another number is asked for."""


def validate(
    robot: Annotated[
        str,
        typer.Argument(
            help="A bundled robot's name, the path of a URDF, or example:NAME; several at once: a folder, example:all."
        ),
    ] = "rttrr",
    subject: o.Subject = "kernel",
    reference: o.Reference = None,
    states: Annotated[int, typer.Option(help="How many states to compare; of a table all of its own.")] = STATES,
    seed: o.Seed = 0,
    sampling: o.Sampling = "uniform",
    payload: o.Payload = None,
    payload_link: o.PayloadLink = None,
    payload_axes: o.PayloadAxes = "link",
    gravity: o.Gravity = None,
    base: o.Base = "fixed",
    friction: o.Friction = False,
    json: o.Json = None,
    quiet: o.Quiet = False,
    full: Annotated[bool, typer.Option("--full", help="Show a row for each joint and link.")] = False,
) -> int:
    """Judge one program by another on random states: tau, F, N, f, n at every joint and link.

    Several robots each go through a fixed and a floating base, and those that cannot be compared are listed with what
    in their file stops them.

    Exit code: 0 agree, 1 disagree, 2 unusable input (of several robots, at least one).
    """
    references = tuple(reference or ["pinocchio"])
    options = o.RunOptions(
        robot, subject, references, seed, sampling, payload, payload_link, payload_axes, gravity, base, friction
    )
    several = _several(robot)
    if several:
        return _validate_several(several, options, states, json, quiet, full)
    loaded = options.load()
    with progress(states, quiet) as advance:
        result = run_validation(loaded, n_states=states, sampling=sampling, progress=advance, **options.chosen())
    write_json(json, result.to_dict)
    console = Output(quiet=quiet or json == "-", soft_wrap=False)
    show_validation(result, console, f"{options.command('state')} --index", full)
    return AGREE if result.passed else DISAGREE


def state(
    robot: o.RobotArgument = "rttrr",
    index: Annotated[int, typer.Option(help="Which state: the number that `validate` prints.")] = 0,
    subject: o.Subject = "kernel",
    reference: o.Reference = None,
    seed: o.Seed = 0,
    sampling: o.Sampling = "uniform",
    payload: o.Payload = None,
    payload_link: o.PayloadLink = None,
    payload_axes: o.PayloadAxes = "link",
    gravity: o.Gravity = None,
    base: o.Base = "fixed",
    friction: o.Friction = False,
    json: o.Json = None,
    quiet: o.Quiet = False,
) -> int:
    """Print one of the states of `validate` in full: every number, and who is right by interval arithmetic.

    Exit code: 0 agree, 1 disagree, 2 unusable input.
    """
    options = o.RunOptions(
        robot,
        subject,
        tuple(reference or ["pinocchio"]),
        seed,
        sampling,
        payload,
        payload_link,
        payload_axes,
        gravity,
        base,
        friction,
    )
    report = compare_state(options.load(), index, sampling=sampling, **options.chosen())
    write_json(json, report.to_dict)
    show_state(report, Output(quiet=quiet or json == "-", soft_wrap=False))
    return AGREE if report.passed else DISAGREE


def _several(robot: str) -> dict[str, Path]:
    """The files of `example:all` or of a folder that holds more than one; none where one robot is meant."""
    if not robot.strip():
        return {}
    if robot == f"{EXAMPLE}all":
        return examples()
    files = robots_in(robot) if Path(robot).is_dir() else {}
    return files if len(files) > 1 else {}


def _validate_several(
    sources: dict[str, Path], options: o.RunOptions, states: int, json: str | None, quiet: bool, full: bool
) -> int:
    """One table for many robots."""
    allowed = ("--subject", "--reference", "--seed", "--sampling")
    refused = [word for word in options.unusual() if word.startswith("--") and word not in allowed]
    refused += ["--full"] * full + ["--reference more than once"] * (len(options.reference) > 1)
    if refused:
        raise InputError(f"{', '.join(refused)} goes with one robot, and several are named: name one, or leave it out")
    task = Task(states, options.seed, options.sampling, options.subject, options.reference[0])
    start = time.perf_counter()
    with progress(len(sources) * len(BASES), quiet, "runs") as advance:
        entries = validate_many(sources, task, progress=advance)
    seconds = time.perf_counter() - start
    write_json(json, lambda: many_data(entries, task, seconds))
    show_many(entries, task, seconds, Output(quiet=quiet or json == "-"))
    verdicts = {entry.verdict for entry in entries}
    return DISAGREE if "disagree" in verdicts else UNUSABLE if "unusable" in verdicts else AGREE
