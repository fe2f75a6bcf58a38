"""What was derived, as a table for a terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.derivation import QUANTITIES, Derivation


def show_derivation(derivation: Derivation, seconds: float, written: Mapping[str, str], console: Console) -> None:
    """How long each quantity is, and where it was written.

    Args:
        derivation: what was derived.
        seconds: that it took.
        written: the files, by format.
        console: where to print.
    """
    console.print(
        Text(derivation.robot.model.name, "bold"), Text(f"{derivation.form} form ({derivation.reason}), SI units")
    )
    table = Table("quantity", "meaning", "entries", "terms", "longest")
    for column in (2, 3, 4):
        table.columns[column].justify = "right"
    if derivation.steps:
        lengths = [len(step.terms) for step in derivation.steps]
        table.add_row("steps", "named on the way", *_counts(lengths))
    for name, derived in derivation.quantities.items():
        table.add_row(name, QUANTITIES[name].meaning, *_counts([len(terms) for terms in derived.terms.values()]))
    console.print(table)
    console.print(Text(f"{derivation.count():,} terms in all ({seconds:.1f} s)"))
    for format_name, target in written.items():
        console.print(Text(f"{format_name}: {target}"), soft_wrap=True)


def _counts(lengths: list[int]) -> tuple[str, str, str]:
    return str(len(lengths)), f"{sum(lengths):,}", f"{max(lengths, default=0):,}"
