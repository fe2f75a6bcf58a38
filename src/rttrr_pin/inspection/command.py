"""`rttrr-pin inspect`."""

from __future__ import annotations

from pathlib import Path

import click
from rich.text import Text

from rttrr_pin.inspection.report import repair_data, repair_summary
from rttrr_pin.inspection.run import inspect_document, repair
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.options import check_targets, flag, outcome, robot
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, write_json
from rttrr_pin.urdf.parser import read_document
from rttrr_pin.urdf.reader import model_of


@click.command
@robot()
@click.option(
    "--select", multiple=True, metavar="ID", help="Only checks whose ids begin so, such as P or G201. Repeats."
)
@click.option("--ignore", multiple=True, metavar="ID", help="Leave out checks whose ids begin so. Repeats.")
@flag("--strict", help="Warnings count as errors for the exit code.")
@click.option(
    "--fix",
    type=click.Path(path_type=Path),
    help="Write the file with the repairs that are certain; the rest stays as it is.",
)
@outcome
@flag("--full", help="Show every link and every finding.")
def inspect(
    robot: str,
    select: tuple[str, ...],
    ignore: tuple[str, ...],
    strict: bool,
    fix: Path | None,
    json: str | None,
    quiet: bool,
    full: bool,
) -> int:
    """Look at a robot's file: its bodies, what is impossible or implausible, what other programs do with it.

    Exit code: 0 no errors, 1 errors (with --strict also warnings), 2 unusable input.
    """
    check_targets({"--json": json}, [robot])
    check_targets({"--json": json, "--fix": fix})
    document = read_document(robot)
    model_of(document)  # as `load` does: it refuses numbers that overflow
    result = inspect_document(document, select=select, ignore=ignore)
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
