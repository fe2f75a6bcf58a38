"""Where the rules of parsers about joints apply: each function yields the names of joints."""

from __future__ import annotations

from collections.abc import Iterator

from rttrr_pin.inspection.joints import LIMITED
from rttrr_pin.inspection.merged_links import merged_links
from rttrr_pin.urdf.decimals import blank_behind, other_blanks
from rttrr_pin.urdf.document import UrdfDocument


def without_limit(document: UrdfDocument) -> Iterator[str]:
    """Revolute and prismatic joints without <limit>."""
    return (joint.name for joint in document.joints.values() if joint.type in LIMITED and joint.limit is None)


def without_effort(document: UrdfDocument) -> Iterator[str]:
    """Joints whose <limit> lacks effort or velocity."""
    needed = {"effort", "velocity"}
    return (joint.name for joint in document.joints.values() if joint.limit is not None and needed - joint.limit.keys())


def unparsed(document: UrdfDocument) -> Iterator[str]:
    """Joints with a blank behind a number, or other blanks than spaces between numbers."""
    for joint in document.joints.values():
        numbers = [joint.damping, joint.friction, *(joint.limit or {}).values()]
        numbers += [joint.mimic.multiplier, joint.mimic.offset] if joint.mimic else []
        vectors = [joint.origin.xyz, joint.origin.rpy] + [joint.axis] * (joint.type not in ("fixed", "floating"))
        if any(map(blank_behind, numbers)) or any(map(other_blanks, vectors)):
            yield joint.name


def mimicking(document: UrdfDocument) -> Iterator[str]:
    """Moving joints with <mimic>."""
    return (joint.name for joint in document.joints.values() if joint.moves and joint.mimic is not None)


def fixed_mimic(document: UrdfDocument) -> Iterator[str]:
    """Fixed joints with <mimic>."""
    return (joint.name for joint in document.joints.values() if not joint.moves and joint.mimic is not None)


def degenerate_range(document: UrdfDocument) -> Iterator[str]:
    """Revolute and prismatic joints whose lower limit is not below their upper one, or with one of the two."""
    for joint in document.joints.values():
        if joint.type in LIMITED and joint.limit is not None:
            ends = {"lower", "upper"} & joint.limit.keys()
            if len(ends) < 2 or joint.limits["lower"] >= joint.limits["upper"]:
                yield joint.name


def continuous_range(document: UrdfDocument) -> Iterator[str]:
    """Continuous joints with a range that would limit a revolute one."""
    for joint in document.joints.values():
        ends = joint.limits if joint.type == "continuous" else {}
        if {"lower", "upper"} <= ends.keys() and ends["lower"] < ends["upper"]:
            yield joint.name


def floating(document: UrdfDocument) -> Iterator[str]:
    """Floating joints."""
    return (joint.name for joint in document.joints.values() if joint.type == "floating")


def floating_on_moving(document: UrdfDocument) -> Iterator[str]:
    """Floating joints on links that are not fixed to the root."""
    anchored = merged_links(document)[document.root].members
    return (
        joint.name for joint in document.joints.values() if joint.type == "floating" and joint.parent not in anchored
    )


def planar_or_floating(document: UrdfDocument) -> Iterator[str]:
    """Planar and floating joints."""
    return (joint.name for joint in document.joints.values() if joint.type in ("planar", "floating"))
