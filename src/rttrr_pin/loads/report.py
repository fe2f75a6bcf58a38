"""Loads as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.loads.bearings import PARTS
from rttrr_pin.loads.parts import BearingLoad, JointLoad, Level, Peak
from rttrr_pin.loads.results import LoadReport
from rttrr_pin.reporting.results import counted

JOINTS = ("", "peak tau", "rms", "cubic", "used", "peak speed", "used")
"""The table of joints: how much of a limit is used stands behind what it limits."""

NAME = 9
"""Characters of a name that stand in a line, at least, however wide the numbers are."""


def show_loads(report: LoadReport, console: Console, full: bool = False) -> None:
    """The verdict, what drives each joint and what each bearing carries at their peaks, and what to know of it.

    Args:
        report: the loads.
        console: where to print.
        full: whether to show means, times and states too.
    """
    console.print(_word(report.passed), Text(report.verdict()), soft_wrap=True)
    rows = f"{report.rows:,} row{'' if report.rows == 1 else 's'}, {report.seconds:.6g} s, payload {report.payload}"
    console.print(Text(f"{report.robot} along {report.trajectory}:", "bold"), Text(rows), soft_wrap=True)
    console.print(_joints(report.joints))
    for joint in report.joints:
        _show_gear(joint, console)
    if report.bearings:
        console.print(_all_of_bearings(report.bearings) if full else _bearings(report.bearings))
    if full:
        _show_more(report, console)
    for line in _remarks(report):
        console.print(Text(line, "dim"), soft_wrap=True)
    if report.outputs:
        console.print(Text(f"written: {', '.join(report.outputs)}"), soft_wrap=True)


def _joints(joints: Sequence[JointLoad]) -> Table:
    table = _table(*JOINTS, words=1)
    for joint in joints:
        tau = joint.tau
        table.add_row(
            Text(joint.name),
            f"{_banded(tau.peak)} {joint.unit}",
            f"{tau.rms:.4g}",
            f"{tau.cubic_mean:.4g}",
            _used(joint.effort_margin, "effort" in joint.exceeded),
            f"{joint.speed.value:.4g} {joint.speed_unit}",
            _used(joint.velocity_margin, "velocity" in joint.exceeded),
        )
    return table


def _banded(peak: Peak) -> str:
    """A peak, and half the width of its band where there is one."""
    return f"{peak.value:.4g}" + ("" if peak.error is None else f" ±{peak.error:.2g}")


def _used(margin: float, exceeded: bool) -> Text:
    """How much of a limit is taken; nothing where there is none."""
    if margin == 1.0:
        return Text("-")
    taken = 100 * (1 - margin)
    return Text(f"{taken:.0f} %" if taken < 1e4 else f"{taken:.1e} %", "bold red" if exceeded else "")


def _show_gear(joint: JointLoad, console: Console) -> None:
    gear = joint.gear
    if gear is not None:
        torque = "none" if joint.gear_torque is None else f"{joint.gear_torque:.4g} N m"
        line = f"mean input speed {gear.mean_input_speed:.4g} rpm, cubic-mean torque {torque} by speed and time"
        console.print(Text(f"gear of {joint.name}: L10 {gear.l10:.3g} h, L50 {gear.l50:.3g} h; {line}"), soft_wrap=True)


def _bearings(bearings: Sequence[BearingLoad]) -> Table:
    """The peaks of each joint; their bands are in the whole table."""
    heads = [f"{name} [{getattr(bearings[0], name).unit}]" for name in PARTS]
    table = _table("", "", *heads, words=2)
    for own in bearings:
        table.add_row(Text(own.joint), own.kind, *(f"{getattr(own, name).peak.value:.4g}" for name in PARTS))
    return table


def _table(*heads: str, words: int) -> Table:
    """A table whose first columns are words, and names in the first of them; the others are numbers."""
    table = Table(*heads, box=None)
    table.columns[0].overflow = "fold"
    table.columns[0].min_width = NAME
    for column in table.columns[words:]:
        column.justify = "right"
        column.no_wrap = True
    return table


def _all_of_bearings(bearings: Sequence[BearingLoad]) -> Table:
    """Peaks with their times, and means."""
    table = _table("", "", "peak", "at [s]", "rms", "cubic", words=2)
    for own in bearings:
        for name in PARTS:
            level: Level = getattr(own, name)
            peak = f"{_banded(level.peak)} {level.unit}"
            numbers = (f"{x:.4g}" for x in (level.rms, level.cubic_mean))
            table.add_row(Text(f"{own.joint} ({own.kind})"), name, peak, f"{level.peak.time:.6g}", *numbers)
    return table


def _show_more(report: LoadReport, console: Console) -> None:
    """What the table of joints has no room for, and the states that matter."""
    for joint in report.joints:
        at_joint = f"mean speed {joint.mean_speed:.4g} {joint.speed_unit}, {counted(joint.reversals, 'reversal')}"
        power = f"power {_banded(joint.power)} W at {joint.power.time:.6g} s"
        work = f"the drive gives {joint.energy_in:.4g} J and takes back {joint.energy_back:.4g} J"
        torque = "stands still"
        if joint.gear_torque is not None:
            torque = f"cubic mean by speed and time {joint.gear_torque:.4g} {joint.unit}"
        line = f"{joint.name}: peak tau at {joint.tau.peak.time:.6g} s; {torque}; {at_joint}; {power}; {work}"
        console.print(Text(line), soft_wrap=True)
    for state in report.states:
        console.print(Text(f"{report.place} {state.row}, {state.time:.6g} s: {state.name}", "dim"), soft_wrap=True)


def _remarks(report: LoadReport) -> list[str]:
    lines = [] if report.differentiation is None else [report.differentiation.summary()]
    if report.band:
        lines.append("± and columns that end with _error are half the width of a band of 95 percent")
    doubtful = [joint.name for joint in report.joints if joint.doubtful]
    if doubtful:
        lines.append(f"with its band the peak may exceed the effort limit: {', '.join(doubtful)}")
    return [*lines, *report.notes, *(finding.sentence for finding in report.findings)]


def _word(passed: bool) -> Text:
    return Text("PASS", "bold green") if passed else Text("FAIL", "bold red")
