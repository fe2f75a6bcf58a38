"""Who is right, by balls: lines for a terminal, and JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.text import Text

from rttrr_pin.exact import Adjudication, Assessment, Deviation, verdict_of
from rttrr_pin.validation import Validation
from rttrr_pin.validation.compare import ADJUDICATED


def show_adjudicated(result: Validation, console: Console) -> None:
    """The settled states of a run: each failing one that was settled, and the worst passing one."""
    if not result.adjudicated:
        return
    shown = min(result.failing, ADJUDICATED)
    if result.failing:
        which = f"the {shown} worst of " if shown < result.failing else ""
        console.print(Text(f"settled by balls, {which}{result.failing:,} failing states:"))
    for number, adjudicated in enumerate(result.adjudicated_states):
        passing = "  worst passing state" if shown else "settled by balls, worst state"
        told = "  state" if number < shown else passing
        console.print(Text(f"{told} {adjudicated[0].state}: {verdict_of(adjudicated)}"), soft_wrap=True)


def show_adjudication(adjudicated: Sequence[Adjudication], console: Console) -> None:
    """Who is right in the one state that is shown, settled against each oracle."""
    bits = max(one.bits for one in adjudicated)
    console.print(Text(f"settled by balls of {bits} bits: {verdict_of(adjudicated)}"), soft_wrap=True)


def adjudicated_data(adjudicated: Sequence[Adjudication]) -> dict[str, Any]:
    """One state as data; of several oracles with a settlement for each."""
    if len(adjudicated) == 1:
        return adjudication_data(adjudicated[0])
    each = [adjudication_data(one) for one in adjudicated]
    return {"state": adjudicated[0].state, "verdict": verdict_of(adjudicated), "oracles": each}


def adjudication_data(adjudicated: Adjudication) -> dict[str, Any]:
    """A settlement as data."""
    return {
        "state": adjudicated.state,
        "verdict": adjudicated.verdict,
        "bits": adjudicated.bits,
        "ours": _side(adjudicated.ours),
        "theirs": _side(adjudicated.theirs),
    }


def _side(side: Assessment) -> dict[str, Any]:
    first, farthest = side.first, side.farthest
    return {
        "program": side.name,
        "right": first is None,
        "first_wrong": None if first is None else _off(first),
        "farthest": _off(farthest),
    }


def _off(off: Deviation) -> dict[str, Any]:
    return {"quantity": off.quantity, "at": off.at, "eps": off.eps, "share_of_its_gate": off.share}
