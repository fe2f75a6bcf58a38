"""`rttrr-pin search`."""

from __future__ import annotations

from typing import Annotated

import typer

from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.validation import options as o
from rttrr_pin.validation.report import show_search
from rttrr_pin.validation.search import search_worst_state


def search(
    robot: o.RobotArgument = "rttrr",
    subject: o.Subject = "kernel",
    reference: o.Reference = None,
    evaluations: Annotated[int, typer.Option(help="About how many states to look at.")] = 20_000,
    seed: o.Seed = 0,
    payload: o.Payload = None,
    payload_link: o.PayloadLink = None,
    payload_axes: o.PayloadAxes = "link",
    gravity: o.Gravity = None,
    base: o.Base = "fixed",
    friction: o.Friction = False,
    json: o.Json = None,
    quiet: o.Quiet = False,
) -> int:
    """Look for the state at which two programs differ most, instead of waiting for chance.

    Exit code: 0 agree even there, 1 disagree, 2 unusable input.
    """
    options = o.RunOptions(
        robot=robot,
        subject=subject,
        reference=tuple(reference or ["pinocchio"]),
        seed=seed,
        payload=payload,
        payload_link=payload_link,
        payload_axes=payload_axes,
        gravity=gravity,
        base=base,
        friction=friction,
    )
    with progress(evaluations, quiet) as advance:
        worst = search_worst_state(options.load(), evaluations=evaluations, progress=advance, **options.chosen())
    write_json(json, worst.to_dict)
    show_search(worst, Output(quiet=quiet or json == "-", soft_wrap=False))
    return AGREE if worst.passed else DISAGREE
