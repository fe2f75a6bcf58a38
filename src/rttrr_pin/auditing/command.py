"""`rttrr-pin audit`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import click

from rttrr_pin.auditing import Publication, Verdict, read_publication
from rttrr_pin.auditing import audit as run_audit
from rttrr_pin.auditing.errata import errata
from rttrr_pin.auditing.report import show_audit, show_equations
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import check_targets, page, quiet, reading, reading_of, target, xacro
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, Output, progress, write_json, write_text


@click.command
@click.argument(
    "file",
    required=False,
    type=click.Path(path_type=Path),
    help="Equations as TOML or YAML; without it, those of the paper on the RTTRR arm.",
)
@click.option("--equation", multiple=True, metavar="NUMBER", help="Only the equation of this number, in full. Repeats.")
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, help="Of the random state at which numbers are compared."
)
@xacro
@reading
@target("--json", "the outcome as JSON")
@target("--latex", "an errata sheet as LaTeX")
@page
@target("--markdown", "an errata sheet as Markdown")
@quiet
def audit(
    file: Path | None,
    equation: tuple[str, ...],
    seed: int,
    json: str | None,
    latex: str | None,
    html: str | None,
    figures: str | None,
    markdown: str | None,
    quiet: bool,
    **how: Any,
) -> int:
    """Compare published equations of motion with the Newton-Euler recursion, term by term.

    Exit code: 0 all right, 1 findings or unreadable equations, 2 unusable input, such as undeclared symbols alone.
    """
    sheets = {"latex": latex, "markdown": markdown}
    targets = {"--json": json, "--latex": latex, "--html": html, "--markdown": markdown}
    check_targets(targets, [] if file is None else [file])
    publication = read_publication() if file is None else read_publication(file, **reading_of(**how))
    check_targets(targets)  # nor what the file names
    if equation:
        publication = _only(publication, equation)
    with progress(len(publication.equations), quiet, "equations") as advance:
        result = run_audit(publication, seed, advance)
    texts = {form: errata(result, form) for form, where in sheets.items() if where is not None}
    write_json(json, result.to_dict)
    for form, text in texts.items():  # all are ready before the first is written
        write_text(sheets[form], partial(str, text))
    if html is not None or figures is not None:
        from rttrr_pin.auditing.page import audit_page
        from rttrr_pin.reporting.html import write_page

        write_page(lambda: audit_page(result), html, figures)
    console = Output(quiet=quiet or "-" in targets.values(), soft_wrap=False, highlight=False)
    if equation:
        show_equations(result, console)
    else:
        show_audit(result, console, "" if file is None else str(file))
    if result.passed:
        return AGREE
    only_undeclared = not result.count(Verdict.DIFFERS) and not result.count(Verdict.UNPARSED)
    return UNUSABLE if only_undeclared else DISAGREE


def _only(publication: Publication, numbers: Sequence[str]) -> Publication:
    """The publication with the equations asked for, in printed order."""
    wanted = [number.strip().removeprefix("(").removesuffix(")") for number in numbers]
    known = [str(equation.number) for equation in publication.equations]
    for number in wanted:
        if number not in known:
            raise InputError(f"there is no equation ({number}): there are {_ranges(known)}")
    chosen = tuple(equation for equation in publication.equations if str(equation.number) in wanted)
    if any(equation.quantity == "C" for equation in chosen):  # its rows are judged as a whole
        chosen = tuple(x for x in publication.equations if x in chosen or x.quantity == "C")
    return replace(publication, equations=chosen)


def _ranges(numbers: Sequence[str]) -> str:
    """Numbers in short: 1 to 43."""
    runs: list[list[str]] = []
    for number in dict.fromkeys(numbers):
        follows = (
            bool(runs) and number.isdecimal() and runs[-1][-1].isdecimal() and int(number) == int(runs[-1][-1]) + 1
        )
        if follows:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(run[0] if len(run) == 1 else f"{run[0]} to {run[-1]}" for run in runs)
