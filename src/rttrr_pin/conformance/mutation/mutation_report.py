"""Mutation scores as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.conformance.mutation.mutants import Mutant
from rttrr_pin.conformance.mutation.mutation import MutationScore, grouped
from rttrr_pin.diagnosis.report import values_of
from rttrr_pin.errors import listed

SHOWN = 12
"""Kinds of wrong dynamics that are listed, unless all are asked for."""


def show_score(result: MutationScore, console: Console, full: bool = False) -> None:
    """The score by kind, and what the suite lets pass, the largest changes first."""
    console.print(Text(f"{result.robot}:", "bold"), Text(result.suite), soft_wrap=True)
    table = Table("wrong dynamics", "seen", "pass", "score", box=None)
    for column in table.columns[1:]:
        column.justify = "right"
    for name, (seen, total) in result.kinds.items():
        table.add_row(Text(name), f"{seen:,}", f"{total - seen:,}", f"{seen / total:.1%}")
    console.print(table)
    console.print(Text(left_out(result), "dim"), soft_wrap=True)
    verdict, style = ("ALL SEEN", "bold green") if result.passed else ("SOME PASS", "bold red")
    seen = len(result.mutants) - len(result.passing)
    console.print(
        Text(verdict, style),
        Text(f"{seen:,} of {len(result.mutants):,} wrong dynamics, {result.score:.1%} ({result.seconds:.1f} s)"),
        soft_wrap=True,
    )
    if result.passing:
        console.print(Text("what passes, and how much of what is expected it changes at other states:"))
    groups = grouped(result.passing)
    for group in groups if full else groups[:SHOWN]:
        console.print(Text(line_of(group)), soft_wrap=True)
    if not full and len(groups) > SHOWN:
        console.print(Text(f"  and {len(groups) - SHOWN} more; --full shows all"))


def left_out(result: MutationScore) -> str:
    """What was not counted."""
    parts = [f"{result.equivalent:,} change no result of this robot", f"{result.alike:,} give the same as another"]
    if result.left_out:
        parts.append(f"{result.left_out:,} were not drawn")
    return f"not counted: {', '.join(parts)}"


def line_of(group: Sequence[Mutant]) -> str:
    """One hypothesis, at the places where it passes."""
    first, *others = group
    sentence = first.sentence
    if first.numbers and len(first.numbers) == 1:
        sentence += f" ({values_of(first.values)})"
    places = [own.link or own.joint or "all" for own in others]
    also = f"; also at {listed(places, 4)}" if others else ""
    part = first.relative
    size = (
        f"{100 * part:.2g} %"
        if part < 0.1
        else f"{part:.0%}".replace("%", " %")
        if part < 10.0
        else f"{part:.2g} times"
    )
    return f"  {size:>9} of {first.quantity} of {first.at}: {sentence}{also}"
