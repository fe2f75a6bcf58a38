"""The outcome of the laws as text for a terminal."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.laws.run import LawReport, LawRow
from rttrr_pin.validation.report import drawn, word

LEGEND = "error / bound: of the residual, which rounding alone keeps below 1"


def show_laws(report: LawReport, console: Console) -> None:
    """A row for each law, the statements of those that are violated, and the verdict."""
    states = drawn(report.n_states, report.sampling, report.seed)
    base = ", floating base" if report.base == "floating" else ""
    header = f"{report.subject}: laws of mechanics, {states}, payload {report.payload}{base}"
    console.print(Text(f"{report.robot}:", "bold"), Text(header), soft_wrap=True)
    table = Table("law", "", "error / bound", "at state", "violated in", "", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column in table.columns[2:5]:
        column.justify = "right"
    for row in report.rows:
        table.add_row(row.law.id, Text(row.law.name), *_numbers(row), _verdict(row))
    console.print(table)
    for line in (*report.notes, LEGEND):
        console.print(Text(line, "dim"), soft_wrap=True)
    for row in report.violated:
        console.print(Text(f"{row.law.id}: {row.law.statement}"), soft_wrap=True)
    sentence = report.summary().partition(" ")[2]
    console.print(word(report.passed), Text(f"{sentence} ({report.seconds:.1f} s)"), soft_wrap=True)


def _numbers(row: LawRow) -> tuple[str, str, str]:
    """Error / bound, state and count; empty for a law that says nothing of this robot."""
    worst = row.error_over_bound
    if not row.numbers:
        return "", "", ""
    if worst.value == 0.0:
        return "exact", "", ""
    return f"{worst.value:.3g}", str(worst.state), f"{row.violations:,}" if row.violations else ""


def _verdict(row: LawRow) -> Text:
    if not row.numbers:
        return Text("does not apply", "dim")
    return Text("holds", "green") if row.passed else Text("VIOLATED", "bold red")
