"""Diagnoses of logs as text for a terminal."""

from __future__ import annotations

from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from rttrr_pin.diagnosis.logs.log_diagnosis import JointResidual, LogDiagnosis

COLOURS = {"agrees": "bold green", "explained": "bold yellow", "unexplained": "bold red"}


def show_log(report: LogDiagnosis, console: Console) -> None:
    """The residual of each joint before and after, the causes, the verdict."""
    header = f"{report.log}: {report.rows:,} rows of {report.seconds:.3g} s, measured tau less that of the model"
    console.print(Text(report.robot, "bold"), Text(header))
    console.print(_table(report))
    for note in report.notes:
        console.print(Text(note, "dim"), soft_wrap=True)
    for number, cause in enumerate(report.causes, 1):
        console.print(Text(f"{number}. {cause.sentence} ({100 * cause.explains:.3g} %)"), soft_wrap=True)
        for other in cause.alternatives:
            console.print(Text(f"   or, as well: {other}"), soft_wrap=True)
    first = report.summary().partition("\n")[0]
    word, _, rest = first.partition(" ")
    console.print(Text(word, COLOURS[report.verdict]), Text(rest), soft_wrap=True)


def _table(report: LogDiagnosis) -> Table:
    right = [Column(head, justify="right", no_wrap=True) for head in ("rms", "largest", "of tau", "left", "noise")]
    table = Table(Column("joint", overflow="fold"), *right, Column("", no_wrap=True), box=None)
    for name, before in report.before.items():
        table.add_row(Text(name), *_cells(before, report.after[name]))
    return table


def _cells(before: JointResidual, after: JointResidual) -> list[str]:
    left = "" if after.at_noise else "more than noise"
    return [
        f"{before.rms:.3g}",
        f"{before.largest:.3g}",
        f"{100 * before.share:.3g} %",
        f"{after.rms:.3g}",
        f"{after.noise:.2g}",
        left,
    ]
