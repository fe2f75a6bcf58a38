"""`rttrr-pin vectors`."""

from __future__ import annotations

import shlex

import click
from rich.text import Text

from rttrr_pin.conformance.levels import cases
from rttrr_pin.conformance.options import chosen_levels
from rttrr_pin.conformance.options import levels as levels_option
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import (
    base,
    check_targets,
    flag,
    friction,
    gravity,
    outcome,
    package,
    seed,
    xacro,
)
from rttrr_pin.reporting.output import AGREE, Output, progress, write_json
from rttrr_pin.reporting.results import counted
from rttrr_pin.robot import Robot
from rttrr_pin.validation.options import RunOptions


@click.command
@click.argument(
    "robots",
    nargs=-1,
    metavar="[ROBOT]...",
    help="Own robots: the path of a URDF, a bundled robot's name, or example:NAME. Without one, those of the levels.",
)
@click.option("--output", "-o", metavar="FOLDER", help="Where a folder for each robot is written.")
@click.option("--check", metavar="FOLDER", help="Instead of writing: read vectors, and check every file and number.")
@click.option("--states", "-n", default=32, help="How many states of each level and robot.")
@levels_option
@flag("--force", help="Overwrite files that are there.")
@seed
@gravity
@base
@friction
@xacro
@package
@outcome
def vectors(
    robots: tuple[str, ...],
    output: str | None,
    check: str | None,
    states: int,
    levels: tuple[str, ...],
    force: bool,
    seed: int,
    gravity: str | None,
    base: str,
    friction: bool,
    xacro: bool,
    xacro_arg: tuple[str, ...],
    package: tuple[str, ...],
    json: str | None,
    quiet: bool,
) -> int:
    """Write states with proven true values of tau, F, N, f, n, as files that any language reads.

    One folder for each robot: robot.urdf, robot.xml (MJCF proven equal), states.csv, truth.csv, meta.json. Format:
    docs/vectors.md.

    Exit code: 0 written, or as it was written; 2 unusable input, or files that were altered.
    """
    from rttrr_pin.conformance.vectors.vectors import read_vectors, write_vectors

    console = Output(quiet=quiet or json == "-", soft_wrap=True)
    if check is not None and (output is not None or robots):
        other = "-o" if output is not None else robots[0]
        raise InputError(f"--check reads {check} and writes nothing: leave out {other}, or --check")
    if output is None and check is None:
        raise InputError(f"name a folder to write to: {shlex.join(['rttrr-pin', 'vectors', *robots, '-o', 'FOLDER'])}")
    if check is not None:
        check_targets({"--json": json}, [check])
        found = read_vectors(check, chosen_levels(levels))
        counts = {case.id: len(case.batch) for case in found}
        numbers = sum(x.lower.size for case in found for _, x in case.enclosures.items())
        write_json(json, lambda: {"schema": 1, "passed": True, "states": counts, "numbers": numbers})
        total = f"{counted(sum(counts.values()), 'state')}, {numbers:,} proven numbers"
        console.print(Text(f"{check}: as it was written: {', '.join(counts)}; {total}"))
        return AGREE
    assert output is not None
    how = {"gravity": gravity, "base": base, "friction": friction}
    files = {"xacro": xacro, "xacro_arg": xacro_arg, "package": package}
    options = [RunOptions(robot=name, **how, **files) for name in robots]  # type: ignore[arg-type]
    if not robots and (words := RunOptions(**how, **files).unusual()):  # type: ignore[arg-type]
        raise InputError(f"{words[0]} goes with a robot of your own, and none is named: name one, or leave it out")
    own: list[Robot] | None = [one.load(json) for one in options] or None
    check_targets({"--json": json}, [output])
    wanted = chosen_levels(levels)
    total_cases = len(cases(own, wanted, 1, seed))
    with progress(total_cases, quiet, "cases") as advance:
        result = write_vectors(output, own, wanted, states, seed, force, advance)
    write_json(json, result.to_dict)
    console.print(Text(result.summary()))
    console.print(Text(f"check them: {shlex.join(['rttrr-pin', 'vectors', '--check', output])}"))
    return AGREE
