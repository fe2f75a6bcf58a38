"""A program's way through the levels as text for a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.conformance.levels import LEVELS
from rttrr_pin.conformance.results import BINS, Conformance, LevelResult, QuantityResult, Value
from rttrr_pin.reporting.results import counted
from rttrr_pin.validation.report import word

LEGEND = (
    "eps: the worst error in units of {eps} of the true vector, where that is more than rounding; of bound: 1 is all "
    "that rounding can explain; digits: the fewest true decimal digits of any number"
)

EPS = {"float64": "2^-52", "float32": "2^-23"}

STYLES = {"pass": "green", "fail": "bold red", "error": "bold red", "not offered": "dim"}

OF_BIN = ("0", *(f"{end:.0f}" for end in BINS[1:]), "more")
"""What the bins of a histogram are called, by their upper ends in eps."""


def show_conformance(result: Conformance, console: Console, full: bool = False) -> None:
    """A row for each level and robot, what failed and why, what is not offered, and how far the program gets.

    Args:
        result: the outcome.
        console: where to print.
        full: whether to show each quantity, with the histogram of its errors.
    """
    asked = f"judged in {result.precision}, {counted(result.n_states, 'state')} each, seed {result.seed}"
    console.print(Text(f"{result.subject}:", "bold"), Text(asked), soft_wrap=True)
    console.print(_table(result))
    for line in (*result.notes, legend(result)):
        console.print(Text(line, "dim"), soft_wrap=True)
    if full:
        for own in result.results:
            if own.quantities:
                console.print(Text(f"{own.id}, errors in eps:", "bold"))
                console.print(_histograms(own))
    for text, ids in said(result):
        console.print(Text(text, "bold"), Text(f"({', '.join(ids)})"), soft_wrap=True)
    sentence = Text(f"{result.claim()} ({result.seconds:.1f} s)")
    console.print(word(result.passed), sentence, soft_wrap=True)


def legend(result: Conformance) -> str:
    """What the numbers of the table are."""
    return LEGEND.format(eps=EPS[result.precision])


def said(result: Conformance) -> Iterator[tuple[str, list[str]]]:
    """Causes of failures, errors, refusals, each once with the cases it is said of."""
    groups: dict[str, list[str]] = {}
    for own in result.results:
        if not own.passed:
            text = own.cause or own.message or "numbers that rounding cannot explain"
            kind = {"fail": "fails", "error": "error"}.get(own.outcome, "not offered")
            groups.setdefault(f"{kind}: {text}", []).append(own.id)
    yield from groups.items()


def cells(own: LevelResult) -> tuple[str, ...]:
    """Level, robot where it is not called so, worst error in eps, where that is, error / bound, digits."""
    number = next(level.number for level in LEVELS if level.id == own.level)
    worst = own.worst if own.outcome == "fail" else own.farthest
    return (
        f"{number:2d} {own.level}{f', {own.robot}' if own.robot != own.level else ''}",
        "" if worst is None else _short(worst[1].eps),
        own.outcome if not own.quantities else "" if worst is None else place(*worst),
        "" if own.worst is None else _short(own.worst[1].of_allowance),
        "" if not own.quantities else "none" if math.isnan(own.digits) else f"{own.digits:.1f}",
    )


HEADS = ("level", "eps", "at, state", "of bound", "digits")
"""Of the columns of `cells`."""


def place(quantity: str, value: Value) -> str:
    """Where a number was seen, and in which state."""
    return f"{quantity} {value.at}, {value.state}"


def _table(result: Conformance) -> Table:
    table = Table(*HEADS, "", box=None, padding=(0, 2, 0, 0), pad_edge=False)
    for k in (1, 3, 4):
        table.columns[k].justify = "right"
    table.columns[0].no_wrap = True
    for own in result.results:
        verdict = Text("" if own.outcome == "not offered" else own.outcome.upper(), STYLES[own.outcome])
        table.add_row(*map(Text, cells(own)), verdict)
    return table


def _histograms(own: LevelResult) -> Table:
    """How many errors are of which size, quantity by quantity."""
    rows = [(part.quantity, *counts(part)) for part in own.quantities]
    kept = [k for k in range(len(HISTOGRAM)) if k == 0 or any(row[k] not in ("", "0") for row in rows)]
    table = Table(*(HISTOGRAM[k] for k in kept), box=None, padding=(0, 2, 0, 0), pad_edge=False)
    for column in table.columns[1:]:
        column.justify = "right"
    for row in rows:
        table.add_row(*(row[k] for k in kept))
    return table


HISTOGRAM = ("", "numbers", "median", *OF_BIN, "near 0", "beyond")
"""The columns of a histogram; near 0: true values that are rounding; beyond: what rounding cannot explain."""


def counts(part: QuantityResult) -> tuple[str, ...]:
    """How many numbers there are, their median in eps, how many in each bin, near zero and beyond rounding."""
    whole, *others = (f"{n:,}" for n in (part.count, *part.histogram, part.near_zero, part.failures))
    return (whole, _short(part.median), *others)


def _short(x: float) -> str:
    """A number of two digits, without an exponent where it is short."""
    if math.isnan(x):
        return ""
    return f"{x:.2g}" if abs(x) < 100 or abs(x) >= 1e5 else f"{x:.0f}"
