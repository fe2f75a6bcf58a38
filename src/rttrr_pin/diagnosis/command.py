"""`rttrr-pin diagnose`."""

from __future__ import annotations

from typing import Any

import click

from rttrr_pin.diagnosis.report import show_diagnosis
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import flag, outcome, robot, seed
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.robot import Robot
from rttrr_pin.validation.options import RunOptions, conditions, payload


@click.command
@robot()
@click.argument(
    "results", required=False, help="A table of results (.csv, .parquet, .jsonl), or a log with a column time."
)
@click.option(
    "--subject",
    metavar="PROGRAM",
    help="Instead of a table: kernel, recursion, pinocchio, mujoco, lagrange; my_module:my_function; or a program "
    "such as ./my_id.",
)
@click.option("--reference", default="kernel", metavar="PROGRAM", help="What it is compared with, likewise.")
@click.option("--states", default=300, help="How many states a program is asked at; a table has its own.")
@seed
@payload
@conditions
@flag("--full", help="Show every joint and link, and all alternatives.")
@outcome
def diagnose(
    results: str | None, subject: str | None, states: int, full: bool, json: str | None, quiet: bool, **run: Any
) -> int:
    """Name the cause where the results of a program differ: a convention, a number, a term of the recursion.

    Exit code: 0 agrees, 1 differs, 2 unusable input.
    """
    from rttrr_pin.diagnosis.log import is_log
    from rttrr_pin.diagnosis.run import diagnose as find

    if (results is None) == (subject is None):
        raise InputError("name a table of results or a --subject, one of the two: rttrr-pin diagnose ROBOT results.csv")
    chosen = results if subject is None else subject
    assert chosen is not None
    options = RunOptions(**(run | {"subject": chosen, "reference": (run["reference"],)}))
    loaded = options.load(json)
    console = Output(quiet=quiet or json == "-")
    if results is not None and is_log(results, loaded.model):
        return _of_log(loaded, results, console, json)
    what = options.chosen()
    [reference] = what.pop("reference")
    with progress(1000, quiet, "hypotheses") as advance:
        result = find(loaded, **what, reference=reference, n_states=states, progress=advance)
    write_json(json, result.to_dict)
    show_diagnosis(result, console, full)
    return AGREE if result.passed else DISAGREE


def _of_log(robot: Robot, path: str, console: Output, json: str | None) -> int:
    """What a real robot's torques differ by."""
    from rttrr_pin.diagnosis.log_diagnosis import diagnose_log
    from rttrr_pin.diagnosis.log_report import show_log

    report = diagnose_log(robot, path)
    write_json(json, report.to_dict)
    show_log(report, console)
    return AGREE if report.passed else DISAGREE
