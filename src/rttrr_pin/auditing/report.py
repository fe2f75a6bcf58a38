"""Audits as tables for a terminal."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from rttrr_pin.auditing.results import AuditResult, ComponentAudit, Finding, Verdict, cells
from rttrr_pin.auditing.wording import (
    convention_words,
    dimension_summary,
    dimension_words,
    evidence_words,
    verdict_words,
)
from rttrr_pin.reporting.results import counted

COLOURS = {
    Verdict.MATCH: "green",
    Verdict.DIFFERS: "bold red",
    Verdict.UNPARSED: "bold yellow",
    Verdict.UNDECLARED: "bold yellow",
}


def show_audit(result: AuditResult, console: Console, file: str = "") -> None:
    """Every component's verdict, conventions, totals, and what to type next.

    `file` is the file of equations as the user named it; empty for the paper.
    """
    _heading(result, console)
    if result.components:
        console.print(_summary(result.components))
    for check in result.conventions:
        text = Text.assemble((f"{check.convention.title}: ", "bold"), convention_words(check))
        console.print(Padding(text, (0, 0, 0, 2)))
    for line in dict.fromkeys(line for component in result.components for line in component.undeclared):
        console.print(Text(line), soft_wrap=True)
    _verdict(result, console)
    _next(result, console, file)


def show_equations(result: AuditResult, console: Console) -> None:
    """Every component in full: findings, evidence, corrected equation, notes."""
    _heading(result, console)
    if result.definitions:
        numbers = ", ".join(f"({number})" for number in result.definitions)
        console.print(Text(f"{numbers} only defines symbols: there is nothing to compare"))
    for component in result.components:
        _component(result, component, console)
    _verdict(result, console)


def _heading(result: AuditResult, console: Console) -> None:
    publication = result.publication
    console.print(Text(publication.title, "bold"))
    console.print(
        Text(
            f"{publication.source}; {counted(len(publication.equations), 'equation')}, "
            f"{counted(len(result.components), 'component')}; numbers compared at a random state, seed {result.seed}"
        )
    )
    for note in result.notes:
        console.print(Text(f"the robot's file: {note}"), soft_wrap=True)


def _summary(components: Sequence[ComponentAudit]) -> Table:
    """A row for each equation; a scalar has its verdict in a column of its own, if there is any."""
    rows = list(cells(components))
    axes = [axis for axis in ("x", "y", "z", "") if any(axis in row for _, _, row in rows)]
    table = Table("equation", "states", *(axis or "scalar" for axis in axes), box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for number, quantity, row in rows:
        verdicts = [Text(verdict_words(x), COLOURS[x.verdict]) if (x := row.get(axis)) else Text("") for axis in axes]
        table.add_row(Text(f"({number})"), Text(quantity), *verdicts)
    return table


def _verdict(result: AuditResult, console: Console) -> None:
    totals = result.totals
    head = Text("FINDINGS", "bold red") if totals.findings else Text("NOT ALL JUDGED", "bold yellow")
    console.print(Text("ALL RIGHT", "bold green") if result.passed else head, Text(result.summary()))
    if totals.findings:
        kinds = ", ".join(f"{number} {kind}" for kind, number in totals.kinds.items() if number)
        console.print(Padding(Text(f"by kind: {kinds}"), (0, 0, 0, 2)))
    if totals.dimensionally_wrong:
        console.print(Padding(Text(dimension_summary(totals)), (0, 0, 0, 2)))


def _next(result: AuditResult, console: Console, file: str) -> None:
    wrong = [component for component in result.components if component.verdict is not Verdict.MATCH]
    if not wrong:
        return
    command = shlex.join(["rttrr-pin", "audit", *([file] if file else [])])
    most = max(wrong, key=lambda component: len(component.findings))
    console.print(Text(f"in full: {command} --equation {shlex.quote(str(most.equation))}"), soft_wrap=True)
    console.print(Text(f"errata sheet: {command} --markdown errata.md (or --html, --latex)"), soft_wrap=True)


def _component(result: AuditResult, component: ComponentAudit, console: Console) -> None:
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
    for reason in (component.unparsed, *component.undeclared):
        if reason:
            table.add_row("  why", Text(reason))
    for group in component.by_term:
        _finding_rows(group, table)
    if component.evidence is not None:
        table.add_row("  evidence", Text(" ".join(evidence_words(result, component))))
    for note in component.notes:
        table.add_row("  note", Text(note))
    if component.findings:
        table.add_row("  corrected", _corrected(component))
    console.print(table)


def _finding_rows(group: Sequence[Finding], table: Table) -> None:
    """One term, with the errors in it."""
    for finding in group:
        dimension = f"; dimension {dimension_words(finding)}" if finding.printed else ""
        table.add_row(Text(f"  {finding.id}", "bold"), Text(f"{finding.kind}{dimension}"))
    first = group[0]
    table.add_row("    printed", Text(first.printed or "(nothing)"))
    table.add_row("    should be", Text(_plain(first.derived) if first.derived else "(nothing)"))
    if first.note:
        table.add_row("    note", Text(first.note))


def _corrected(component: ComponentAudit) -> Text:
    text = Text(f"{component.quantity} =")
    for term, changed in component.corrected:
        text.append(" ")
        text.append(f"[{_plain(term)}]" if changed else _plain(term), "bold green" if changed else "")
    return text.append("  (changed terms in [ ])", "dim")


def _plain(term: str) -> str:
    """A term for a terminal: no thin spaces."""
    return term.replace(r" \, ", " ")
