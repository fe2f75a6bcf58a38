"""Audits of published equations as tables and as JSON."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from rttrr_pin.auditing.findings import Finding
from rttrr_pin.auditing.verdicts import Audit, ComponentAudit, Verdict
from rttrr_pin.auditing.wording import (
    Totals,
    by_term,
    cells,
    convention_words,
    counted,
    definitions,
    dimension_summary,
    dimension_words,
    evidence_words,
    totals,
    unit,
    verdict_words,
)

COLOURS = {Verdict.MATCH: "green", Verdict.DIFFERS: "bold red", Verdict.UNPARSED: "bold yellow"}


def show_audit(result: Audit, console: Console, file: str = "") -> None:
    """What was audited, equation by component with verdicts, conventions, totals, and what to type next.

    Args:
        result: the audit.
        console: where to.
        file: the file of equations as the user named it; empty for the paper.
    """
    found = totals(result.components)
    _heading(result, console, found)
    if result.components:
        console.print(_summary(result.components))
    for check in result.conventions:
        told = f"{' '.join(check.convention.text.split())} {convention_words(check)}"
        console.print(Padding(Text.assemble((f"{check.convention.title}: ", "bold"), told.rstrip()), (0, 0, 0, 2)))
    _verdict(found, console)
    _next(result, console, file)


def show_equations(result: Audit, console: Console) -> None:
    """Every component in full: findings, evidence, corrected equation, notes."""
    found = totals(result.components)
    _heading(result, console, found)
    defining = definitions(result.publication)
    if defining:
        numbers = ", ".join(f"({number})" for number in defining)
        console.print(Text(f"{numbers} only says what letters mean: there is nothing to compare"))
    for component in result.components:
        _component(result, component, console)
    _verdict(found, console)


def _heading(result: Audit, console: Console, found: Totals) -> None:
    publication = result.publication
    console.print(Text(publication.title, "bold"))
    console.print(
        Text(
            f"{publication.source}; {counted(len(publication.equations), 'equation')}, "
            f"{counted(found.components, 'component')}; numbers compared at a random state, seed {result.seed}"
        )
    )


def _summary(components: Sequence[ComponentAudit]) -> Table:
    """A row for each equation; a scalar has its verdict in a column of its own, if there is any."""
    rows = cells(components)
    axes = [axis for axis in ("x", "y", "z", "") if any(axis in row for row in rows.values())]
    table = Table("equation", "states", *(axis or "scalar" for axis in axes), box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for (number, quantity), row in rows.items():
        verdicts = [_cell(row.get(axis)) for axis in axes]
        table.add_row(Text(f"({number})"), Text(quantity), *verdicts)
    return table


def _cell(component: ComponentAudit | None) -> Text:
    return Text("") if component is None else Text(verdict_words(component), COLOURS[component.verdict])


def _verdict(found: Totals, console: Console) -> None:
    wrong = found.components - found.verdicts[Verdict.MATCH]
    counts = ", ".join(
        f"{number} {word}"
        for verdict, word in ((Verdict.MATCH, "match"), (Verdict.DIFFERS, "differ"), (Verdict.UNPARSED, "not read"))
        if (number := found.verdicts[verdict]) or verdict is Verdict.MATCH
    )
    head = Text("FINDINGS", "bold red") if wrong else Text("ALL RIGHT", "bold green")
    console.print(head, Text(f"{counts}; {counted(found.findings, 'finding')}"))
    if found.findings:
        kinds = ", ".join(f"{number} {kind}" for kind, number in found.kinds.items() if number)
        console.print(Padding(Text(f"by kind: {kinds}"), (0, 0, 0, 2)))
    if found.dimensionally_wrong:
        console.print(Padding(Text(dimension_summary(found)), (0, 0, 0, 2)))


def _next(result: Audit, console: Console, file: str) -> None:
    """What to type to see more."""
    wrong = [component for component in result.components if component.verdict is not Verdict.MATCH]
    if not wrong:
        return
    command = shlex.join(["rttrr-pin", "audit", *([file] if file else [])])
    most = max(wrong, key=lambda component: len(component.findings))
    console.print(Text(f"in full: {command} --equation {shlex.quote(str(most.equation))}"), soft_wrap=True)
    console.print(Text(f"errata sheet: {command} --markdown errata.md (or --html, --latex)"), soft_wrap=True)


def _component(result: Audit, component: ComponentAudit, console: Console) -> None:
    """One component in full."""
    line = f", line {component.line}" if component.line else ""
    console.print()
    console.print(
        Text(f"({component.equation}) {component.quantity}", "bold"),
        Text(verdict_words(component), COLOURS[component.verdict]),
        Text(f"{component.printed_terms} terms printed, {component.derived_terms} derived{line}", "dim"),
    )
    table = Table.grid(padding=(0, 1, 0, 0))
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    if component.unparsed:
        table.add_row("  why", Text(component.unparsed))
    for group in by_term(component.findings):
        _finding_rows(group, table)
    if component.evidence is not None:
        table.add_row("  evidence", Text(" ".join(evidence_words(result, component))))
    for note in component.notes:
        table.add_row("  note", Text(note))
    if component.findings:
        table.add_row("  corrected", _corrected(component))
    console.print(table)


def _finding_rows(group: Sequence[Finding], table: Table) -> None:
    """One term, with the slips in it."""
    for finding in group:
        dimension = f"; dimension {dimension_words(finding)}" if finding.printed else ""
        table.add_row(Text(f"  {finding.id}", "bold"), Text(f"{finding.kind}{dimension}"))
    first = group[0]
    table.add_row("    printed", Text(first.printed or "(nothing)"))
    table.add_row("    should be", Text(_plain(first.derived) if first.derived else "(nothing)"))
    if first.note:
        table.add_row("    note", Text(first.note))


def _corrected(component: ComponentAudit) -> Text:
    """The right-hand side with its changed terms marked."""
    text = Text(f"{component.quantity} =")
    for term, changed in component.corrected:
        text.append(" ")
        text.append(f"[{_plain(term)}]" if changed else _plain(term), "bold green" if changed else "")
    return text.append("  (changed terms in [ ])", "dim")


def _plain(term: str) -> str:
    """A term for a terminal: no thin spaces."""
    return term.replace(r" \, ", " ")


def audit_data(result: Audit) -> dict[str, Any]:
    """The whole audit."""
    found = totals(result.components)
    publication = result.publication
    return {
        "title": publication.title,
        "source": publication.source,
        "language": publication.language,
        "equations": [equation.number for equation in publication.equations],
        "seed": result.seed,
        "verdict": "all right" if result.all_right else "findings",
        "totals": {
            "components": found.components,
            **{str(verdict): number for verdict, number in found.verdicts.items()},
            "findings": found.findings,
            "kinds": {str(kind): number for kind, number in found.kinds.items()},
            "dimensionally_wrong": found.dimensionally_wrong,
        },
        "conventions": [
            {**asdict(check.convention), "findings": check.findings, "otherwise": check.otherwise}
            for check in result.conventions
        ],
        "components": [_component_data(result, component) for component in result.components],
    }


def _component_data(result: Audit, component: ComponentAudit) -> dict[str, Any]:
    return {
        **asdict(component),
        "verdict": str(component.verdict),
        "unit": unit(result.publication, component),
        "findings": [{**asdict(finding), "kind": str(finding.kind)} for finding in component.findings],
        "corrected": [{"term": term, "changed": changed} for term, changed in component.corrected],
    }
