"""Results as tables for a terminal."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import STANDARD_GRAVITY
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES, LinkWrenches
from rttrr_pin.validation import Row, StateComparison, StateReport, Validation
from rttrr_pin.validation.report_adjudication import show_adjudicated, show_adjudication
from rttrr_pin.validation.report_several import against, places, several_table, word

MOST_ROWS = 60
"""Beyond it the table keeps the worst row of each quantity."""

LEGEND = "in eps: of |theirs|; share: of what rounding can explain, the gate is at 1"


def show_validation(result: Validation, console: Console, rerun: str = "", full: bool = False) -> None:
    """The table of a run, its verdict, and how to see the worst state."""
    console.print(
        Text(result.robot, "bold"),
        Text(
            f"{result.n_states:,} {result.sampling} states, seed {result.seed}, payload {result.payload}"
            f"{_unusual(result)}; ours against {result.oracle}"
        ),
    )
    grouped = places(result)
    shown = grouped
    if len(grouped) > MOST_ROWS and not full:
        groups = [[place for place in grouped if place.quantity == key] for key in QUANTITIES]
        shown = [max(group, key=lambda place: place.share) for group in groups if group]
    several = len(result.against) > 1
    console.print(
        several_table(result, shown) if several else _validation_table([row for place in shown for row in place.given])
    )
    if len(shown) < len(grouped):
        console.print(Text(f"the worst of {len(grouped)} rows for each quantity; --full shows all"))
    console.print(Text(LEGEND, "dim"))
    _verdict(result.agrees, result, console)
    show_adjudicated(result, console)
    worst = result.worst
    if worst is not None and rerun:
        where = f"worst state {worst.share.state} ({worst.quantity} at {worst.at}{against(result, worst)})"
        console.print(Text(f"{where}, in full: {rerun} --state {worst.share.state}"), soft_wrap=True)


def show_state(report: StateReport, console: Console) -> None:
    """One state: its coordinates, then each quantity, ours beside the oracle's."""
    console.print(
        Text(report.robot, "bold"),
        Text(f"state {report.index}; ours against {', '.join(view.oracle for view in report.views)}"),
    )
    console.print(_coordinates_table(report))
    for load in report.states.loads:
        axes = "base axes" if load.in_base else "link axes"
        f, n = _numbers(load.f.ravel()), _numbers(load.n.ravel())
        console.print(Text(f"payload at {report.ours.links[load.link]}, {axes}: f {f} N, n {n} N m"))
    for view in report.views:
        if len(report.views) > 1:
            console.print(Text(f"ours against {view.oracle}", "bold"))
        _show_view(report, view, console)
    show_adjudication([view.adjudicated for view in report.views], console)


def _show_view(report: StateReport, view: StateComparison, console: Console) -> None:
    """Ours beside one oracle's."""
    table = Table("", "ours", "theirs", "differ", "in eps", "", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.columns[0].overflow = "fold"
    for column in (1, 2, 3, 4):
        table.columns[column].justify = "right"
        table.columns[column].no_wrap = True
    previous = ""
    for row, gap, (ours, theirs) in zip(view.rows, view.gaps, _values(report.ours, view), strict=True):
        if row.quantity != previous:
            table.add_section()
            table.add_row(Text(row.quantity if row.quantity == "tau" else f"{row.quantity} [{row.unit}]", "bold"))
        previous = row.quantity
        table.add_row(
            Text(f"{row.at} [{row.unit}]" if row.quantity == "tau" else row.at),
            "\n".join(f"{x:.15g}" for x in ours),
            "\n".join(f"{x:.15g}" for x in theirs),
            f"{gap.difference[0]:.1e}",
            f"{gap.relative[0]:.1f}",
            word(bool(gap.share[0] <= 1.0)),
        )
    console.print(table)
    shares = [float(gap.share[0]) for gap in view.gaps]
    worst = view.rows[int(np.argmax(shares))]
    told = f"closest to the gate: {worst.quantity} at {worst.at}, {max(shares):.3f} of what rounding can explain"
    console.print(word(view.agrees), Text(told))


def _unusual(result: Validation) -> str:
    """What is not as by default: base, gravity, drives."""
    parts = ["floating base"] if result.base == "floating" else []
    if result.gravity != STANDARD_GRAVITY:
        parts.append(f"gravity {_numbers(np.array(result.gravity))} m/s^2")
    if result.effects:
        parts.append(f"drives of {len(result.effects)} joints")
    return "".join(f", {part}" for part in parts)


def _validation_table(rows: Iterable[Row]) -> Table:
    table = Table("quantity", "at", "worst error", "in eps", "share", "at state", "verdict")
    for column in (2, 3, 4, 5):
        table.columns[column].justify = "right"
    previous = ""
    for row in rows:
        if previous and row.quantity != previous:
            table.add_section()
        first = row.quantity != previous
        previous = row.quantity
        table.add_row(
            row.quantity if first else "",
            Text(row.at),
            *_worst(row),
            word(row.passed),
        )
    return table


def _worst(row: Row) -> tuple[str, str, str, str]:
    """The four numbers of a row; where ours and theirs are the same bits in every state there is no worst one."""
    if row.absolute.value == 0.0:
        return "equal", "", "", ""
    error = f"{row.absolute.value:.1e} {row.unit}"
    return error, f"{row.relative.value:.1f}", f"{row.share.value:.3f}", str(row.share.state)


def _coordinates_table(report: StateReport) -> Table:
    """q, v, a by name; of a floating joint q has other names than v, a, and stands apart."""
    states = report.states
    numbers = {name: [f"{value:.17g}" for value in getattr(states, name)[0]] for name in "qva"}
    alike = report.q_names == report.v_names
    table = Table("joint", *("qva" if alike else "va"))
    for j, label in enumerate(report.v_names):
        table.add_row(Text(label), *(numbers[name][j] for name in ("qva" if alike else "va")))
    if not alike:
        table.add_section()
        for label, value in zip(report.q_names, numbers["q"], strict=True):
            table.add_row(Text(f"q of {label}"), value)
    return table


def _values(ours: LinkWrenches, view: StateComparison) -> Iterable[tuple[Array, Array]]:
    """Ours and theirs, in the order of the rows."""
    theirs = view.theirs
    for column in range(ours.tau.shape[1]):
        yield ours.tau[0, column, None], theirs.tau[0, column, None]
    for key in (key for key in LINK_QUANTITIES if any(row.quantity == key for row in view.rows)):
        yield from zip(getattr(ours, key)[0], getattr(theirs, key)[0], strict=True)


def _verdict(agrees: bool, result: Validation, console: Console) -> None:
    if agrees:
        told = f"all of {result.n_states:,} states x {len(result.rows)} rows within rounding"
    else:
        bad = [row for row in result.rows if not row.passed]
        told = f"{len(bad)} of {len(result.rows)} rows beyond rounding, first {bad[0].quantity} at {bad[0].at}"
        told += against(result, bad[0])
    console.print(word(agrees), Text(f"{told} ({result.seconds:.1f} s)"))


def _numbers(x: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ")"
