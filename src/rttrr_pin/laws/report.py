"""The laws of mechanics as a table and as JSON."""

from __future__ import annotations

from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.laws.run import LawReport, LawRow

LAW_GATE = "what a law says is zero lies within its running error bound of zero; share: of that bound"


def show_laws(result: LawReport, console: Console) -> None:
    """A row for each law, the statements of those that are violated, and the verdict."""
    base = ", floating base" if result.base == "floating" else ""
    told = f"{result.n_states:,} {result.sampling} states, seed {result.seed}, payload {result.payload}{base}"
    console.print(Text("laws", "bold"), Text(f"of {result.robot}, by themselves: {told}"))
    table = Table("law", "", "share", "at state", "violated in", "", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column in (2, 3, 4):
        table.columns[column].justify = "right"
    for row in result.rows:
        table.add_row(row.law.id, Text(row.law.name), *_numbers(row), _word(row))
    console.print(table)
    for row in result.rows:
        if not row.holds:
            console.print(Text(f"{row.law.id}: {row.law.statement}"))
    broken = [row for row in result.rows if not row.holds]
    said = "hold" if not broken else f"are violated, {', '.join(row.law.id for row in broken)}"
    count = f"all {len(result.rows)}" if not broken else f"{len(broken)} of {len(result.rows)}"
    verdict = Text("PASS", "bold green") if not broken else Text("FAIL", "bold red")
    console.print(verdict, Text(f"{count} laws {said} ({result.seconds:.1f} s)"))


def laws_data(result: LawReport) -> dict[str, Any]:
    """The outcome: per law the worst share and where, and the verdict."""
    return {
        "n_states": result.n_states,
        "sampling": result.sampling,
        "seed": result.seed,
        "payload": result.payload,
        "gate": LAW_GATE,
        "verdict": "hold" if result.holds else "violated",
        "laws": {row.law.id: _row(row) for row in result.rows},
        "seconds": result.seconds,
    }


def _row(row: LawRow) -> dict[str, Any]:
    return {
        "name": row.law.name,
        "statement": row.law.statement,
        "numbers": row.numbers,
        "worst_share_of_bound": {"value": row.share.value, "state": row.share.state if row.numbers else None},
        "violations": row.violations,
        "verdict": "holds" if row.holds else "violated",
    }


def _numbers(row: LawRow) -> tuple[str, str, str]:
    """Share, state and count; a law that says nothing of this robot has none."""
    if not row.numbers:
        return "", "", ""
    if row.share.value == 0.0:
        return "exact", "", ""
    return f"{row.share.value:.3f}", str(row.share.state), f"{row.violations:,}" if row.violations else ""


def _word(row: LawRow) -> Text:
    if not row.numbers:
        return Text("nothing to hold", "dim")
    return Text("holds", "green") if row.holds else Text("VIOLATED", "bold red")
