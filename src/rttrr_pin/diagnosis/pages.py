"""What the HTML pages of `diagnose` and `compare` say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rttrr_pin.diagnosis.descriptions.compare import Comparison
from rttrr_pin.diagnosis.descriptions.compare_report import LEGEND, percent, remarks, values_of
from rttrr_pin.diagnosis.descriptions.compare_report import compared as compared_robots
from rttrr_pin.diagnosis.logs.log_diagnosis import LogDiagnosis
from rttrr_pin.diagnosis.report import compared, place, sentence, told
from rttrr_pin.diagnosis.results import Cause, Diagnosis, Residual
from rttrr_pin.reporting import html
from rttrr_pin.reporting.html import (
    Bars,
    Causes,
    Figures,
    Page,
    Rows,
    Said,
    by_decades,
    code,
    of_longest,
    points,
    robot_drawing,
)
from rttrr_pin.robot import Robot

ALIKE = "The same results in all of these states would have"

AS_WELL = "Or, as well"

LOG_LEGEND = "N m or N; the bars: part of tau, the lower one with the causes"

OF_TOLERANCE = (
    "error / tolerance: 1, at the dashed line, is all that rounding and printed digits can explain; the bars count "
    "powers of ten"
)


TEST = "A state as simple as could be found, as a test"


Result = Diagnosis | LogDiagnosis | Comparison


def write_page(
    target: str | None, result: Result, figures: str | None = None, robots: Mapping[str, Robot] | None = None
) -> None:
    """A result as a page, to a file or, where that is "-", to stdout; with its robots, by their names, drawn."""
    html.write_page(lambda: _with_robots(page_of(result), result, robots or {}), target, figures)


def page_of(result: Result) -> Page:
    """What its page says."""
    if isinstance(result, Diagnosis):
        return diagnosis_page(result)
    return log_page(result) if isinstance(result, LogDiagnosis) else comparison_page(result)


def _with_robots(page: Page, result: Result, robots: Mapping[str, Robot]) -> Page:
    """The same behind its causes: each robot, all coordinates zero, with the links and joints of the causes marked."""
    causes = result.causes if isinstance(result, Diagnosis) else ()
    marked = {name for cause in causes for name in (cause.link, cause.joint) if name}
    charts = tuple(
        robot_drawing(robot.model, None, marked, name=f"robot-{k + 1}", title=f"{name}, all coordinates zero")
        for k, (name, robot) in enumerate(robots.items())
    )
    legend = "Marked: what the causes are about." if marked else ""
    causes_or_table, *others = page.blocks or (Causes(()),)
    drawn = [Figures("Where in the robot" if marked else "The robot", charts, legend)] if charts else []
    return replace(page, blocks=(causes_or_table, *drawn, *others))


def diagnosis_page(result: Diagnosis) -> Page:
    """Why a program differs from another."""
    others = ("; ".join(told(cause) for cause in other) for other in result.others)
    near = (f"{one.explains:.2%}: {one.sentence}" for one in result.near_misses)
    return Page(
        title=result.robot,
        compared=compared(result),
        verdict=result.verdict.upper(),
        tone=result.verdict,
        sentence=sentence(result),
        blocks=(
            Causes(tuple(map(_said, result.causes)), ALIKE),
            *_differences(result.residuals, result.verdict == "explained"),
            *points("Other causes that these states do not tell from it", others),
            *points("What the difference depends on", result.dependence),
            *points("What comes nearest, and how much of the difference it explains", near),
            *code(TEST, result.counterexample),
        ),
        notes=result.notes,
        command="diagnose",
    )


def _said(cause: Cause) -> Said:
    facts = [("repair", cause.repair), ("see", place(cause))]
    alternatives = tuple(other.sentence for other in cause.alternatives)
    return Said(f"{cause.program}: {told(cause)}", tuple(own for own in facts if own[1]), alternatives)


def _differences(rows: Sequence[Residual], explained: bool) -> tuple[Rows, ...]:
    """Every joint and link, with what is left."""
    ratios = [own.of_tolerance_before for own in rows]
    left = [own.of_tolerance_after for own in rows]
    lengths, one = by_decades([*ratios, *left])
    head = ("", "at", "rms expected", "largest difference", "error / tolerance", *(["with the causes"] * explained))
    bars = []
    for k, own in enumerate(rows):
        numbers = (f"{own.size:.4g} {own.unit}", f"{own.before:.3g} {own.unit}", f"{own.of_tolerance_before:.2g}")
        after = f"{own.of_tolerance_after:.2g}"
        said = f"{own.of_tolerance_before:.2g} times the tolerance{f', {after} with the causes' if explained else ''}"
        cells = (own.quantity, own.at, *numbers, *([after] * explained))
        bars.append(Bars(cells, lengths[k], lengths[len(rows) + k] if explained else None, said))
    title = "Differences before and after" if explained else "Differences"
    legend = f"{OF_TOLERANCE}{', the lower one with the causes' * explained}"
    return (Rows(title, head, tuple(bars), legend, one=one),) if bars else ()


def log_page(report: LogDiagnosis) -> Page:
    """What a log says of a model."""
    word, _, rest = report.summary().partition("\n")[0].partition(" ")
    names = list(report.before)
    lengths = of_longest([own[name].share for own in (report.before, report.after) for name in names])
    bars = []
    for k, name in enumerate(names):
        before, after = report.before[name], report.after[name]
        cells = (
            name,
            "" if after.at_noise else "more than noise",
            f"{before.rms:.3g}",
            f"{before.largest:.3g}",
            percent(before.share),
            f"{after.rms:.3g}",
            f"{after.noise:.2g}",
        )
        said = f"{percent(before.share)} of tau, {percent(after.share)} with the causes"
        bars.append(Bars(cells, lengths[k], lengths[len(names) + k], said))
    head = ("joint", "", "rms", "largest", "of tau", "left", "noise")
    return Page(
        title=report.robot,
        compared=f"{report.log}: {report.rows:,} rows of {report.seconds:.3g} s",
        verdict=word,
        tone=report.verdict,
        sentence=rest,
        blocks=(
            Causes(
                tuple(Said(x.sentence, (("explains", percent(x.explains)),), x.alternatives) for x in report.causes),
                AS_WELL,
            ),
            Rows("Measured less modelled tau, before and after", head, tuple(bars), LOG_LEGEND),
        ),
        notes=report.notes,
        command="diagnose",
    )


def comparison_page(result: Comparison) -> Page:
    """How two descriptions of a robot differ."""
    word, _, rest = result.summary().partition(" ")
    a, b = result.robots
    return Page(
        title=f"{a} and {b}",
        compared=compared_robots(result),
        verdict=word,
        tone="agrees" if result.passed else "unexplained",
        sentence=rest,
        blocks=(
            *points("Why", result.reasons),
            *_effects(result),
            *_torques(result),
            *points("Also", remarks(result, full=True)),
        ),
        command="compare",
    )


def _effects(result: Comparison) -> tuple[Rows, ...]:
    rows = result.mattering
    lengths = of_longest([own.worst for own in rows])
    head = ("difference", "first", "second", "joint", "rms", "max", "share")
    bars = []
    for own, length in zip(rows, lengths, strict=True):
        joint = str(own.joint)
        numbers = (f"{own.rms[joint]:.3g}", f"{own.largest[joint]:.3g}", percent(own.share[joint]))
        said = f"{percent(own.worst)} of the torque of {joint}"
        bars.append(Bars((own.difference.where, *values_of(own.difference), joint, *numbers), length, None, said))
    return (Rows("Differences that change torques", head, tuple(bars), LEGEND, texts=4),) if bars else ()


def _torques(result: Comparison) -> tuple[Rows, ...]:
    shares = [own.change / own.rms if own.rms else 0.0 for own in result.joints.values()]
    head = ("joint", "rms of tau", "rms", "max", "share", "unexplained")
    bars = []
    for (name, own), share, length in zip(result.joints.items(), shares, of_longest(shares), strict=True):
        left = f"{own.remainder:.3g}" if own.remainder else ""
        cells = (name, f"{own.rms:.3g}", f"{own.change:.3g}", f"{own.largest:.3g}", percent(share), left)
        bars.append(Bars(cells, length, None, f"{percent(share)} of the torque of {name}"))
    legend = "second less first, N m or N"
    return (Rows("All differences together, joint by joint", head, tuple(bars), legend, texts=1),) if bars else ()
