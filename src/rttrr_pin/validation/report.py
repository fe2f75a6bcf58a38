"""Validations as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import STANDARD_GRAVITY
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.validation.compare import Row
from rttrr_pin.validation.ranking import ADJUDICATED

if TYPE_CHECKING:  # other features have `drawn` and `word` from here
    from rttrr_pin.exact import Adjudication, Assessment, Deviation
    from rttrr_pin.implementations import Evaluation
    from rttrr_pin.validation.run import Validation
    from rttrr_pin.validation.search import WorstCase  # loads scipy
    from rttrr_pin.validation.state import StateComparison, StateReport

LEGEND = (
    "relative: of |reference|, where that is not rounding itself; error / tolerance: 1 is all that rounding can explain"
)


def show_validation(result: Validation, console: Console, rerun: str = "", full: bool = False) -> None:
    """The worst of each quantity (or, in full, of each joint and link), the verdict, and who is nearer the truth.

    Args:
        result: the outcome.
        console: where to print.
        rerun: the words of a command that shows one state, up to the state's number.
        full: whether to show a row for each joint and link.
    """
    states = drawn(result.n_states, result.sampling, result.seed)
    header = f"{result.subject} against {result.reference}: {states}, payload {result.payload}{unusual(result)}"
    console.print(Text(f"{result.robot}:", "bold"), Text(header))
    places = _places(result)
    console.print(_table(result, places if full else _worst_of_each_quantity(places)))
    for line in (*result.notes, LEGEND, *([] if full else [f"the worst of {len(places)} rows; --full shows all"])):
        console.print(Text(line, "dim"), soft_wrap=True)
    _show_verdict(result, console)
    _show_adjudications(result, console)
    if rerun:
        worst = result.worst
        at = f"worst state {worst.of_tolerance.state} ({worst.quantity} at {worst.at}{_reference_of(result, worst)})"
        console.print(Text(f"{at}, in full: {rerun} {worst.of_tolerance.state}"), soft_wrap=True)


def drawn(n_states: int, sampling: str, seed: int) -> str:
    """How many states, and where they come from."""
    return f"{n_states:,} " + ("states of the table" if sampling == "table" else f"{sampling} states, seed {seed}")


Place = tuple[str, str, dict[int, Row]]
"""A quantity, a link or joint, and what was seen there, by the number of the reference."""


def _places(result: Validation) -> list[Place]:
    """All places, quantity by quantity."""
    places: dict[tuple[str, str], dict[int, Row]] = {}
    for number, reference in enumerate(result.references):
        for row in reference.rows:
            places.setdefault((row.quantity, row.at), {})[number] = row
    return sorted(((*place, rows) for place, rows in places.items()), key=lambda place: QUANTITIES.index(place[0]))


def _worst_of_each_quantity(places: Sequence[Place]) -> list[Place]:
    def of_tolerance(place: Place) -> float:
        return max(row.of_tolerance.value for row in place[2].values())

    return [max(group, key=of_tolerance) for _, group in groupby(places, key=lambda place: place[0])]


def _table(result: Validation, places: Sequence[Place]) -> Table:
    """A row for each place: all numbers of one reference, or error / tolerance of each of several."""
    alone = len(result.references) == 1
    heads = [f"{reference.name}: error / tolerance" for reference in result.references]
    if alone:
        heads = ["worst error", "relative (eps)", "error / tolerance", "at state"]
    table = Table(Column("", no_wrap=alone), Column("at", overflow="fold" if alone else "ellipsis"), box=None)
    for head in heads:
        table.add_column(head, justify="right", no_wrap=alone)
    table.add_column("", no_wrap=alone)
    grouped = len({place[0] for place in places}) < len(places)
    previous = ""
    for quantity, at, rows in places:
        if grouped and previous not in ("", quantity):
            table.add_row()
        cells = _numbers_of(rows[0]) if alone else [_cell(rows.get(k)) for k in range(len(heads))]
        passed = all(row.passed for row in rows.values())
        table.add_row("" if quantity == previous else quantity, Text(at), *cells, word(passed))
        previous = quantity
    return table


def _numbers_of(row: Row) -> list[str]:
    """The four numbers of a row; where both are the same bits in every state there is no worst one."""
    if row.absolute.value == 0.0:
        return ["equal", "", "", ""]
    error = f"{row.absolute.value:.1e} {row.unit}"
    return [
        error,
        in_eps(row.relative.value) if row.relative.value else "-",
        ratio(row.of_tolerance.value),
        str(row.of_tolerance.state),
    ]


def _cell(row: Row | None) -> Text:
    """What one reference makes of a place; where it fails, it says so."""
    if row is None:
        return Text("")
    if row.absolute.value == 0.0:
        return Text("equal")
    cell = Text(ratio(row.of_tolerance.value))
    return cell if row.passed else cell.append(" ").append_text(word(False))


def ratio(value: float) -> str:
    """Error over tolerance, or over a bound."""
    return f"{value:.3f}" if value < 1e4 else f"{value:.1e}"


def in_eps(value: float) -> str:
    """A relative error in eps."""
    return f"{value:.1f}" if value < 1e5 else f"{value:.1e}"


def word(passed: bool) -> Text:
    """PASS or FAIL."""
    return Text("PASS", "bold green") if passed else Text("FAIL", "bold red")


def unusual(result: Validation) -> str:
    """What is not as by default: base, gravity, joint friction and armature."""
    parts = ["floating base"] if result.base == "floating" else []
    if result.gravity != STANDARD_GRAVITY:
        parts.append(f"gravity {_short(np.array(result.gravity))} m/s^2")
    if result.effects:
        parts.append(f"friction and armature of {len(result.effects)} joints")
    return "".join(f", {part}" for part in parts)


def _reference_of(result: Validation, row: Row) -> str:
    """Where there are several references, which one a row is of."""
    if len(result.references) == 1:
        return ""
    return next(f" against {other.name}" for other in result.references if any(row is seen for seen in other.rows))


def _show_verdict(result: Validation, console: Console) -> None:
    if result.passed:
        verdict = f"all of {result.n_states:,} states x {len(result.rows)} rows within rounding"
    else:
        bad = [row for row in result.rows if not row.passed]
        verdict = f"{len(bad)} of {len(result.rows)} rows beyond rounding, first {bad[0].quantity} at {bad[0].at}"
        verdict += _reference_of(result, bad[0])
    console.print(word(result.passed), Text(f"{verdict} ({result.seconds:.1f} s)"))


def _show_adjudications(result: Validation, console: Console) -> None:
    """Each failing state that the exact reference decided, and the worst passing one."""
    shown = min(result.failing, ADJUDICATED)
    if shown:
        which = f"the {shown} worst of " if shown < result.failing else ""
        console.print(Text(f"checked in interval arithmetic, {which}{result.failing:,} failing states:"))
    for number, one in enumerate(result.adjudications):
        head = f"worst state {one.state}, checked in interval arithmetic"
        if shown:
            head = f"  state {one.state}" if number < shown else f"  worst passing state {one.state}"
        console.print(Text(f"{head}: {who_is_right(one, passed=number >= shown)}"), soft_wrap=True)


def who_is_right(adjudication: Adjudication, passed: bool = False) -> str:
    """Which programs are within rounding, and where the others are wrong first.

    In a state that `passed`, one that is not within its own rounding is so near the other that both together allow it.
    """
    right = ", ".join(f"{one.name} {_off(one.farthest)}" for one in adjudication.right)
    wrong = "; ".join(_wrong(one, passed) for one in adjudication.wrong)
    if not wrong:
        every = "both are" if len(adjudication.right) == 2 else "all are"
        return f"{every} within rounding ({right})"
    return f"within rounding: {right}; {wrong}" if right else f"no program is within rounding: {wrong}"


def _wrong(assessment: Assessment, passed: bool) -> str:
    first = assessment.first_wrong or assessment.farthest
    if passed:
        times = f"{ratio(first.of_allowance)} of what its own rounding explains"
        return f"{assessment.name} is off by {_off(first)}, {times} and within what that of both does"
    return f"{assessment.name} is wrong by {_off(first)}, first there"


def _off(deviation: Deviation) -> str:
    """How far off, and where: in eps of the true value, or in its unit where that is zero to rounding."""
    size = f"{in_eps(deviation.eps)} eps" if deviation.relative else f"{deviation.error:.1e} {deviation.unit}"
    return (
        f"{size} at {deviation.quantity} of {deviation.at}{'' if deviation.relative else ', which is zero to rounding'}"
    )


def show_state(report: StateReport, console: Console) -> None:
    """One state: its coordinates, then each quantity, the subject beside each reference."""
    others = ", ".join(one.reference for one in report.comparisons)
    console.print(Text(f"{report.robot}:", "bold"), Text(f"state {report.index}: {report.subject} against {others}"))
    console.print(_coordinates_table(report))
    for load in report.batch.loads:
        axes = "base axes" if load.in_base else "link axes"
        f, n = _short(load.f.ravel()), _short(load.n.ravel())
        console.print(Text(f"payload at {report.links[load.link]}, {axes}: f {f} N, n {n} N m"))
    for one in report.comparisons:
        if len(report.comparisons) > 1:
            console.print(Text(f"{report.subject} against {one.reference}", "bold"))
        _show_comparison(report, one, console)
    for note in report.notes:
        console.print(Text(note, "dim"), soft_wrap=True)
    line = (
        f"checked in intervals of {report.adjudication.bits} bits: {who_is_right(report.adjudication, report.passed)}"
    )
    console.print(Text(line), soft_wrap=True)


def _show_comparison(report: StateReport, comparison: StateComparison, console: Console) -> None:
    table = Table("", "subject", "reference", "error", "relative (eps)", "", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.columns[0].overflow = "fold"
    for column in table.columns[1:5]:
        column.justify = "right"
        column.no_wrap = True
    previous = ""
    values = (_by_row(side, comparison.rows) for side in (report.result, comparison.result))
    for row, one, subject, reference in zip(comparison.rows, comparison.differences, *values, strict=True):
        if row.quantity != previous:
            table.add_section()
            table.add_row(Text(row.quantity if row.quantity == "tau" else f"{row.quantity} [{row.unit}]", "bold"))
        previous = row.quantity
        table.add_row(
            Text(f"{row.at} [{row.unit}]" if row.quantity == "tau" else row.at),
            *("\n".join(f"{x:.15g}" for x in side) for side in (subject, reference)),
            f"{one.error[0]:.1e}",
            in_eps(one.relative[0]) if one.known[0] or not one.error[0] else "-",
            word(bool(one.of_tolerance[0] <= 1.0)),
        )
    console.print(table)
    ratios = [float(one.of_tolerance[0]) for one in comparison.differences]
    worst = comparison.rows[int(np.argmax(ratios))]
    closest = f"largest error / tolerance: {ratio(max(ratios))} in {worst.quantity} at {worst.at}"
    console.print(word(comparison.passed), Text(closest))


def _by_row(evaluation: Evaluation, rows: Sequence[Row]) -> list[Array]:
    """The numbers of one state, row by row; the rows of a quantity are in the order of its array."""
    quantities = dict.fromkeys(row.quantity for row in rows)
    return [np.atleast_1d(x) for quantity in quantities for x in evaluation.values[quantity][0]]


def _coordinates_table(report: StateReport) -> Table:
    """q, v, a by name; of a floating joint q has other names than v, a, and stands apart."""
    alike = report.q_names == report.v_names
    names = "qva" if alike else "va"
    q, *others = ([f"{value:.17g}" for value in getattr(report.batch, name)[0]] for name in "qva")
    table = Table("joint", *names)
    for label, *numbers in zip(report.v_names, *([q] if alike else []), *others, strict=True):
        table.add_row(Text(label), *numbers)
    if not alike:
        table.add_section()
        for label, value in zip(report.q_names, q, strict=True):
            table.add_row(Text(f"q of {label}"), value)
    return table


def _short(x: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ")"


def show_search(worst: WorstCase, console: Console) -> None:
    """What a search came to, beside what chance had come to."""
    console.print(word(worst.passed), Text(worst.summary().partition(" ")[2]), soft_wrap=True)
    for note in worst.notes:
        console.print(Text(note, "dim"), soft_wrap=True)
