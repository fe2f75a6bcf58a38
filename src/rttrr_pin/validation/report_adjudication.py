"""Who is right, by balls: lines for a terminal, and JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.text import Text

from rttrr_pin.exact import Off, Settlement, Side, verdict_of
from rttrr_pin.validation import Validation
from rttrr_pin.validation.compare import SETTLED


def show_settled(result: Validation, console: Console) -> None:
    """The settled states of a run: each failing one that was settled, and the worst passing one."""
    if not result.settled:
        return
    shown = min(result.failing, SETTLED)
    if result.failing:
        which = f"the {shown} worst of " if shown < result.failing else ""
        console.print(Text(f"settled by balls, {which}{result.failing:,} failing states:"))
    for number, settled in enumerate(result.settled_states):
        passing = "  worst passing state" if shown else "settled by balls, worst state"
        told = "  state" if number < shown else passing
        console.print(Text(f"{told} {settled[0].state}: {verdict_of(settled)}"), soft_wrap=True)


def show_settlement(settled: Sequence[Settlement], console: Console) -> None:
    """Who is right in the one state that is shown, settled against each oracle."""
    bits = max(one.bits for one in settled)
    console.print(Text(f"settled by balls of {bits} bits: {verdict_of(settled)}"), soft_wrap=True)


def settled_data(settled: Sequence[Settlement]) -> dict[str, Any]:
    """One state as data; of several oracles with a settlement for each."""
    if len(settled) == 1:
        return settlement_data(settled[0])
    each = [settlement_data(one) for one in settled]
    return {"state": settled[0].state, "verdict": verdict_of(settled), "oracles": each}


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
