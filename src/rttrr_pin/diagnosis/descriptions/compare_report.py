"""How two descriptions of a robot differ, as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.diagnosis.descriptions.compare import Comparison
from rttrr_pin.diagnosis.descriptions.difference import Difference
from rttrr_pin.diagnosis.descriptions.effects_of import Effect
from rttrr_pin.errors import listed
from rttrr_pin.reporting.results import counted
from rttrr_pin.validation.report import drawn, word

NARROW = 10
"""Characters that are left for names in a narrow terminal; numbers are never cut."""

MOST_ROWS = 20
"""Differences in the table; with `full` all of them."""

LEGEND = "change of tau by this difference alone, at the joint where it is the largest share of the joint's own (rms)"


def show_comparison(result: Comparison, console: Console, full: bool = False) -> None:
    """A row for each difference that matters, lists of those that do not, and the verdict."""
    a, b = result.robots
    console.print(Text(f"{a} against {b}", "bold"), soft_wrap=True)
    console.print(Text(compared(result)), soft_wrap=True)
    rows = result.mattering if full else result.mattering[:MOST_ROWS]
    if rows:
        console.print(_table(rows))
        if len(rows) < len(result.mattering):
            console.print(Text(f"and {len(result.mattering) - len(rows)} more (--full)", "dim"))
        console.print(Text(LEGEND, "dim"), soft_wrap=True)
    for line in result.reasons:
        console.print(Text(f"why: {line}"), soft_wrap=True)
    if full:
        console.print(_joints(result))
    for line in remarks(result, full):
        console.print(Text(line, "dim"), soft_wrap=True)
    sentence = result.summary().partition(" ")[2]
    console.print(word(result.passed), Text(f"{sentence} ({result.seconds:.1f} s)"), soft_wrap=True)


def compared(result: Comparison) -> str:
    """What was compared: joints and states."""
    return f"{counted(len(result.pairs), 'joint')} in both, {drawn(result.n_states, 'uniform', result.seed)}"


def remarks(result: Comparison, full: bool) -> tuple[str, ...]:
    """What changes no torque, what printed digits explain, and notes."""
    return (*_idle(result, full), *_rounding(result), *result.notes)


def _table(rows: Sequence[Effect]) -> Table:
    table = Table("difference", "first", "second", "joint", "rms", "max", "share", box=SIMPLE_HEAD, padding=0)
    for column in table.columns[4:]:
        column.justify = "right"
    for column in (table.columns[0], table.columns[3]):
        column.overflow, column.min_width = "fold", NARROW
    for column in (*table.columns[1:3], *table.columns[4:]):
        column.no_wrap = True
    for own in rows:
        joint = str(own.joint)
        numbers = (f"{own.rms[joint]:.3g}", f"{own.largest[joint]:.3g}", percent(own.share[joint]))
        (what, *values), *others = _lines(own.difference)
        table.add_row(what, *values, joint, *numbers)
        for line in others:
            table.add_row(*line)
    return table


def _lines(own: Difference) -> list[tuple[str, str, str]]:
    """What differs, and both values; of a tensor of which several entries differ, one line for each."""
    entries = [(name, number(x), number(y)) for name, x, y in own.entries]
    if not entries:
        return [(own.where, short(own.a), short(own.b))]
    if len(entries) == 1:
        return [(own.where, *entries[0][1:])]
    return [(f"{own.kind} of {own.link}", "", ""), *((f"  {name}", x, y) for name, x, y in entries)]


def _joints(result: Comparison) -> Table:
    """All differences together, joint by joint."""
    table = Table("joint", "rms of tau", "rms", "max", "share", "unexplained", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column in table.columns[1:]:
        column.justify = "right"
    for name, own in result.joints.items():
        share = percent(own.change / own.rms) if own.rms else ""
        left = f"{own.remainder:.3g}" if own.remainder else ""
        table.add_row(name, f"{own.rms:.3g}", f"{own.change:.3g}", f"{own.largest:.3g}", share, left)
    return table


def percent(share: float) -> str:
    """A share as a percentage."""
    return f"{100 * share:.3g} %"


def values_of(own: Difference) -> tuple[str, str]:
    """What both say, as short text; of a tensor the entries that differ."""
    if own.entries:
        rows = [(f"{name} {number(x)}", f"{name} {number(y)}") for name, x, y in own.entries]
        return "\n".join(x for x, _ in rows), "\n".join(y for _, y in rows)
    return short(own.a), short(own.b)


def short(value: Any) -> str:
    """A value of a difference."""
    if value is None:
        return "-"
    if isinstance(value, dict):
        return f"{number(value['multiplier'])} {value['joint']} + {number(value['offset'])}"
    if isinstance(value, list):
        return " ".join(number(x) for x in value)
    return value if isinstance(value, str) else number(value)


def number(x: float) -> str:
    """Six digits."""
    return f"{x:.6g}"


def _idle(result: Comparison, full: bool) -> list[str]:
    """Differences that change no torque."""
    rows = [
        f"{own.difference.where} ({', '.join(values_of(own.difference))})".replace("\n", " ") for own in result.idle
    ]
    if not rows:
        return []
    lines = [f"no torque changes: {', '.join(rows) if full else listed(rows)}"]
    if any(own.difference.kind in ("damping", "friction") for own in result.idle):
        lines.append("damping and friction take part in tau where the robot is loaded with them: --friction")
    return lines


def _rounding(result: Comparison) -> list[str]:
    """What printed digits explain, in one line."""
    if not result.rounding:
        return []
    first, own = result.rounding[0], result.rounding_effect
    count = counted(len(result.rounding), "number")
    changed = (
        "; no torque changes"
        if own is None or not own.matters
        else (f"; together {percent(own.worst)} of the torque of {own.joint} (rms)")
    )
    return [f"to the digits printed: {count}, most of all {first.where}, by {first.relative:.2g} of it{changed}"]
