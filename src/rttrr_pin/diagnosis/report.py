"""Diagnoses as text for a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.results import Cause, Diagnosis, Residual

SHOWN = 8
"""Rows, or alternatives, that are shown unless all are asked for."""

OTHERS = 3
"""Other sets of causes, likewise."""

STYLES = {"agrees": "bold green", "explained": "bold yellow", "unexplained": "bold red"}


def show_diagnosis(result: Diagnosis, console: Console, full: bool = False) -> None:
    """The verdict, the causes with their repairs, the differences before and after, and a test to paste."""
    console.print(Text(f"{result.robot}:", "bold"), Text(compared(result)))
    for note in result.notes:
        console.print(Text(note, "dim"), soft_wrap=True)
    if not result.passed:
        console.print(_table(result, full))
    console.print(
        Text(result.verdict.upper(), STYLES[result.verdict]),
        Text(f"{sentence(result)} ({result.seconds:.1f} s)"),
        soft_wrap=True,
    )
    for number, cause in enumerate(result.causes, 1):
        _show_cause(cause, f"{number}. " if len(result.causes) > 1 else "", console, full)
    others = result.others if full else result.others[:OTHERS]
    for k, other in enumerate(others):
        head = "or, which these states do not tell from it: " if k == 0 else "or: "
        console.print(Text(head + "; ".join(map(told, other))), soft_wrap=True)
    if len(others) < len(result.others):
        console.print(Text(f"or one of {len(result.others) - len(others)} more; --full shows all"))
    for line in result.dependence:
        console.print(Text(f"- {line}"), soft_wrap=True)
    if result.near_misses:
        console.print(Text("what comes nearest, and how much of the difference it explains:"))
        for near in result.near_misses:
            console.print(Text(f"  {near.explains:7.2%}  {near.sentence}"), soft_wrap=True)
    if result.counterexample:
        console.print(Text("a state as simple as could be found, as a test:"))
        console.print(Text(result.counterexample), soft_wrap=True)


def compared(result: Diagnosis) -> str:
    """What was compared with what, in how many states."""
    plural = "s" * (result.n_states != 1)
    kinds = {"table": f"state{plural} of the table", "given": f"state{plural}"}
    states = kinds.get(result.sampling, f"telling state{plural}")
    return f"{result.subject} against {result.reference}, {result.n_states:,} {states}"


def told(cause: Cause) -> str:
    """A cause with its numbers, in one line."""
    numbers = values_of(cause.values)
    return f"{cause.sentence}{f' ({numbers})' if numbers else ''}"


def place(cause: Cause) -> str:
    """The equation and the line to look at; empty where there are none."""
    return ": ".join(filter(None, [f"equation {cause.equation}" if cause.equation else "", cause.line]))


def values_of(values: Mapping[str, Any]) -> str:
    """Numbers by name, in one line."""
    return ", ".join(f"{name} {_number(x)}" for name, x in values.items())


def _number(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:.6g}"
    if isinstance(x, list | tuple):
        return f"({', '.join(map(_number, x))})"
    return str(x)


def _show_cause(cause: Cause, number: str, console: Console, full: bool) -> None:
    console.print(Text(f"{number}{cause.program}: {told(cause)}", "bold"), soft_wrap=True)
    console.print(Text(f"   repair: {cause.repair}"), soft_wrap=True)
    if where := place(cause):
        console.print(Text(f"   see {where}"), soft_wrap=True)
    shown = cause.alternatives if full else cause.alternatives[:SHOWN]
    if shown:
        console.print(Text("   these would give the same results in all of these states:"))
        for other in shown:
            console.print(Text(f"   - {other.sentence}"), soft_wrap=True)
        if len(shown) < len(cause.alternatives):
            console.print(Text(f"   - and {len(cause.alternatives) - len(shown)} more; --full shows all"))


def sentence(result: Diagnosis) -> str:
    """What the verdict is about."""
    if result.passed:
        return "all differences are rounding"
    before = f"the largest difference is {result.residual_before:.3g} times what rounding explains"
    if result.verdict == "explained":
        count = "one cause" if len(result.causes) == 1 else f"{len(result.causes)} causes"
        return f"by {count}: {before}, and {result.residual_after:.2g} with that"
    return f"{before}, and no set of the {result.tried:,} hypotheses that were tried explains it"


def _table(result: Diagnosis, full: bool) -> Table:
    """The differences at each joint and link that has any, the worst ones."""
    table = Table("", "at", "rms expected", "largest difference", "error / tolerance", box=None)
    for column in table.columns[2:]:
        column.justify = "right"
    explained = result.verdict == "explained"
    if explained:
        table.add_column("with the causes", justify="right")
    rows = [row for row in result.residuals if row.of_tolerance_before > 1.0]
    if not full and len(rows) > SHOWN:
        rows = sorted(rows, key=lambda row: -row.of_tolerance_before)[:SHOWN]
    for row in sorted(rows, key=lambda row: QUANTITIES.index(row.quantity)):
        table.add_row(*_cells(row), *([f"{row.of_tolerance_after:.2g}"] if explained else []))
    return table


def _cells(row: Residual) -> list[str | Text]:
    return [
        row.quantity,
        Text(row.at),
        f"{row.size:.4g} {row.unit}",
        f"{row.before:.3g} {row.unit}",
        f"{row.of_tolerance_before:.2g}",
    ]
