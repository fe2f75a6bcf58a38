"""The outcome of many robots: one table, or JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.validation import Entry, Task

LOOK = {"agree": ("PASS", "bold green"), "disagree": ("FAIL", "bold red"), "unusable": ("FILE", "bold yellow")}


def show_many(entries: Sequence[Entry], task: Task, seconds: float, console: Console) -> None:
    """A row for each robot, then what stops those that were not compared, then the sum."""
    bases = len({entry.base for entry in entries})
    console.print(
        Text(f"{len(entries) // bases} robots, {task.states:,} {task.sampling} states each, seed {task.seed}")
    )
    table = Table("robot", "base", "joints", "links", "in eps", "share", "verdict")
    for column in (2, 3, 4, 5):
        table.columns[column].justify = "right"
    for entry in entries:
        compared = entry.links > 0
        table.add_row(
            Text(entry.name),
            entry.base,
            str(entry.joints) if compared else "",
            str(entry.links) if compared else "",
            f"{entry.eps:.1f}" if compared else "",
            f"{entry.share:.3f}" if compared else "",
            Text(*LOOK[entry.verdict]),
        )
    console.print(table)
    console.print(Text("in eps: worst normwise error over all links; share: of what rounding can explain", "dim"))
    for name, defect in dict.fromkeys((entry.name, entry.defect) for entry in entries if entry.defect):
        console.print(Text(f"{name}: {defect}"), soft_wrap=True)
    for entry in entries:
        if entry.verdict == "disagree" and entry.worst:
            console.print(Text(f"{entry.name}, {entry.base} base: worst {entry.worst}"), soft_wrap=True)
    counts = Counter[str](entry.verdict for entry in entries)
    console.print(
        Text(
            f"{counts['agree']} agree, {counts['disagree']} disagree, {counts['unusable']} stopped by their file, "
            f"{len(entries)} in all ({seconds:.0f} s)"
        )
    )


def many_data(entries: Sequence[Entry], task: Task, seconds: float) -> dict[str, Any]:
    """The same as data."""
    counts = Counter[str](entry.verdict for entry in entries)
    return {
        **asdict(task),
        "verdicts": {verdict: counts[verdict] for verdict in LOOK},
        "entries": [asdict(entry) for entry in entries],
        "seconds": seconds,
    }
