"""Validations as a page: the verdict, where to look, how far off in how many states, and every number by link."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.reporting.html import (
    Bars,
    Block,
    Chart,
    Figures,
    Page,
    Rows,
    by_decades,
    code,
    histogram,
    points,
    robot_drawing,
)
from rttrr_pin.reporting.results import counted
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Comparison, Row
from rttrr_pin.validation.histogram import EDGES
from rttrr_pin.validation.ranking import ADJUDICATED
from rttrr_pin.validation.report import drawn, in_eps, ratio, unusual, who_is_right
from rttrr_pin.validation.run import Validation
from rttrr_pin.validation.state import StateReport

TOLERANCE = (
    "error / tolerance: 1, at the dashed line, is all that rounding can explain; the bars count powers of ten from 1e-6"
)

HISTOGRAM = "Of each state the largest over all links or joints. Heights are logarithms, so that one state is seen."

LEAST = 1e-6
"""Where bars of error / tolerance begin."""


def validation_page(result: Validation, robot: Robot, worst: StateReport, commands: Sequence[str] = ()) -> Page:
    """What the page says.

    Args:
        result: the outcome.
        robot: that was compared.
        worst: its worst state in full.
        commands: that show more.
    """
    row = result.worst
    rows = len(result.rows)
    bad = [one for one in result.rows if not one.passed]
    within = f"all of {result.n_states:,} states x {counted(rows, 'row')} within rounding"
    beyond = (
        f"{len(bad)} of {counted(rows, 'row')} beyond rounding, in {result.failing:,} of {result.n_states:,} states"
    )
    states = drawn(result.n_states, result.sampling, result.seed)
    return Page(
        title=result.robot,
        compared=f"{result.subject} against {result.reference}: {states}, payload {result.payload}{unusual(result)}",
        verdict="PASS" if result.passed else "FAIL",
        tone="agrees" if result.passed else "unexplained",
        sentence=within if result.passed else beyond,
        facts=(
            ("largest error / tolerance", ratio(row.of_tolerance.value)),
            ("in", f"{row.quantity} at {row.at}, state {row.of_tolerance.state}"),
            ("states beyond the tolerance", f"{result.failing:,} of {result.n_states:,}"),
            ("time", f"{result.seconds:.1f} s"),
        ),
        blocks=(
            *points("Where to look", _where_to_look(result)),
            Figures("How far off, and the worst state", (*_histograms(result), _drawing(result, robot, worst))),
            *code("Commands that show more", "\n".join(commands)),
            *_state(worst),
            _by_link(result, robot),
            *_in_full(result),
            *points("What took part", (f"{name} {version}" for name, version in result.versions.items())),
        ),
        notes=result.notes,
        command="validate",
    )


def _where_to_look(result: Validation) -> Iterator[str]:
    """The first row that fails; then which program is right, in the states that exact arithmetic decided."""
    for reference in result.references:
        first = next((row for row in reference.rows if not row.passed), None)
        if first is not None:
            yield (
                f"The first row beyond rounding against {reference.name} is {first.quantity} at {first.at}: up to "
                f"{first.absolute.value:.3g} {first.unit}, in state {first.absolute.state}; beyond rounding in "
                f"{counted(first.failures, 'state')}"
            )
    decided = min(result.failing, ADJUDICATED)
    failing, passing = result.adjudications[:decided], result.adjudications[decided:]
    if len(failing) > 1:
        wrong = Counter(program.name for one in failing for program in one.wrong)
        said = ", ".join(f"{name} is wrong in {number}" for name, number in wrong.items()) or "no program is wrong"
        yield f"Of the {len(failing)} worst states, decided in interval arithmetic, {said}"
    for kind, some in (("the worst", failing[:1]), ("the worst within the tolerance", passing)):
        for one in some:
            is_passing = kind != "the worst"
            yield f"State {one.state}, {kind}, checked in interval arithmetic: {who_is_right(one, is_passing)}"


def _histograms(result: Validation) -> Iterator[Chart]:
    """One for each reference."""
    for number, reference in enumerate(result.references):
        several = len(result.references) > 1
        equal = [f"{own.zero:,} of {key}" for key, own in reference.histograms.items() if own.zero]
        same = f" Not in the picture, since equal in all bits: {', '.join(equal)}." if equal else ""
        yield histogram(
            f"errors-{number + 1}" if several else "errors",
            f"Error / tolerance against {reference.name}",
            EDGES,
            {key: own.counts for key, own in reference.histograms.items()},
            "error / tolerance",
            {"tolerance": 1.0},
            note=HISTOGRAM + same,
        )


def _drawing(result: Validation, robot: Robot, worst: StateReport) -> Chart:
    """The robot in its worst state, with the place and the forces across its joints."""
    values = worst.result.values
    return robot_drawing(
        robot.model,
        worst.batch.q[0],
        marked={result.worst.at},
        wrenches=values["f"][0] if "f" in values else None,
        name="worst-state",
        title=f"{result.robot} in state {worst.index}, the worst",
    )


def _state(worst: StateReport) -> Iterator[Block]:
    """q, v and a, and the payload."""
    q, v, a = ([f"{x:.6g}" for x in getattr(worst.batch, name)[0].tolist()] for name in "qva")
    title, head = f"State {worst.index}", ("", "q", "v", "a")
    if worst.q_names == worst.v_names:
        rows = [Bars(cells) for cells in zip(worst.v_names, q, v, a, strict=True)]
    else:
        rows = [Bars((name, x, "", "")) for name, x in zip(worst.q_names, q, strict=True)]
        rows += [Bars((name, "", *pair)) for name, *pair in zip(worst.v_names, v, a, strict=True)]
    loads = "; ".join(
        f"payload at {worst.links[load.link]}, {'base' if load.in_base else 'link'} axes: "
        f"f ({_triple(load.f.ravel().tolist())}) N, n ({_triple(load.n.ravel().tolist())}) N m"
        for load in worst.batch.loads
    )
    if rows:
        yield Rows(title, head, tuple(rows), f"rad, m and s{f'; {loads}' if loads else ''}", texts=1)


def _triple(values: Sequence[float]) -> str:
    return ", ".join(f"{x:.5g}" for x in values)


def _by_link(result: Validation, robot: Robot) -> Rows:
    """Error / tolerance of each quantity, the largest against any reference; tau stands with its joint's link."""
    ratios: dict[tuple[str, str], float] = {}
    for row in result.rows:
        key = row.quantity, row.at
        ratios[key] = max(ratios.get(key, 0.0), row.of_tolerance.value)
    quantities = [key for key in QUANTITIES if any(key == quantity for quantity, _ in ratios)]
    model = robot.model
    found = []
    for joint, link in zip(model.joints, model.links, strict=True):
        own = joint.v_labels() if joint.independent else []
        places = {key: [link.name] if key != "tau" else own for key in quantities}
        values = {key: [ratios[key, at] for at in where if (key, at) in ratios] for key, where in places.items()}
        cells = (f"{max(x):.2g}" if (x := values[key]) else "" for key in quantities)
        found.append(((link.name, joint.name, *cells), max((y for x in values.values() for y in x), default=0.0)))
    lengths, one = by_decades([largest for _, largest in found], LEAST)
    rows = tuple(
        Bars(cells, length, None, f"{largest:.2g} times the tolerance", "bad" if largest > 1.0 else "")
        for (cells, largest), length in zip(found, lengths, strict=True)
    )
    return Rows("Error / tolerance, link by link", ("link", "joint", *quantities), rows, TOLERANCE, one=one)


