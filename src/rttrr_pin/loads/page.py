"""Loads as a page: which limit comes first, then every joint over time and speed, bearings, states that matter."""

from __future__ import annotations

from collections.abc import Iterator

from rttrr_pin.loads.page_tables import bearings, gears, joints, limit_of, peak_text
from rttrr_pin.loads.pictures import BAND, against_speed, over_time, states, use_of_limits
from rttrr_pin.loads.results import LoadReport
from rttrr_pin.reporting.html import Figures, Page, points
from rttrr_pin.robot import Robot


def loads_page(report: LoadReport, robot: Robot) -> Page:
    """What the page says."""
    return Page(
        title=report.robot,
        compared=f"along {report.trajectory}: {report.rows:,} rows, {report.seconds:.6g} s; payload {report.payload}",
        verdict="PASS" if report.passed else "FAIL",
        tone=_tone(report),
        sentence=report.verdict(),
        facts=_facts(report),
        blocks=(
            *points("Where to look", _where_to_look(report)),
            *use_of_limits(report),
            *points("What is unusual in the trajectory", (finding.sentence for finding in report.findings)),
            Figures("Over time", tuple(over_time(report))),
            Figures("Against speed", tuple(against_speed(report))),
            *joints(report.joints),
            *gears(report.joints),
            *bearings(report.bearings),
            *states(report, robot),
            *points("Files", report.outputs),
        ),
        notes=tuple(filter(None, (_derived(report), *report.notes))),
        command="loads",
    )


def _tone(report: LoadReport) -> str:
    if not report.passed:
        return "unexplained"
    return "explained" if report.findings or any(joint.doubtful for joint in report.joints) else "agrees"


def _derived(report: LoadReport) -> str:
    how = report.differentiation
    return "" if how is None else f"{how.summary()}{f'; the {BAND} of tau is drawn' if report.band else ''}"


def _facts(report: LoadReport) -> tuple[tuple[str, str], ...]:
    power = max((joint.power for joint in report.joints), key=lambda peak: abs(peak.value), default=None)
    energy = sum(joint.energy_in for joint in report.joints)
    return (
        ("rows", f"{report.rows:,}"),
        ("duration", f"{report.seconds:.6g} s"),
        *([("largest power of a joint", f"{power.value:.4g} W at {power.time:.6g} s")] if power else []),
        ("energy that the drives give", f"{energy:.4g} J"),
    )


def _where_to_look(report: LoadReport) -> Iterator[str]:
    """Limits that are exceeded or may be, then the joint that comes closest."""
    for joint in report.joints:
        for name in joint.exceeded:
            peak, most, unit = limit_of(joint, name)
            at = f"at {peak.time:.6g} s, row {peak.row}"
            yield f"{name} of {joint.name}: {peak.value:.5g} {unit} {at}; the limit is {most:.5g} {unit}"
        if joint.doubtful:
            peak_of_tau = peak_text(joint.tau.peak, joint.unit)
            yield f"effort of {joint.name} is within its limit only by less than its {BAND}: {peak_of_tau}"
    if not report.passed:
        return
    closest = min(report.joints, key=lambda joint: min(joint.effort_margin, joint.velocity_margin), default=None)
    if closest is not None and min(closest.effort_margin, closest.velocity_margin) < 1.0:
        kind = "effort" if closest.effort_margin <= closest.velocity_margin else "velocity"
        peak, most, unit = limit_of(closest, kind)
        used = f"{1.0 - min(closest.effort_margin, closest.velocity_margin):.0%} of {most:.5g} {unit}"
        yield f"closest to a limit: {kind} of {closest.name}, {used}, at {peak.time:.6g} s"
