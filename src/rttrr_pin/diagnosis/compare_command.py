"""`rttrr-pin compare`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import click

from rttrr_pin.reporting.options import (
    base,
    check_targets,
    flag,
    friction,
    gravity,
    outcome,
    page,
    reading,
    seed,
    xacro,
)
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.validation.options import RunOptions


@click.command
@click.argument("a", help="A bundled robot's name, the path of a URDF or MJCF file, or example:NAME.")
@click.argument("b", help="Another description of the same robot, likewise.")
@click.option("--states", default=500, help="At how many states torques are compared.")
@seed
@gravity
@base
@friction
@xacro
@reading
@outcome
@page
@flag("--full", help="Show every difference, and torques joint by joint.")
def compare(
    a: str,
    b: str,
    states: int,
    json: str | None,
    html: str | None,
    figures: str | None,
    quiet: bool,
    full: bool,
    **run: Any,
) -> int:
    """Compare two descriptions of one robot: what differs, and what of it changes which torque by how much.

    Options of how a file is read go for both.

    Exit code: 0 the same dynamics (limits and names may differ), 1 they differ, 2 unusable input.
    """
    from rttrr_pin.diagnosis.descriptions.compare import compare_robots
    from rttrr_pin.diagnosis.descriptions.compare_report import show_comparison

    options = RunOptions(robot=a, **run)
    other = replace(options, robot=b)
    targets = {"--json": json, "--html": html}
    check_targets(targets, [a, b])
    first, second = (own.load(json, others={"--html": html}) for own in (options, other))
    check_targets(targets, [a, b])
    with progress(None, quiet, "differences") as advance:
        result = compare_robots(first, second, n_states=states, seed=options.seed, progress=advance)
    result = replace(result, robots=(a, b))
    write_json(json, result.to_dict)
    if html is not None or figures is not None:
        from rttrr_pin.diagnosis.pages import write_page

        write_page(html, result, figures, {a: first, b: second} if a != b else {a: first})
    show_comparison(result, Output(quiet=quiet or "-" in (json, html)), full)
    return AGREE if result.passed else DISAGREE
