"""Pictures of loads: over time, against speed, of limits, and of the robot in the states that matter."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.loads.page_tables import limit_of
from rttrr_pin.loads.results import History, LoadReport, NamedState, Samples
from rttrr_pin.reporting.html import Bars, Block, Chart, Figures, Rows, bars, line_chart, robot_drawing, scatter, slug
from rttrr_pin.reporting.results import counted
from rttrr_pin.robot import Robot

BUCKETS, FEWEST_BUCKETS = 9_000, 200
"""Of the histories of all joints together, and of each at least: a page stays small, however many joints there are."""

DOTS, FEWEST_DOTS = 15_000, 250
"""Of the samples, likewise."""

DRAWN = 4
"""States that are drawn."""

BAND = "band of 95 percent"


def use_of_limits(report: LoadReport) -> Iterator[Figures]:
    """How much of the limits of effort and speed is used."""
    charts = []
    for kind, title in (("effort", "Peak torque or force of its limit"), ("velocity", "Peak speed of its limit")):
        used = {
            joint.name: abs(peak.value) / limit
            for joint in report.joints
            for peak, limit, _ in [limit_of(joint, kind)]
            if 0.0 < limit < math.inf
        }
        if used:
            charts.append(bars(f"use-of-{kind}", title, used, "peak / limit", ("limit", 1.0)))
    if charts:
        yield Figures("How much of the limits is used", tuple(charts))


def _merged(history: History, joints: int) -> History:
    """The history in fewer buckets, where there are many joints."""
    most = max(FEWEST_BUCKETS, BUCKETS // max(joints, 1))
    step = -(-len(history.time) // most)
    if step <= 1:
        return history
    at = np.arange(0, len(history.time), step)
    middle = np.minimum(at + (step - 1) // 2, len(history.time) - 1)
    low, high = history.band_low, history.band_high
    return History(
        history.time[middle],
        np.minimum.reduceat(history.low, at),
        np.maximum.reduceat(history.high, at),
        None if low is None else np.minimum.reduceat(low, at),
        None if high is None else np.maximum.reduceat(high, at),
        history.rows * step,
    )


def over_time(report: LoadReport) -> Iterator[Chart]:
    """The tau of each joint, with its band and limit."""
    history = _merged(report.history, len(report.joints))
    for k, joint in enumerate(report.joints):
        band: tuple[str, tuple[Array, Array]] | None = None
        if history.band_low is not None and history.band_high is not None:
            band = BAND, (history.band_low[:, k], history.band_high[:, k])
        tau = {"tau": (history.low[:, k], history.high[:, k])}
        effort = joint.limits.effort
        yield line_chart(
            f"tau-{k + 1}-{slug(joint.name)}",
            f"tau of {joint.name}",
            history.time,
            tau,
            "time [s]",
            f"tau [{joint.unit}]",
            band,
            {"effort limit": (effort, -effort)},
            (report.start, report.start + report.seconds),
        )


def against_speed(report: LoadReport) -> Iterator[Chart]:
    """The tau over v of each joint, with both limits."""
    samples = _thinned(report.samples, len(report.joints))
    for k, joint in enumerate(report.joints):
        velocity, effort = joint.limits.velocity, joint.limits.effort
        yield scatter(
            f"speed-{k + 1}-{slug(joint.name)}",
            f"tau of {joint.name} against speed",
            samples.v[:, k],
            samples.tau[:, k],
            f"speed [{joint.speed_unit}]",
            f"tau [{joint.unit}]",
            {"velocity limit": (velocity, -velocity)},
            {"effort limit": (effort, -effort)},
            {"time [s]": samples.time},
        )


def _thinned(samples: Samples, joints: int) -> Samples:
    """Fewer samples, where there are many joints."""
    step = -(-len(samples.row) // max(FEWEST_DOTS, DOTS // max(joints, 1)))
    return Samples(*(getattr(samples, name)[:: max(step, 1)] for name in ("row", "time", "q", "v", "tau")))


def states(report: LoadReport, robot: Robot) -> Iterator[Block]:
    """The first drawn with the forces across their joints; all of them as a table."""
    if not report.states:
        return
    numbered = list(enumerate(report.states))
    drawn = sorted(numbered, key=lambda pair: "peak tau" not in pair[1].name)[:DRAWN]
    charts = tuple(_drawing(k, state, robot) for k, state in sorted(drawn, key=lambda pair: pair[0]))
    more = len(numbered) - len(charts)
    legend = f"{len(charts)} of {counted(len(numbered), 'state')}; all are in the table." if more else ""
    yield Figures("States that matter", charts, legend)
    names = robot.model.q_names
    rows = (
        Bars((str(k + 1), state.name, f"{state.time:.6g}", str(state.row), *(f"{x:.5g}" for x in state.q.tolist())))
        for k, state in enumerate(report.states)
    )
    yield Rows("All states that matter", ("", "why", "at [s]", "row", *(f"q of {name}" for name in names)), tuple(rows))


def _drawing(k: int, state: NamedState, robot: Robot) -> Chart:
    f = robot.inverse_dynamics(state.q, state.v, state.a, payload=state.payload or None).f
    title = f"{k + 1}. {state.name}, at {state.time:.6g} s"
    return robot_drawing(robot.model, state.q, wrenches=f, name=f"state-{k + 1}", title=title)
