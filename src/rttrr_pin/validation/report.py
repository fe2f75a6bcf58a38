"""Validations as text for a terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import STANDARD_GRAVITY
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.exact import Adjudication, Assessment, Deviation
from rttrr_pin.implementations import Evaluation
from rttrr_pin.validation.compare import ADJUDICATED, Row
from rttrr_pin.validation.many import Entry, Task
from rttrr_pin.validation.run import Validation
from rttrr_pin.validation.state import StateComparison, StateReport

if TYPE_CHECKING:
    from rttrr_pin.validation.search import WorstCase  # loads scipy

LEGEND = "relative: of |reference|; error / tolerance: 1 is all that rounding can explain"


def show_validation(result: Validation, console: Console, rerun: str = "", full: bool = False) -> None:
    """The worst of each quantity (or, in full, of each joint and link), the verdict, and who is nearer the truth.

    Args:
        result: the outcome.
        console: where to print.
        rerun: the words of a command that shows one state, up to the state's number.
        full: whether to show a row for each joint and link.
    """
    states = "states of the table" if result.sampling == "table" else f"{result.sampling} states, seed {result.seed}"
    console.print(
        Text(result.robot, "bold"),
        Text(
            f"{result.subject} against {result.reference}: {result.n_states:,} {states}, payload {result.payload}"
            f"{_unusual(result)}"
        ),
    )
    grouped = _places(result)
    shown = grouped if full else _worst_places(grouped)
    console.print(_several_table(result, shown) if len(result.references) > 1 else _table(shown))
    for line in (*result.notes, LEGEND, *([] if full else [f"the worst of {len(grouped)} rows; --full shows all"])):
        console.print(Text(line, "dim"), soft_wrap=True)
    _show_verdict(result, console)
    _show_adjudications(result, console)
    worst = result.worst
    if worst is not None and rerun:
        at = f"worst state {worst.of_tolerance.state} ({worst.quantity} at {worst.at}{_reference_of(result, worst)})"
        console.print(Text(f"{at}, in full: {rerun} {worst.of_tolerance.state}"), soft_wrap=True)


@dataclass(frozen=True, slots=True)
class _Place:
    """One quantity at one link or joint: what was seen there, reference by reference; None where it is not compared."""

    quantity: str
    at: str
    rows: tuple[Row | None, ...]

    @property
    def compared(self) -> list[Row]:
        """The rows that there are."""
        return [row for row in self.rows if row is not None]

    @property
    def of_tolerance(self) -> float:
        """The largest error / tolerance."""
        return max(row.of_tolerance.value for row in self.compared)


def _places(result: Validation) -> list[_Place]:
    """All places, quantity by quantity."""
    by_reference = [{(row.quantity, row.at): row for row in other.rows} for other in result.references]
    keys = dict.fromkeys(key for rows in by_reference for key in rows)
    ordered = sorted(keys, key=lambda key: QUANTITIES.index(key[0]))
    return [_Place(*key, tuple(rows.get(key) for rows in by_reference)) for key in ordered]


def _worst_places(places: Sequence[_Place]) -> list[_Place]:
    """The worst place of each quantity."""
    groups = [[place for place in places if place.quantity == key] for key in QUANTITIES]
    return [max(group, key=lambda place: place.of_tolerance) for group in groups if group]


def _table(places: Sequence[_Place]) -> Table:
    table = Table("", "at", "worst error", "relative (eps)", "error / tolerance", "at state", "", box=None)
    for column in table.columns:
        column.no_wrap = True
    for column in table.columns[2:6]:
        column.justify = "right"
    table.columns[1].overflow = "fold"
    table.columns[1].no_wrap = False
    _add_rows(table, places, lambda place: (*_numbers_of(place.compared[0]), word(place.compared[0].passed)))
    return table


def _several_table(result: Validation, places: Sequence[_Place]) -> Table:
    heads = [f"{other.name}: error / tolerance" for other in result.references]
    table = Table("", "at", *heads, "", box=None)
    for column in table.columns[2:-1]:
        column.justify = "right"
    _add_rows(
        table,
        places,
        lambda place: (*map(_cell, place.rows), word(all(row.passed for row in place.compared))),
    )
    return table


def _add_rows(table: Table, places: Sequence[_Place], cells: Any) -> None:
    """A row for each place; the quantity stands at the first of its group."""
    several = len({place.quantity for place in places}) < len(places)
    previous = ""
    for place in places:
        if previous and place.quantity != previous and several:
            table.add_row()
        table.add_row(place.quantity if place.quantity != previous else "", Text(place.at), *cells(place))
        previous = place.quantity


def _numbers_of(row: Row) -> tuple[str, str, str, str]:
    """The four numbers of a row; where both are the same bits in every state there is no worst one."""
    if row.absolute.value == 0.0:
        return "equal", "", "", ""
    error = f"{row.absolute.value:.1e} {row.unit}"
    return error, _in_eps(row.relative.value), _ratio(row.of_tolerance.value), str(row.of_tolerance.state)


def _cell(row: Row | None) -> Text:
    """What one reference makes of a place; where it fails, it says so."""
    if row is None:
        return Text("")
    if row.absolute.value == 0.0:
        return Text("equal")
    cell = Text(_ratio(row.of_tolerance.value))
    return cell if row.passed else cell.append(" ").append_text(word(False))


def _ratio(value: float) -> str:
    return f"{value:.3f}" if value < 1e4 else f"{value:.1e}"


def _in_eps(value: float) -> str:
    return f"{value:.1f}" if value < 1e5 else f"{value:.1e}"


def word(passed: bool) -> Text:
    """PASS or FAIL."""
    return Text("PASS", "bold green") if passed else Text("FAIL", "bold red")


def _unusual(result: Validation) -> str:
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
        passing = "  worst passing state" if shown else "worst state"
        check = "" if shown else ", checked in interval arithmetic"
        head = f"  state {one.state}" if number < shown else f"{passing} {one.state}{check}"
        console.print(Text(f"{head}: {who_is_right(one)}"), soft_wrap=True)


def who_is_right(adjudication: Adjudication) -> str:
    """Which programs are within rounding, and where the others are wrong first."""
    right = ", ".join(f"{one.name} {_eps(one.farthest)}" for one in adjudication.right)
    wrong = "; ".join(_wrong(one) for one in adjudication.wrong)
    if not adjudication.wrong:
        every = "both are" if len(adjudication.right) == 2 else "all are"
        return f"{every} within rounding ({right})"
    if not adjudication.right:
        return f"no program is within rounding: {wrong}"
    return f"within rounding: {right}; {wrong}"


def _wrong(assessment: Assessment) -> str:
    first = assessment.first_wrong or assessment.farthest
    return f"{assessment.name} is wrong by {_eps(first)}, first there"


def _eps(deviation: Deviation) -> str:
    """How far off, and where."""
    return f"{_in_eps(deviation.eps)} eps at {deviation.quantity} of {deviation.at}"


def show_state(report: StateReport, console: Console) -> None:
    """One state: its coordinates, then each quantity, the subject beside each reference."""
    others = ", ".join(one.reference for one in report.comparisons)
    console.print(Text(report.robot, "bold"), Text(f"state {report.index}: {report.subject} against {others}"))
    console.print(_coordinates_table(report))
    for load in report.batch.loads:
        axes = "base axes" if load.in_base else "link axes"
        f, n = _short(load.f.ravel()), _short(load.n.ravel())
        console.print(Text(f"payload at {report.links[load.link]}, {axes}: f {f} N, n {n} N m"))
    for one in report.comparisons:
        if len(report.comparisons) > 1:
            console.print(Text(f"{report.subject} against {one.reference}", "bold"))
        _show_comparison(report, one, console)
    line = f"checked in intervals of {report.adjudication.bits} bits: {who_is_right(report.adjudication)}"
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
            "\n".join(f"{x:.15g}" for x in subject),
            "\n".join(f"{x:.15g}" for x in reference),
            f"{one.error[0]:.1e}",
            _in_eps(one.relative[0]),
            word(bool(one.of_tolerance[0] <= 1.0)),
        )
    console.print(table)
    ratios = [float(one.of_tolerance[0]) for one in comparison.differences]
    worst = comparison.rows[int(np.argmax(ratios))]
    closest = f"largest error / tolerance: {_ratio(max(ratios))} in {worst.quantity} at {worst.at}"
    console.print(word(comparison.passed), Text(closest))


def _by_row(evaluation: Evaluation, rows: Iterable[Row]) -> list[Array]:
    """The numbers of one state, row by row."""
    arrays: dict[str, list[Array]] = {key: list(np.atleast_1d(x[0])) for key, x in evaluation.values.items()}
    positions = Counter[str]()
    numbers = []
    for row in rows:
        numbers.append(np.atleast_1d(arrays[row.quantity][positions[row.quantity]]))
        positions[row.quantity] += 1
    return numbers


def _coordinates_table(report: StateReport) -> Table:
    """q, v, a by name; of a floating joint q has other names than v, a, and stands apart."""
    numbers = {name: [f"{value:.17g}" for value in getattr(report.batch, name)[0]] for name in "qva"}
    alike = report.q_names == report.v_names
    table = Table("joint", *("qva" if alike else "va"))
    for j, label in enumerate(report.v_names):
        table.add_row(Text(label), *(numbers[name][j] for name in ("qva" if alike else "va")))
    if not alike:
        table.add_section()
        for label, value in zip(report.q_names, numbers["q"], strict=True):
            table.add_row(Text(f"q of {label}"), value)
    return table


def _short(x: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in x) + ")"


def show_search(worst: WorstCase, console: Console) -> None:
    """What a search came to, beside what chance had come to."""
    verdict, _, sentence = worst.summary().partition(" ")
    console.print(word(verdict == "PASS"), Text(sentence), soft_wrap=True)


LOOK = {"agree": ("PASS", "bold green"), "disagree": ("FAIL", "bold red"), "unusable": ("FILE", "bold yellow")}


def show_many(entries: Sequence[Entry], task: Task, seconds: float, console: Console) -> None:
    """A row for each robot, then what stops those that were not compared, then the sum."""
    bases = len({entry.base for entry in entries})
    console.print(
        Text(
            f"{len(entries) // bases} robots, {task.subject} against {task.reference}: {task.n_states:,} "
            f"{task.sampling} states each, seed {task.seed}"
        )
    )
    table = Table("robot", "base", "joints", "links", "relative (eps)", "error / tolerance", "verdict")
    for column in table.columns[2:6]:
        column.justify = "right"
    for entry in entries:
        numbers = (str(entry.joints), str(entry.links), _in_eps(entry.eps), _ratio(entry.of_tolerance))
        table.add_row(Text(entry.name), entry.base, *(numbers if entry.links else [""] * 4), Text(*LOOK[entry.verdict]))
    console.print(table)
    console.print(Text("relative: worst normwise error over all links", "dim"))
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
