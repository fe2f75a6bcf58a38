"""Checks of joints: limits that lock, limits that are missing, limits in degrees."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rttrr_pin.inspection.check import Check, Observation, Subject
from rttrr_pin.inspection.results import Severity
from rttrr_pin.urdf.document import UrdfJoint

LIMITED = ("revolute", "prismatic")
"""Types for which URDF requires a <limit>."""

FARTHEST = 100.0
"""Metres; no known robot slides farther, and exporters write 1e3, 1e16 or 1.7e308 for "no limit"."""

MOST_TURNS = 4.0 * math.pi
"""Radians to either side; cables allow less, and 180 written in degrees is more."""


def _limited(subject: Subject) -> Iterator[tuple[UrdfJoint, dict[str, float]]]:
    """Revolute and prismatic joints that have a <limit>."""
    joints = subject.document.joints.values()
    return ((joint, joint.limits) for joint in joints if joint.type in LIMITED and joint.limit is not None)


def _reach(limit: dict[str, float]) -> float:
    """The farther of the two ends."""
    return max(abs(limit.get("lower", 0.0)), abs(limit.get("upper", 0.0)))


def _unit(joint: UrdfJoint) -> str:
    return "m" if joint.type == "prismatic" else "rad"


def locked(subject: Subject) -> Iterator[Observation]:
    """Lower equals upper."""
    for joint, limit in _limited(subject):
        lower, upper = limit.get("lower", 0.0), limit.get("upper", 0.0)
        if lower == upper:
            unset = "" if {"lower", "upper"} & limit.keys() else " (neither is written, and URDF's default is 0)"
            yield Observation(
                joint, lower, _unit(joint), f"lower and upper limit are equal{unset}: the joint cannot move",
                "write the range, or make the joint fixed, or continuous if it turns without end",
            )  # fmt: skip


def powerless(subject: Subject) -> Iterator[Observation]:
    """Effort or velocity is zero."""
    for joint, limit in _limited(subject):
        zero = [key for key in ("effort", "velocity") if limit.get(key) == 0.0]
        if zero:
            words = " and ".join(zero)
            yield Observation(
                joint, 0.0, "", f"the {words} limit{'s are' if len(zero) > 1 else ' is'} 0",
                f"write the {words} of the drive, or mimic or fix the joint if it has none",
            )  # fmt: skip


def without_limit(subject: Subject) -> Iterator[Observation]:
    """What URDF requires is missing."""
    for joint in subject.document.joints.values():
        if joint.type in LIMITED and joint.limit is None:
            yield Observation(
                joint, None, "", f"a {joint.type} joint must have a <limit>, and has none",
                'write <limit lower="..." upper="..." effort="..." velocity="..."/>',
            )  # fmt: skip
        elif joint.limit is not None:
            for key in ("effort", "velocity"):
                if key not in joint.limit:
                    yield Observation(
                        joint, None, "", f"its <limit> has no {key}, which URDF requires", f'write {key}="..."'
                    )


def endless_slide(subject: Subject) -> Iterator[Observation]:
    """A prismatic joint that may slide anywhere."""
    for joint, limit in _limited(subject):
        reach = _reach(limit)
        if joint.type == "prismatic" and reach > FARTHEST:
            yield Observation(joint, reach, "m", "the joint may slide this far", "write the length of its guide in m")


def degrees(subject: Subject) -> Iterator[Observation]:
    """A revolute range that reads as degrees."""
    for joint, limit in _limited(subject):
        reach = _reach(limit)
        if joint.type == "revolute" and reach > MOST_TURNS:
            turns = reach / (2.0 * math.pi)
            whole = reach <= 720.0 and reach == round(reach)
            yield Observation(
                joint, reach, "rad", f"the limit is {turns:.3g} turns" + ("; is it in degrees?" if whole else ""),
                f'write {math.radians(reach):.6g} if degrees were meant, or type="continuous" for no limit',
            )  # fmt: skip


def half_range(subject: Subject) -> Iterator[Observation]:
    """One of lower and upper is left out."""
    for joint, limit in _limited(subject):
        if len({"lower", "upper"} & limit.keys()) == 1:
            missing = "upper" if "lower" in limit else "lower"
            yield Observation(
                joint, None, "", f"its <limit> has no {missing}: URDF says 0, MuJoCo drops the range, Drake has none",
                f'write {missing}="0" if that is meant',
            )  # fmt: skip


CHECKS = (
    Check("J401", Severity.WARNING, "The lower limit is below the upper one.", locked),
    Check("J402", Severity.WARNING, "Effort and velocity limits are above zero.", powerless),
    Check("J403", Severity.ERROR, "Revolute and prismatic joints have the limits that URDF requires.", without_limit),
    Check("J404", Severity.WARNING, "A prismatic joint slides no farther than 100 m.", endless_slide),
    Check("J405", Severity.WARNING, "A revolute joint turns no farther than two turns to either side.", degrees),
    Check("J406", Severity.NOTE, "A range has both a lower and an upper limit, or neither.", half_range),
)
