"""`rttrr-pin conform`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click

from rttrr_pin.conformance.badge import badge as text_of_badge
from rttrr_pin.conformance.badge import kind_of
from rttrr_pin.conformance.judging import PRECISIONS
from rttrr_pin.conformance.junit import junit as text_of_junit
from rttrr_pin.conformance.options import chosen_levels
from rttrr_pin.conformance.options import levels as levels_option
from rttrr_pin.conformance.report import show_conformance
from rttrr_pin.conformance.robots import level_robot, level_robots
from rttrr_pin.conformance.run import conform as run
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import (
    base,
    check_targets,
    flag,
    friction,
    gravity,
    group,
    outcome,
    page,
    reading,
    target,
    xacro,
)
from rttrr_pin.reporting.options import seed as seed_option
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json, write_text
from rttrr_pin.robot import Robot
from rttrr_pin.validation.options import RunOptions, files_of

of_own_robots = group(gravity, base, friction, xacro, reading)
"""How robots of the user's are read."""


@click.command
@click.argument(
    "subject",
    help="The program: kernel, recursion, pinocchio, mujoco, lagrange; my_module:my_function; or a command such as "
    "'./my_id {urdf}', which is told the robot's file.",
)
@click.argument(
    "robots",
    nargs=-1,
    help="Robots to ask it with, as `validate` takes them, or robots of the levels by name; without any, all of those.",
)
@levels_option
@click.option("--states", "-n", default=32, help="States of each level and robot.")
@seed_option
@click.option(
    "--precision",
    default="auto",
    type=click.Choice(["auto", *PRECISIONS]),
    help="Whose rounding it is judged in; auto: float32 where all numbers are of float32.",
)
@flag("--no-diagnose", help="Do not look for the cause of what fails, which takes longest.")
@of_own_robots
@outcome
@target("--junit", "a test for each level and robot in JUnit's XML, for CI servers,")
@page
@click.option("--badge", metavar="FILE", help="Write a badge: .svg, or .json for shields.io; '-' is stdout, as SVG.")
@flag("--full", help="Show the histogram of errors of each quantity.")
def conform(
    subject: str,
    robots: tuple[str, ...],
    levels: tuple[str, ...],
    states: int,
    seed: int,
    precision: Any,
    no_diagnose: bool,
    json: str | None,
    quiet: bool,
    junit: str | None,
    html: str | None,
    figures: str | None,
    badge: str | None,
    full: bool,
    **how: Any,
) -> int:
    """Ask a program graded levels of inverse dynamics, and compare it with proven values: how far does it get?

    Exit code: 0 all that it offers is right, 1 a level failed, 2 unusable input.
    """
    targets = {"--json": json, "--junit": junit, "--html": html, "--badge": badge}
    if badge is not None:
        kind_of(badge)
    sources = [*files_of(subject), *robots]
    check_targets(targets, sources)
    own = _robots(subject, robots, how)
    check_targets(targets, sources)
    chosen = chosen_levels(levels)
    with progress(None, quiet, "cases judged and explained") as advance:
        result = run(subject, own, chosen, states, seed, precision, not no_diagnose, advance)
    write_json(json, result.to_dict)
    write_text(junit, lambda: text_of_junit(result))
    if html is not None or figures is not None:
        from rttrr_pin.conformance.page import conformance_page
        from rttrr_pin.reporting.html import write_page

        write_page(lambda: conformance_page(result), html, figures)
    if badge is not None:
        write_text(badge, lambda: text_of_badge(result, badge))
    show_conformance(result, Output(quiet=quiet or "-" in targets.values()), full)
    return AGREE if result.passed else DISAGREE


def _robots(subject: str, robots: Sequence[str], how: dict[str, Any]) -> list[Robot] | None:
    """The robots that are named, of the levels or of the user's; None where none is."""
    options = RunOptions(subject=subject, **how)
    unusual = [word for word in options.unusual() if word.startswith("--") and word != "--subject"]
    if not robots and unusual:
        raise InputError(f"{unusual[0]} goes with robots of yours, and none is named: rttrr-pin conform SUBJECT ROBOT")
    if not robots:
        return None
    names = level_robots().keys() if not unusual else ()
    return [
        level_robot(name) if name in names else RunOptions(robot=name, subject=subject, **how).load(None)
        for name in robots
    ]
