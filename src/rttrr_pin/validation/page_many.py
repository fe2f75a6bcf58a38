"""Validations of many robots as one page: a row for each, and what stops those that were not compared."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rttrr_pin.reporting.html import Bars, Page, Rows, by_decades, points
from rttrr_pin.validation.many import Entry, Task
from rttrr_pin.validation.page import LEAST, TOLERANCE
from rttrr_pin.validation.report import in_eps, ratio

WORDS = {"agree": ("PASS", "good"), "disagree": ("FAIL", "bad"), "unusable": ("FILE", "warn")}

HEAD = ("", "robot", "base", "joints", "links", "relative (eps)", "error / tolerance", "inspect: errors")


def many_page(entries: Sequence[Entry], task: Task, seconds: float) -> Page:
    """What the page says."""
    counts = Counter[str](entry.verdict for entry in entries)
    passed = counts["agree"] == len(entries)
    defects = dict.fromkeys(f"{entry.name}: {entry.defect}" for entry in entries if entry.defect)
    worst = (f"{x.name}, {x.base} base: {x.worst}" for x in entries if x.verdict == "disagree" and x.worst)
    notes = dict.fromkeys(f"{entry.name}: {note}" for entry in entries for note in entry.notes)
    robots = len({entry.name for entry in entries})
    return Page(
        title=f"{robots} robots",
        compared=f"{task.subject} against {task.reference}: {task.n_states:,} {task.sampling} states each, "
        f"seed {task.seed}",
        verdict="PASS" if passed else "FAIL" if counts["disagree"] else "FILE",
        tone="agrees" if passed else "unexplained" if counts["disagree"] else "explained",
        sentence=f"{counts['agree']} agree, {counts['disagree']} disagree, {counts['unusable']} stopped by their file, "
        f"{len(entries)} in all",
        facts=(
            ("robots", str(robots)),
            ("largest error / tolerance", ratio(max((x.of_tolerance for x in entries), default=0.0))),
            ("time", f"{seconds:.0f} s"),
        ),
        blocks=(
            *points("Where to look", worst),
            *points("What stops the others", defects),
            _table(entries),
            *points("Notes on files", notes),
        ),
        command="validate",
    )


def _table(entries: Sequence[Entry]) -> Rows:
    lengths, one = by_decades([entry.of_tolerance for entry in entries], LEAST)
    rows = []
    for entry, length in zip(entries, lengths, strict=True):
        word, tone = WORDS[entry.verdict]
        numbers = (str(entry.joints), str(entry.links), in_eps(entry.eps), ratio(entry.of_tolerance))
        cells = (word, entry.name, entry.base, *(numbers if entry.links else [""] * 4), str(entry.errors or ""))
        said = f"{entry.of_tolerance:.2g} times the tolerance" if entry.links else "not compared"
        rows.append(Bars(cells, length, None, said, tone))
    legend = f"relative: worst normwise error over all links; {TOLERANCE}"
    return Rows("Robot by robot", HEAD, tuple(rows), legend, texts=3, one=one)
