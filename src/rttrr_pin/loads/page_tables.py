"""Tables of loads: torques of joints, their motion, lives of gears, and what bearings carry."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from rttrr_pin.loads.parts import BearingLoad, JointLoad, Level, Peak
from rttrr_pin.reporting.html import Bars, Rows, of_longest


def limit_of(joint: JointLoad, name: str) -> tuple[Peak, float, str]:
    """What comes closest to a limit, the limit and its unit."""
    limits = joint.limits
    if name == "effort":
        return joint.tau.peak, limits.effort, joint.unit
    if name == "velocity":
        return joint.speed, limits.velocity, joint.speed_unit
    peak = joint.lowest if name == "lower" else joint.highest
    assert peak is not None
    return peak, limits.lower if name == "lower" else limits.upper, joint.speed_unit.removesuffix("/s")


def peak_text(peak: Peak, unit: str) -> str:
    """With half the width of its band, where it has one."""
    error = f" \u00b1 {peak.error:.2g}" if peak.error else ""
    return f"{peak.value:.5g}{error} {unit}"


def joints(joints: Sequence[JointLoad]) -> Iterator[Rows]:
    """Two tables: torques with their means, then motion and power."""
    head = ("joint", "limits", "peak tau", "at [s]", "row", "RMS", "cubic mean", "margin")
    lengths = of_longest([1.0 - min(joint.effort_margin, 1.0) for joint in joints] + [1.0])
    rows = []
    for joint, length in zip(joints, lengths, strict=False):
        tau = joint.tau
        limited = joint.limits.effort < math.inf
        cells = (
            joint.name,
            f"exceeds {', '.join(joint.exceeded)}" if joint.exceeded else "may exceed" if joint.doubtful else "within",
            peak_text(tau.peak, joint.unit),
            f"{tau.peak.time:.6g}",
            str(tau.peak.row),
            f"{tau.rms:.4g}",
            f"{tau.cubic_mean:.4g}",
            f"{joint.effort_margin:.1%}" if limited else "no limit",
        )
        said = f"{1.0 - joint.effort_margin:.1%} of the effort limit" if limited else "no effort limit"
        rows.append(Bars(cells, length, None, said, "bad" if joint.exceeded else "warn" if joint.doubtful else ""))
    if not rows:
        return
    yield Rows("Torques of joints", head, tuple(rows), "Weighted by time. Bars: the part of the effort limit.", texts=2)
    of_motion = (
        "joint",
        "peak speed",
        "mean speed",
        "reversals",
        "from",
        "to",
        "peak power [W]",
        "at [s]",
        "given [J]",
        "taken back [J]",
    )
    yield Rows("Motion and power of joints", of_motion, tuple(Bars(tuple(_motion(joint))) for joint in joints), texts=1)


def _motion(joint: JointLoad) -> Iterator[str]:
    yield joint.name
    yield f"{joint.speed.value:.4g} {joint.speed_unit}"
    yield f"{joint.mean_speed:.4g}"
    yield f"{joint.reversals:,}"
    for end in (joint.lowest, joint.highest):
        yield "" if end is None else f"{end.value:.4g}"
    yield f"{joint.power.value:.4g}"
    yield f"{joint.power.time:.6g}"
    yield f"{joint.energy_in:.4g}"
    yield f"{joint.energy_back:.4g}"


def gears(joints: Sequence[JointLoad]) -> Iterator[Rows]:
    """Lives, where ratings are given."""
    head = (
        "joint",
        "average torque [N m]",
        "rated [N m]",
        "mean input speed [rpm]",
        "rated [rpm]",
        "L50 [h]",
        "L10 [h]",
    )
    rows = [
        Bars(
            (
                joint.name,
                "" if joint.gear_torque is None else f"{joint.gear_torque:.4g}",
                f"{gear.rated_torque:.4g}",
                f"{gear.mean_input_speed:.4g}",
                f"{gear.rated_speed:.4g}",
                f"{gear.l50:,.0f}" if math.isfinite(gear.l50) else "unlimited",
                f"{gear.l10:,.0f}" if math.isfinite(gear.l10) else "unlimited",
            )
        )
        for joint in joints
        if (gear := joint.gear) is not None
    ]
    if rows:
        legend = "L50 = L_n (n_N / n_av) (T_N / T_av)^3, L10 = L50 / 5 (Harmonic Drive AG, Engineering Data 1019659)"
        yield Rows("Lives of gears", head, tuple(rows), legend, texts=1)


def bearings(bearings: Sequence[BearingLoad]) -> Iterator[Rows]:
    """Peak, RMS and cubic mean of each load, with the time and the state of its peak."""
    names = ("radial", "axial", "tilting", "torsion")
    rows = [Bars(tuple(_row(own, name, getattr(own, name)))) for own in bearings for name in names]
    head = ("joint", "as", "load", "peak", "at [s]", "row", "state", "RMS", "cubic mean")
    legend = "What crosses each joint, at the origin of its child link's frame: along and across its axis."
    if rows:
        yield Rows("What bearings carry", head, tuple(rows), legend, texts=3)


def _row(bearing: BearingLoad, name: str, load: Level) -> Iterator[str]:
    first = name == "radial"
    yield bearing.joint if first else ""
    yield bearing.kind if first else ""
    yield name
    yield peak_text(load.peak, load.unit)
    yield f"{load.peak.time:.6g}"
    yield str(load.peak.row)
    yield "" if load.peak.state is None else str(load.peak.state + 1)
    yield f"{load.rms:.4g}"
    yield f"{load.cubic_mean:.4g}"
