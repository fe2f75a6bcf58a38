"""`rttrr-pin laws`."""

from __future__ import annotations

from typing import Any

import click

from rttrr_pin.laws.report import show_laws
from rttrr_pin.laws.run import check_laws
from rttrr_pin.reporting.options import outcome, page, robot, seed
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.validation.options import RunOptions, conditions, sampling


@click.command
@robot()
@click.option(
    "--subject",
    default="recursion",
    metavar="PROGRAM",
    help="The program that is checked. Of the recursion all laws are; of any other (see validate) the balances of "
    "power, forces and moments.",
)
@click.option("--states", default=1000, help="How many states.")
@click.option("--select", multiple=True, metavar="ID", help="Laws by id or its beginning, such as M. Repeats.")
@seed
@sampling
@click.option("--payload", default="random", help="What the robot exerts: random, none, or fx,fy,fz,nx,ny,nz [N, N m].")
@conditions
@outcome
@page
def laws(
    states: int,
    select: tuple[str, ...],
    payload: str,
    json: str | None,
    html: str | None,
    figures: str | None,
    quiet: bool,
    **run: Any,
) -> int:
    """Check power balance, momentum, action and reaction, symmetry, linearity and invariance, without another program.

    Exit code: 0 all laws hold, 1 some are violated, 2 unusable input.
    """
    options = RunOptions(**run, payload=None if payload == "none" else payload)
    robot = options.load(json, others={"--html": html})
    what = options.chosen()
    del what["reference"]
    with progress(states, quiet) as advance:
        report = check_laws(robot, n_states=states, sampling=options.sampling, select=select, progress=advance, **what)
    write_json(json, report.to_dict)
    if html is not None or figures is not None:
        from rttrr_pin.laws.page import laws_page
        from rttrr_pin.reporting.html import write_page

        write_page(lambda: laws_page(report, robot), html, figures)
    show_laws(report, Output(quiet=quiet or "-" in (json, html)))
    return AGREE if report.passed else DISAGREE
