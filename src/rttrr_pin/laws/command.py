"""`rttrr-pin laws`."""

from __future__ import annotations

from typing import Annotated

import typer

from rttrr_pin.laws.report import show_laws
from rttrr_pin.laws.run import check_laws
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.validation import options as o


def laws(
    robot: o.RobotArgument = "rttrr",
    subject: Annotated[
        str,
        typer.Option(
            help="The program that is checked. Of the recursion all laws are; of any other (see validate) the balances "
            "of power, forces and moments."
        ),
    ] = "recursion",
    states: Annotated[int, typer.Option(help="How many states.")] = 1000,
    select: Annotated[list[str] | None, typer.Option(help="Laws by id or its beginning, such as M. Repeats.")] = None,
    seed: o.Seed = 0,
    sampling: o.Sampling = "uniform",
    payload: Annotated[
        str,
        typer.Option(help="What the robot exerts: random, none, or fx,fy,fz,nx,ny,nz [N, N m]."),
    ] = "random",
    payload_link: o.PayloadLink = None,
    payload_axes: o.PayloadAxes = "link",
    gravity: o.Gravity = None,
    base: o.Base = "fixed",
    friction: o.Friction = False,
    json: o.Json = None,
    quiet: o.Quiet = False,
) -> int:
    """Check power balance, momentum, action and reaction, symmetry, linearity and invariance, without another program.

    Exit code: 0 all laws hold, 1 some are violated, 2 unusable input.
    """
    options = o.RunOptions(
        robot=robot,
        subject=subject,
        seed=seed,
        sampling=sampling,
        payload=None if payload == "none" else payload,
        payload_link=payload_link,
        payload_axes=payload_axes,
        gravity=gravity,
        base=base,
        friction=friction,
    )
    what = {key: value for key, value in options.chosen().items() if key != "reference"}
    with progress(states, quiet) as advance:
        report = check_laws(
            options.load(), n_states=states, sampling=sampling, select=select or (), progress=advance, **what
        )
    write_json(json, report.to_dict)
    show_laws(report, Output(quiet=quiet or json == "-"))
    return AGREE if report.passed else DISAGREE
