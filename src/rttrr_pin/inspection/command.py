"""`rttrr-pin inspect`."""

from __future__ import annotations

import codecs
from pathlib import Path

import click
from rich.text import Text

from rttrr_pin.errors import InputError
from rttrr_pin.inspection import many
from rttrr_pin.inspection.many import Demands, Entry, inspect_each
from rttrr_pin.inspection.parsers import PARSERS
from rttrr_pin.inspection.report import repair_data, repair_summary
from rttrr_pin.inspection.run import Inspection, chosen, inspect_document, repair
from rttrr_pin.reporting.options import (
    check_targets,
    flag,
    outcome,
    package,
    packages_of,
    page,
    robot,
    target,
    xacro,
    xacro_arguments,
)
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, Output, progress, write_json, write_text
from rttrr_pin.urdf.catalogue import one_or_several
from rttrr_pin.urdf.files import forget_reads
from rttrr_pin.urdf.packages import named_packages
from rttrr_pin.urdf.parser import read_document
from rttrr_pin.urdf.reader import model_of
from rttrr_pin.urdf.sources import Reading, Source, find


@click.command
@robot("A bundled robot's name, the path of a URDF, or example:NAME; several at once: a folder, example:all.")
@click.option(
    "--select", multiple=True, metavar="ID", help="Only checks whose ids begin so, such as P or G201. Repeats."
)
@click.option("--ignore", multiple=True, metavar="ID", help="Leave out checks whose ids begin so. Repeats.")
@flag("--strict", help="Warnings count as errors for the exit code.")
@package
@click.option(
    "--fail-on",
    multiple=True,
    type=click.Choice(PARSERS, case_sensitive=False),
    help="Fail also where this parser does not load the robot as written. Repeats.",
)
@target("--fix", "the file with the repairs that are certain, the rest as it is,")
@xacro
@target("--sarif", "the findings as SARIF 2.1.0, for code hosts,")
@target("--junit", "each check as a test in JUnit's XML, for CI servers,")
@outcome
@page
@flag("--full", help="Show every link and every finding.")
def inspect(
    robot: str,
    select: tuple[str, ...],
    ignore: tuple[str, ...],
    strict: bool,
    package: tuple[str, ...],
    fail_on: tuple[str, ...],
    fix: str | None,
    xacro: bool,
    xacro_arg: tuple[str, ...],
    sarif: str | None,
    junit: str | None,
    json: str | None,
    html: str | None,
    figures: str | None,
    quiet: bool,
    full: bool,
) -> int:
    """Look at a robot's file: its bodies, what is impossible or implausible, what other programs do with it.

    Exit code: 0 no errors, 1 errors (with --strict also warnings, with --fail-on what a parser does), 2 unusable
    input.
    """
    (robot, robots), demands = one_or_several(robot), Demands(strict, fail_on)
    reports = {"--json": json, "--sarif": sarif, "--junit": junit, "--html": html}
    check_targets(reports, robots.values() or [robot])
    check_targets(reports | {"--fix": fix})
    chosen(select, ignore)  # that there are such checks, before the first of many files is read
    console = Output(quiet=quiet or "-" in (*reports.values(), fix), soft_wrap=True)
    reading = Reading(xacro, xacro_arguments(xacro_arg), packages=named_packages(packages_of(package)))

    def look(source: Path | Source) -> Inspection:
        document = read_document(source, reading, tolerant=True)
        model_of(document)  # as `load` does: it refuses numbers that overflow
        return inspect_document(document, select=select, ignore=ignore)

    if robots:
        if fix is not None or full or figures is not None:
            raise InputError(
                "--fix, --full and --figures go with one robot, and several are named: name one, or leave them out"
            )
        entries = []
        with progress(len(robots), quiet, "robots") as advance:
            for entry in inspect_each(robots, look):
                entries.append(entry)
                advance(len(entries))
        check_targets(reports)
        write_json(json, lambda: many.to_dict(entries, demands))
        console.print(coloured(many.summary(entries, demands, console.width)))
    else:
        source = find(robot, reading)
        check_targets(reports)
        forget_reads()  # the file itself may be repaired in its place; its meshes may not
        result = look(source)
        check_targets(reports | {"--fix": fix})
        repaired = None if fix is None else repair(result)
        if repaired is not None:
            text = ("\ufeff" if source.text.startswith(codecs.BOM_UTF8) else "") + repaired.text
            write_text(fix, lambda: text)
        extra = {} if repaired is None else {"repair": repair_data(repaired)}
        write_json(json, lambda: result.to_dict() | extra)
        console.print(coloured(result.summary(full, console.width)))
        for parser in demands.failing(result):
            console.print(coloured(f"FAIL {parser} does not load the robot as written"))
        if repaired is not None:
            console.print(Text(repair_summary(repaired, str(fix))))
        entries = [Entry(result.robot, Path(robot), result)]
    if html is not None or figures is not None:
        from rttrr_pin.inspection.page import inspection_page, many_page
        from rttrr_pin.reporting.html import write_page

        write_page(
            lambda: many_page(entries, demands) if robots else inspection_page(result, demands, robot), html, figures
        )
    write_json(sarif, lambda: many.sarif(entries, demands))
    write_text(junit, lambda: many.junit(entries, demands))
    verdicts = {entry.verdict(demands) for entry in entries}
    return DISAGREE if "FAIL" in verdicts else UNUSABLE if "FILE" in verdicts else AGREE


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
