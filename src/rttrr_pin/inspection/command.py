"""`rttrr-pin inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from rttrr_pin.inspection import run as inspection
from rttrr_pin.inspection.fix import repair
from rttrr_pin.inspection.report import repair_data, repair_summary
from rttrr_pin.loading import load
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, write_json


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
    result = inspection.inspect(load(robot), select=select or (), ignore=ignore or ())
    repaired = None if fix is None else repair(result)
    if fix is not None and repaired is not None:
        write_whole(fix, repaired.text)
    extra = {} if repaired is None else {"repair": repair_data(repaired)}
    write_json(json, lambda: result.to_dict() | extra)
    console = Output(quiet=quiet or json == "-", soft_wrap=True)
    console.print(coloured(result.summary(full, console.width)))
    if repaired is not None:
        console.print(Text(repair_summary(repaired, str(fix))))
    return AGREE if result.passes(strict) else DISAGREE


COLOURS = {
    r"(?m)^(error|FAIL)|(?<=: )refuse\b|\bimpossible\b": "bold red",
    r"(?m)^warning|(?<=: )(either|alter|warn)\b": "yellow",
    r"(?m)^PASS|(?<=: )accept\b": "green",
    r"(?m)^note": "dim",
}
"""Words of the summary."""


def coloured(summary: str) -> Text:
    """The summary with its verdicts in colour."""
    text = Text(summary)
    for words, colour in COLOURS.items():
        text.highlight_regex(words, colour)
    return text
