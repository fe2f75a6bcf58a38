"""Validations of many robots as text for a terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.validation.many import Entry, Task
from rttrr_pin.validation.report import in_eps, ratio, word

LOOK = {"agree": word(True), "disagree": word(False), "unusable": Text("FILE", "bold yellow")}


def show_many(entries: Sequence[Entry], task: Task, seconds: float, console: Console) -> None:
    """A row for each robot, then what stops those that were not compared, then the sum."""
    robots = len(entries) // len({entry.base for entry in entries})
    states = f"{task.n_states:,} {task.sampling} states each, seed {task.seed}"
    console.print(Text(f"{robots} robots, {task.subject} against {task.reference}: {states}"))
    table = Table("robot", "base", "joints", "links", "relative (eps)", "error / tolerance", "errors", "verdict")
    for column in table.columns[2:7]:
        column.justify = "right"
    for entry in entries:
        numbers = (str(entry.joints), str(entry.links), in_eps(entry.eps), ratio(entry.of_tolerance))
        errors = str(entry.errors or "")
        table.add_row(
            Text(entry.name), entry.base, *(numbers if entry.links else [""] * 4), errors, LOOK[entry.verdict]
        )
    console.print(table)
    console.print(Text("relative: worst normwise error over all links; errors: what inspect finds in the file", "dim"))
    defects = dict.fromkeys(f"{entry.name}: {entry.defect}" for entry in entries if entry.defect)
    worst = (entry for entry in entries if entry.verdict == "disagree" and entry.worst)
    notes = dict.fromkeys(f"{entry.name}: {note}" for entry in entries for note in entry.notes)
    for line in (*notes, *defects, *(f"{entry.name}, {entry.base} base: worst {entry.worst}" for entry in worst)):
        console.print(Text(line), soft_wrap=True)
    counts = Counter[str](entry.verdict for entry in entries)
    console.print(
        Text(
            f"{counts['agree']} agree, {counts['disagree']} disagree, {counts['unusable']} stopped by their file, "
            f"{len(entries)} in all ({seconds:.0f} s)"
        )
    )
