"""`rttrr-pin audit`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from rttrr_pin.auditing import Publication, Verdict, read_publication
from rttrr_pin.auditing import audit as run_audit
from rttrr_pin.auditing.errata import errata
from rttrr_pin.auditing.report import show_audit, show_equations
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, Output, progress, write_json, write_text


def audit(
    file: Annotated[
        Path | None, typer.Argument(help="Equations as TOML or YAML; without it, those of the paper on the RTTRR arm.")
    ] = None,
    equation: Annotated[
        list[str] | None, typer.Option(help="Only the equation of this number, in full; repeatable.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the random state at which numbers are compared.", min=0)] = 0,
    json: Annotated[str | None, typer.Option(help="Write the result as JSON to this file; '-' is stdout.")] = None,
    latex: Annotated[str | None, typer.Option(help="Write an errata sheet as LaTeX; '-' is stdout.")] = None,
    html: Annotated[str | None, typer.Option(help="Write an errata sheet as one HTML page; '-' is stdout.")] = None,
    markdown: Annotated[str | None, typer.Option(help="Write an errata sheet as Markdown; '-' is stdout.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
) -> int:
    """Compare published equations of motion with the Newton-Euler recursion, term by term.

    Exit code: 0 all right, 1 findings or unreadable equations, 2 unusable input, such as undeclared symbols alone.
    """
    sheets = {"latex": latex, "html": html, "markdown": markdown}
    targets = {f"--{form}": target for form, target in ({"json": json} | sheets).items() if target is not None}
    _refuse_shared(targets)
    publication = read_publication() if file is None else read_publication(file)
    if equation:
        publication = _only(publication, equation)
    with progress(len(publication.equations), quiet, "equations") as advance:
        result = run_audit(publication, seed, advance)
    write_json(json, result.to_dict)
    for form, target in sheets.items():
        write_text(target, partial(errata, result, form))
    console = Output(quiet=quiet or "-" in targets.values(), soft_wrap=False, highlight=False)
    if equation:
        show_equations(result, console)
    else:
        show_audit(result, console, "" if file is None else str(file))
    if result.passed:
        return AGREE
    only_undeclared = not result.count(Verdict.DIFFERS) and not result.count(Verdict.UNPARSED)
    return UNUSABLE if only_undeclared else DISAGREE


def _refuse_shared(targets: Mapping[str, str]) -> None:
    """Two outputs in one place would be neither."""
    places: dict[str | Path, str] = {}
    for option, target in targets.items():
        place = target if target == "-" else Path(target).resolve()
        if place in places:
            where = "stdout" if target == "-" else target
            raise InputError(f"{places[place]} and {option} both go to {where}: give each a place of its own")
        places[place] = option


def _only(publication: Publication, numbers: Sequence[str]) -> Publication:
    """The publication with the equations asked for, in printed order."""
    wanted = [number.strip().removeprefix("(").removesuffix(")") for number in numbers]
    known = [str(equation.number) for equation in publication.equations]
    for number in wanted:
        if number not in known:
            raise InputError(f"there is no equation ({number}): there are {_ranges(known)}")
    chosen = tuple(equation for equation in publication.equations if str(equation.number) in wanted)
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
