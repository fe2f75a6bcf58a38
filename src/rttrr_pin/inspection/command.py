"""`rttrr-pin inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rttrr_pin.inspection.fix import repair
from rttrr_pin.inspection.report import inspection_data, repair_data, show_inspection, show_repair
from rttrr_pin.loading import load
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, write_json
from rttrr_pin.urdf.sources import EXAMPLE, bundled, examples, find


def inspect(
    robot: Annotated[
        str, typer.Argument(help="A bundled robot's name, the path of a URDF, or example:NAME.")
    ] = "rttrr",
    select: Annotated[
        list[str] | None, typer.Option(help="Only checks whose ids begin so, such as P or G201; repeatable.")
    ] = None,
    ignore: Annotated[list[str] | None, typer.Option(help="Leave out checks whose ids begin so; repeatable.")] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Warnings count as errors for the exit code.")] = False,
    fix: Annotated[
        Path | None, typer.Option(help="Write the file with the repairs that are certain; the rest stays as it is.")
    ] = None,
    json: Annotated[str | None, typer.Option(help="Write the outcome as JSON to this file; '-' is stdout.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Show every link and every finding.")] = False,
) -> int:
    """Look at a robot's file: its bodies, what is impossible or implausible, what other programs do with it.

    Exit code: 0 no errors, 1 errors (with --strict also warnings), 2 unusable input.
    """
    result = load(robot).inspect(_folder(robot), select or (), ignore or ())
    repaired = None if fix is None else repair(result)
    if fix is not None and repaired is not None:
        write_whole(fix, repaired.text)
    extra = {} if repaired is None else {"repair": repair_data(repaired)}
    write_json(json, lambda: inspection_data(result) | extra)
    console = Output(quiet=quiet or json == "-", soft_wrap=False)
    show_inspection(result, console, full)
    if repaired is not None:
        show_repair(repaired, str(fix), console)
    return AGREE if result.passes(strict) else DISAGREE


def _folder(robot: str) -> Path | None:
    """Where the file of a robot lies, whose meshes are looked for from there; None for a text."""
    if robot.startswith(EXAMPLE):
        place = examples().get(robot.removeprefix(EXAMPLE))
        return None if place is None else place.parent
    if robot in bundled():
        return bundled()[robot].parent
    path = Path(find(robot).name.removesuffix(" (as xacro expands it)"))
    return path.absolute().parent if path.is_file() else None
