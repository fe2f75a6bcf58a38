"""Who is right, by balls: lines for a terminal, and JSON."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.text import Text

from rttrr_pin.certify import Off, Settlement, Side
from rttrr_pin.validate import StateReport, Validation
from rttrr_pin.validate.compare import SETTLED


def show_settled(result: Validation, console: Console) -> None:
    """The settled states of a run: each failing one that was settled, and the worst passing one."""
    if not result.settled:
        return
    shown = min(result.failing, SETTLED)
    if result.failing:
        which = f"the {shown} worst of " if shown < result.failing else ""
        console.print(Text(f"settled by balls, {which}{result.failing:,} failing states:"))
    for one in result.settled[:shown]:
        console.print(Text(f"  state {one.state}: {one.verdict}"), soft_wrap=True)
    for one in result.settled[shown:]:
        told = "  worst passing state" if shown else "settled by balls, worst state"
        console.print(Text(f"{told} {one.state}: {one.verdict}"), soft_wrap=True)


def show_settlement(report: StateReport, console: Console) -> None:
    """Who is right in the one state that is shown."""
    told = f"settled by balls of {report.settled.bits} bits: {report.settled.verdict}"
    console.print(Text(told), soft_wrap=True)


def settlement_data(settled: Settlement) -> dict[str, Any]:
    """A settlement as data."""
    return {
        "state": settled.state,
        "verdict": settled.verdict,
        "bits": settled.bits,
        "ours": _side(settled.ours),
        "theirs": _side(settled.theirs),
    }


def _side(side: Side) -> dict[str, Any]:
    first, farthest = side.first, side.farthest
    return {
        "program": side.name,
        "right": first is None,
        "first_wrong": None if first is None else _off(first),
        "farthest": _off(farthest),
    }


def _off(off: Off) -> dict[str, Any]:
    return {"quantity": off.quantity, "at": off.at, "eps": off.eps, "share_of_its_gate": off.share}
