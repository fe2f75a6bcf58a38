"""Where the rules of consumers about joints apply: each function yields the names of joints."""

from __future__ import annotations

from collections.abc import Iterator

from rttrr_pin.inspect.joints import LIMITED
from rttrr_pin.inspect.reading import Document


def without_limit(document: Document) -> Iterator[str]:
    """Revolute and prismatic joints without <limit>."""
    return (joint.name for joint in document.joints if joint.type in LIMITED and joint.limit is None)


def without_effort(document: Document) -> Iterator[str]:
    """Joints whose <limit> lacks effort or velocity."""
    needed = {"effort", "velocity"}
    return (joint.name for joint in document.joints if joint.limit is not None and needed - joint.limit.keys())


def mimicking(document: Document) -> Iterator[str]:
    """Moving joints with <mimic>."""
    return (joint.name for joint in document.joints if joint.moves and joint.mimics is not None)


def fixed_mimic(document: Document) -> Iterator[str]:
    """Fixed joints with <mimic>."""
    return (joint.name for joint in document.joints if not joint.moves and joint.mimics is not None)


def degenerate_range(document: Document) -> Iterator[str]:
    """Revolute and prismatic joints whose lower equals their upper limit, or with one of the two."""
    for joint in document.joints:
        if joint.type in LIMITED and joint.limit is not None:
            ends = {"lower", "upper"} & joint.limit.keys()
            if len(ends) < 2 or joint.limit["lower"] == joint.limit["upper"]:
                yield joint.name


def floating(document: Document) -> Iterator[str]:
    """Floating joints."""
    return (joint.name for joint in document.joints if joint.type == "floating")


def planar_or_floating(document: Document) -> Iterator[str]:
    """Planar and floating joints."""
    return (joint.name for joint in document.joints if joint.type in ("planar", "floating"))
