"""A program's way through the levels as one HTML page."""

from __future__ import annotations

import math

from rttrr_pin.conformance.levels import LEVELS
from rttrr_pin.conformance.report import HEADS, HISTOGRAM, cells, counts, legend, said
from rttrr_pin.conformance.results import Conformance
from rttrr_pin.reporting.html import Bars, Page, Rows, by_decades, of_longest, points
from rttrr_pin.reporting.results import counted


def conformance_page(result: Conformance) -> Page:
    """What the page says."""
    asked = f"judged in {result.precision}, {counted(result.n_states, 'state')} each, seed {result.seed}"
    why = (f"{text} ({', '.join(ids)})" for text, ids in said(result))
    levels = (f"{level.number} {level.id}: {level.sentence}" for level in LEVELS)
    return Page(
        title=result.subject,
        compared=f"{asked}; against proven values",
        verdict="PASS" if result.passed else "FAIL",
        tone="agrees" if result.standing.whole else "explained" if result.passed else "unexplained",
        sentence=result.claim(),
        blocks=(
            *points("What was not passed, and why", why),
            _levels(result),
            _histograms(result),
            *points("The levels", levels),
        ),
        notes=result.notes,
        command="conform",
    )


def _levels(result: Conformance) -> Rows:
    """A row for each level and robot, with error / bound as a bar."""
    ratios = [0.0 if own.worst is None else own.worst[1].of_allowance for own in result.results]
    lengths, one = by_decades(ratios)
    rows = []
    for own, ratio, length in zip(result.results, ratios, lengths, strict=True):
        told = f"{ratio:.2g} times what rounding can explain" if own.worst else own.outcome
        rows.append(Bars((own.outcome, *cells(own)), length, None, told))
    head = ("", *HEADS)
    return Rows("Levels", head, tuple(rows), f"{legend(result)}; bars: of bound, by powers of ten", 2, one)


def _histograms(result: Conformance) -> Rows:
    """How many errors are of which size, with the part that is within one eps as a bar."""
    rows = []
    for own in result.results:
        parts = [sum(part.histogram[:2]) / part.count if part.count else math.nan for part in own.quantities]
        for part, share, length in zip(own.quantities, parts, of_longest([*parts, 1.0]), strict=False):
            rows.append(Bars((own.id, part.quantity, *counts(part)), length, None, f"{share:.0%} within one eps"))
    head = ("level and robot", *HISTOGRAM)
    return Rows("Errors in eps", head, tuple(rows), "numbers with an error of up to so many eps; bars: up to one", 2)
