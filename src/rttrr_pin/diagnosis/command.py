"""`rttrr-pin diagnose`."""

from __future__ import annotations

import shlex
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import flag, outcome, page, robot, seed
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.robot import Robot
from rttrr_pin.validation.options import RunOptions, conditions, payload

if TYPE_CHECKING:
    from rttrr_pin.diagnosis.logs.log_diagnosis import LogDiagnosis
    from rttrr_pin.diagnosis.results import Diagnosis


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
@page
def diagnose(
    results: str | None,
    subject: str | None,
    states: int,
    full: bool,
    json: str | None,
    html: str | None,
    figures: str | None,
    quiet: bool,
    **run: Any,
) -> int:
    """Name the cause where the results of a program differ: a convention, a number, a term of the recursion.

    Exit code: 0 agrees, 1 differs, 2 unusable input.
    """
    from rttrr_pin.diagnosis.logs.log import is_log
    from rttrr_pin.implementations.table_files import READERS

    if Path(run["robot"]).suffix.lower() in READERS:
        right = shlex.join(["rttrr-pin", "diagnose", results or "ROBOT", run["robot"]])
        raise InputError(f"{run['robot']} is a table, and the robot comes first: {right}")
    if (results is None) == (subject is None):
        raise InputError("name a table of results or a --subject, one of the two: rttrr-pin diagnose ROBOT results.csv")
    chosen = subject if results is None else results
    options = RunOptions(**(run | {"subject": chosen, "reference": (run["reference"],)}))
    whole_number("--states", states, 1, 10**6, "10^6")
    loaded = options.load(json, others={"--html": html})
    console = Output(quiet=quiet or "-" in (json, html))
    result: Diagnosis | LogDiagnosis
    if results is not None and is_log(results, loaded.model):
        from rttrr_pin.diagnosis.logs.log_diagnosis import diagnose_log
        from rttrr_pin.diagnosis.logs.log_report import show_log

        if options.payload is not None:
            raise InputError(f"{results} is a log, and takes no --payload: what the robot carried is looked for in it")
        result = log = diagnose_log(loaded, results)
        show = partial(show_log, log, console)
    else:
        from rttrr_pin.diagnosis.report import show_diagnosis

        result = found = _find(loaded, options, states, quiet)
        show = partial(show_diagnosis, found, console, full)
    write_json(json, result.to_dict)
    if html is not None or figures is not None:
        from rttrr_pin.diagnosis.pages import write_page

        write_page(html, result, figures, {loaded.name: loaded})
    show()
    return AGREE if result.passed else DISAGREE


def _find(robot: Robot, options: RunOptions, states: int, quiet: bool) -> Diagnosis:
    """Why a program's results differ."""
    from rttrr_pin.diagnosis.run import diagnose as find

    what = options.chosen()
    [reference] = what.pop("reference")
    with progress(None, quiet, "hypotheses") as advance:
        return find(robot, **what, reference=reference, n_states=states, progress=advance)
