"""Checks of left and right: links whose names differ in their side only should be each other's mirror image."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.check import Check, Observation, Subject
from rttrr_pin.inspection.results import Severity
from rttrr_pin.urdf.document import UrdfInertial, UrdfLink

ALIKE = 1e-3
"""Relative: CAD programs write three digits at least, and mirrored parts have the same ones."""

SIDES = {"left": "right", "l": "r", "fl": "fr", "hl": "hr", "bl": "br", "rl": "rr", "lf": "rf", "lh": "rh", "lb": "rb"}
OTHER = SIDES | {right: left for left, right in SIDES.items()}
WORD = re.compile(r"left|right|(?<![a-z0-9])(?:[fhbr]?[lr]|[lr][fhb])(?![a-z0-9])", re.IGNORECASE)
"""left and right anywhere; the letters only between separators."""


def other_side(name: str) -> tuple[str, ...]:
    """What the link on the other side may be called.

    Of several sides in a name the first alone may change, or all: the left finger of the left hand corresponds to the
    left finger of the right hand if the hands are of one kind, and to its right finger if they are mirrored.
    """
    all_changed, first_changed = (
        WORD.sub(lambda word: _same_case(OTHER[word[0].lower()], word[0]), name, count=n) for n in (0, 1)
    )
    return tuple(dict.fromkeys(other for other in (all_changed, first_changed) if other != name))


def _same_case(word: str, like: str) -> str:
    if like.isupper():
        return word.upper()
    return word.capitalize() if like[0].isupper() else word


def _pairs(subject: Subject) -> Iterator[tuple[UrdfLink, UrdfInertial, UrdfLink, UrdfInertial]]:
    """Pairs that both have mass, the first of the file first; of several possible mirror images the most alike."""
    seen = set[str]()
    links = subject.document.links
    for name, link in links.items():
        seen.add(name)
        mirrored = [links[other] for other in other_side(name) if other in links]
        own = link.inertial
        if own is None or any(other.name in seen for other in mirrored):
            continue
        massive = [(other, other.inertial) for other in mirrored if other.inertial is not None]
        if massive:
            _, k = min((_difference(own, inertial), k) for k, (_, inertial) in enumerate(massive))
            yield link, own, *massive[k]


def _difference(one: UrdfInertial, other: UrdfInertial) -> tuple[float, float, float]:
    """Relative differences of mass, of principal moments, and of the centre of mass's distance from the origin."""
    moments = [principal(inertial.tensor)[0] for inertial in (one, other)]
    reach = [float(np.linalg.norm(inertial.origin.p)) for inertial in (one, other)]
    gaps = (
        (abs(float(one.mass) - float(other.mass)), max(abs(float(one.mass)), abs(float(other.mass)))),
        (float(np.abs(moments[0] - moments[1]).max()), float(np.abs(moments).max())),
        (abs(reach[0] - reach[1]), max(reach)),
    )
    mass, inertia, com = (gap / size if size else 0.0 for gap, size in gaps)
    return mass, inertia, com


def mass_differs(subject: Subject) -> Iterator[Observation]:
    """Mirrored links of different mass."""
    for link, one, image, other in _pairs(subject):
        if _difference(one, other)[0] > ALIKE:
            a, b = float(one.mass), float(other.mass)
            yield Observation(
                link, a - b, "kg", f"its mass is {a:.6g} kg, that of its mirror image {image.name!r} {b:.6g} kg",
                "find out which of the two is right, and write it for both",
            )  # fmt: skip


def shape_differs(subject: Subject) -> Iterator[Observation]:
    """Mirrored links of the same mass whose tensors or centres of mass are not mirror images."""
    for link, one, image, other in _pairs(subject):
        mass, inertia, com = _difference(one, other)
        if mass <= ALIKE and max(inertia, com) > ALIKE:
            parts = (("principal moments", inertia), ("distance of the centre of mass from the origin", com))
            differing = " and ".join(f"{what} (by {gap:.2g} of it)" for what, gap in parts if gap > ALIKE)
            yield Observation(
                link, max(inertia, com), "", f"it differs from its mirror image {image.name!r} in {differing}",
                "mirror images have the same: compute both anew",
            )  # fmt: skip


CHECKS = (
    Check("T301", Severity.WARNING, "Left and right links have the same mass.", mass_differs),
    Check("T302", Severity.WARNING, "Left and right links are mirror images.", shape_differs),
)