def _in_full(result: Validation) -> Iterator[Rows]:
    """Every row of each reference."""
    for reference in result.references:
        rows = sorted(reference.rows, key=lambda row: QUANTITIES.index(row.quantity))
        lengths, one = by_decades([row.of_tolerance.value for row in rows], LEAST)
        head = ("", "at", "verdict", "worst error", "relative (eps)", "error / tolerance", "at state", "states beyond")
        bars = tuple(_bars(row, length) for row, length in zip(rows, lengths, strict=True))
        title = f"Every row against {_label(reference)}"
        yield Rows(title, head, bars, TOLERANCE, texts=3, one=one)


def _label(reference: Comparison) -> str:
    return f"{reference.name} {reference.version}".rstrip()


def _bars(row: Row, length: float) -> Bars:
    word = "PASS" if row.passed else "FAIL"
    equal = row.absolute.value == 0.0
    error = "equal" if equal else f"{row.absolute.value:.2e} {row.unit}"
    relative = in_eps(row.relative.value) if row.relative.value else ""
    tail = ("", "") if equal else (ratio(row.of_tolerance.value), str(row.of_tolerance.state))
    cells = (row.quantity, row.at, word, error, relative, *tail, f"{row.failures:,}" if row.failures else "")
    said = f"{row.of_tolerance.value:.2g} times the tolerance"
    return Bars(cells, length, None, said, "" if row.passed else "bad")
