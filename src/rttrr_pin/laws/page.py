"""The outcome of the laws as a page: what is violated first, then a row for each law."""

from __future__ import annotations

from rttrr_pin.laws.report import LEGEND
from rttrr_pin.laws.run import LawReport, LawRow
from rttrr_pin.reporting.html import Bars, Causes, Figures, Page, Rows, Said, by_decades, points, robot_drawing
from rttrr_pin.robot import Robot
from rttrr_pin.validation.report import drawn

LEAST = 1e-6
"""Where bars of error / bound begin."""


def laws_page(report: LawReport, robot: Robot) -> Page:
    """What the page says."""
    word, _, sentence = report.summary().partition(" ")
    worst = report.worst
    silent = [row.law.name for row in report.rows if not row.numbers]
    return Page(
        title=report.robot,
        compared=f"{report.subject}: laws of mechanics, {drawn(report.n_states, report.sampling, report.seed)}, "
        f"payload {report.payload}{', floating base' * (report.base == 'floating')}",
        verdict=word,
        tone="agrees" if report.passed else "unexplained",
        sentence=sentence,
        facts=(
            ("largest error / bound", f"{worst.error_over_bound.value:.3g}"),
            ("of", f"{worst.law.id} {worst.law.name}, state {worst.error_over_bound.state}"),
            ("laws violated", f"{len(report.violated)} of {len(report.rows)}"),
            ("time", f"{report.seconds:.1f} s"),
        ),
        blocks=(
            Causes(tuple(map(_violated, report.violated)), title="What is violated" * bool(report.violated)),
            _table(report),
            Figures("The robot", (robot_drawing(robot.model, title=f"{report.robot}, all coordinates zero"),)),
            *points("What the laws say", (f"{row.law.id} {row.law.name}: {row.law.statement}" for row in report.rows)),
            *points("Laws that say nothing of this robot", silent),
        ),
        notes=report.notes,
        command="laws",
    )


def _violated(row: LawRow) -> Said:
    worst = row.error_over_bound
    return Said(
        f"{row.law.id} {row.law.name}: {row.law.statement}",
        (
            ("violated in", f"{row.violations:,} states"),
            ("worst", f"{worst.value:.3g} times the bound, state {worst.state}"),
        ),
        tone="bad",
        word="VIOLATED",
    )


def _table(report: LawReport) -> Rows:
    rows = [row for row in report.rows if row.numbers]
    lengths, one = by_decades([row.error_over_bound.value for row in rows], LEAST)
    bars = []
    for row, length in zip(rows, lengths, strict=True):
        worst = row.error_over_bound
        exact = worst.value == 0.0
        numbers = ("exact", "") if exact else (f"{worst.value:.3g}", str(worst.state))
        cells = ("holds" if row.passed else "VIOLATED", row.law.id, row.law.name, *numbers, f"{row.violations or ''}")
        bars.append(Bars(cells, length, None, f"{worst.value:.3g} times the bound", "good" if row.passed else "bad"))
    legend = f"{LEGEND}, the dashed line; the bars count powers of ten from 1e-6"
    head = ("", "law", "", "error / bound", "at state", "violated in")
    return Rows("Law by law", head, tuple(bars), legend, texts=3, one=one)
