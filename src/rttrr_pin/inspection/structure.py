"""Checks of what the file says of its parts: left and right, joints and their limits, the root.

Links whose names differ in their side only should be each other's mirror image.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import listed
from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.checks import Observation, Severity, Subject, check
from rttrr_pin.urdf.document import UrdfJoint, UrdfLink
from rttrr_pin.urdf.inertial import UrdfInertial

ALIKE, SLIGHT = 1e-3, 1e-2
"""Relative: CAD programs write three digits at least, and mirrored parts have the same ones; a screw more is one
percent."""

LOPSIDED = 0.05
"""By how much, relative, a body differs from its own mirror image, so that a copy of it is not one."""

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


@dataclass(frozen=True, eq=False)
class Pair:
    """A link and its mirror image, both with a mass.

    Attributes:
        link: the one that stands first in the file.
        image: the other.
        mass: relative difference of the masses.
        inertia: of the principal moments.
        com: of the centre of mass's distance from the link's origin.
    """

    link: UrdfLink
    image: UrdfLink
    mass: float
    inertia: float
    com: float

    @property
    def worst(self) -> float:
        """The largest of the three."""
        return max(self.mass, self.inertia, self.com)


def _pairs(subject: Subject) -> Iterator[Pair]:
    """Pairs that both have an <inertial>, the first of the file first; of several possible images the most alike."""
    inertials = dict(subject.inertials())
    seen, links = set[str](), subject.document.links
    for name, link in links.items():
        seen.add(name)
        mirrored = [links[other] for other in other_side(name) if other in links]
        if link not in inertials or any(other.name in seen for other in mirrored):
            continue
        pairs = [_pair(link, other, inertials) for other in mirrored if other in inertials]
        if pairs:
            yield min(pairs, key=lambda pair: (pair.mass, pair.inertia, pair.com))


def _pair(link: UrdfLink, image: UrdfLink, inertials: Mapping[UrdfLink, UrdfInertial]) -> Pair:
    one, other = inertials[link], inertials[image]
    moments = [principal(inertial.tensor)[0] for inertial in (one, other)]
    reach = [float(np.linalg.norm(inertial.origin.p)) for inertial in (one, other)]
    gaps = (
        (abs(float(one.mass) - float(other.mass)), max(abs(float(one.mass)), abs(float(other.mass)))),
        (float(np.abs(moments[0] - moments[1]).max()), float(np.abs(moments).max())),
        (abs(reach[0] - reach[1]), max(reach)),
    )
    return Pair(link, image, *(gap / size if size else 0.0 for gap, size in gaps))


@check("T301", Severity.WARNING)
def mass_differs(subject: Subject) -> Iterator[Observation]:
    """Left and right links have the same mass, to 1 percent."""
    inertials = dict(subject.inertials())
    for pair in _pairs(subject):
        if pair.mass > SLIGHT:
            a, b = float(inertials[pair.link].mass), float(inertials[pair.image].mass)
            yield Observation(
                pair.link, a - b, "kg",
                f"its mass is {a:.6g} kg, that of its mirror image {pair.image.name!r} {b:.6g} kg",
                "find out which of the two is right, and write it for both",
            )  # fmt: skip


@check("T302", Severity.WARNING)
def shape_differs(subject: Subject) -> Iterator[Observation]:
    """Left and right links have the same principal moments and distance of the centre of mass, to 1 percent."""
    for pair in _pairs(subject):
        if pair.mass <= SLIGHT < pair.worst:
            parts = (("principal moments", pair.inertia), ("distance of the centre of mass from the origin", pair.com))
            differing = " and ".join(f"{what} (by {gap:.2g} of it)" for what, gap in parts if gap > SLIGHT)
            yield Observation(
                pair.link, pair.worst, "", f"it differs from its mirror image {pair.image.name!r} in {differing}",
                "mirror images have the same: compute both anew",
            )  # fmt: skip


@check("T303", Severity.WARNING)
def copied(subject: Subject) -> Iterator[Observation]:
    """Left and right links whose frames are parallel are mirror images, and not copies."""
    inertials, placements = dict(subject.inertials()), subject.document.placements
    for pair in _pairs(subject):
        (R, p), (other_R, other_p) = placements[pair.link.name], placements[pair.image.name]
        across = float(np.linalg.norm(p - other_p))
        if pair.worst > ALIKE or not across or not np.allclose(R, other_R, atol=ALIKE) or _same_part(pair):
            continue
        normal = R.T @ (p - other_p) / across
        mirror = np.eye(3) - 2.0 * np.outer(normal, normal)
        c, other_c = inertials[pair.link].origin.p, inertials[pair.image].origin.p
        J, other_J = inertials[pair.link].inertia, inertials[pair.image].inertia
        same = max(_apart(c, other_c), _apart(J, other_J)) < ALIKE
        lopsided = max(_apart(c, mirror @ c), _apart(J, mirror @ J @ mirror))
        if same and lopsided > LOPSIDED:
            yield Observation(
                pair.link, lopsided, "",
                f"it has the numbers of {pair.image.name!r} copied, not mirrored: the frames are parallel, and across "
                "the plane between them centre of mass and products of inertia change sign",
                "mirror one of the two, or leave them if both are the same part, mounted the same way",
                cause="copied",
            )  # fmt: skip


def _same_part(pair: Pair) -> bool:
    """Whether both are drawn, and drawn alike."""
    drawings = [
        [(shape.tag, shape.attributes, shape.origin.xyz.floats, shape.origin.R.tolist()) for shape in link.shapes]
        for link in (pair.link, pair.image)
    ]
    return drawings[0] == drawings[1] != []


def _apart(x: Array, y: Array) -> float:
    """|x - y| / |x|."""
    size = float(np.linalg.norm(x))
    return float(np.linalg.norm(x - y)) / size if size else 0.0


@check("T304", Severity.NOTE)
def differs_slightly(subject: Subject) -> Iterator[Observation]:
    """Left and right links do not differ at all, where they differ by less than 1 percent."""
    pairs = [pair for pair in _pairs(subject) if ALIKE < pair.worst <= SLIGHT]
    if pairs:
        shown = listed((pair.link.name for pair in pairs), 3)
        yield Observation(
            subject.document, max(pair.worst for pair in pairs), "",
            f"differ from their mirror images by less than 1 percent: {shown}", "compute both sides from one drawing",
        )  # fmt: skip


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


@check("J401", Severity.WARNING)
def locked(subject: Subject) -> Iterator[Observation]:
    """The lower limit is below the upper one."""
    for joint, limit in _limited(subject):
        lower, upper = limit.get("lower", 0.0), limit.get("upper", 0.0)
        if lower == upper:
            unit = "m" if joint.type == "prismatic" else "rad"
            unset = "" if {"lower", "upper"} & limit.keys() else " (neither is written, and URDF's default is 0)"
            yield Observation(
                joint, lower, unit, f"lower and upper limit are equal{unset}: the joint cannot move",
                "write the range, or make the joint fixed, or continuous if it turns without end",
            )  # fmt: skip


@check("J402", Severity.WARNING)
def powerless(subject: Subject) -> Iterator[Observation]:
    """Effort and velocity limits are above zero."""
    for joint, limit in _limited(subject):
        zero = [key for key in ("effort", "velocity") if limit.get(key) == 0.0]
        if zero:
            words = " and ".join(zero)
            yield Observation(
                joint, 0.0, "", f"the {words} limit{'s are' if len(zero) > 1 else ' is'} 0",
                f"write the {words} of the drive, or mimic or fix the joint if it has none",
            )  # fmt: skip


@check("J403", Severity.ERROR)
def without_limit(subject: Subject) -> Iterator[Observation]:
    """Revolute and prismatic joints have the limits that URDF requires."""
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


@check("J404", Severity.WARNING)
def endless_slide(subject: Subject) -> Iterator[Observation]:
    """A prismatic joint slides no farther than 100 m."""
    for joint, limit in _limited(subject):
        reach = _reach(limit)
        if joint.type == "prismatic" and reach > FARTHEST:
            yield Observation(joint, reach, "m", "the joint may slide this far", "write the length of its guide in m")


@check("J405", Severity.WARNING)
def degrees(subject: Subject) -> Iterator[Observation]:
    """A revolute joint turns no farther than two turns to either side."""
    for joint, limit in _limited(subject):
        reach = _reach(limit)
        if joint.type == "revolute" and reach > MOST_TURNS:
            turns = reach / (2.0 * math.pi)
            whole = reach <= 720.0 and reach == round(reach)
            yield Observation(
                joint, reach, "rad", f"the limit is {turns:.3g} turns" + ("; is it in degrees?" if whole else ""),
                f'write {math.radians(reach):.6g} if degrees were meant, or type="continuous" for no limit',
            )  # fmt: skip


@check("J406", Severity.NOTE)
def half_range(subject: Subject) -> Iterator[Observation]:
    """A range has both a lower and an upper limit, or neither."""
    for joint, limit in _limited(subject):
        if len({"lower", "upper"} & limit.keys()) == 1:
            missing = "upper" if "lower" in limit else "lower"
            yield Observation(
                joint, None, "", f"its <limit> has no {missing}: URDF says 0, MuJoCo drops the range, Drake has none",
                f'write {missing}="0" if that is meant',
            )  # fmt: skip


@check("C501", Severity.NOTE)
def root_inertia(subject: Subject) -> Iterator[Observation]:
    """The root link has no mass."""
    root = subject.document.links[subject.document.root]
    if root.inertial is not None and root.inertial.mass.exact != 0:
        yield Observation(
            root, float(root.inertial.mass), "kg",
            "the root link has a mass: a fixed base does not feel it, and KDL leaves it out",
            "for KDL, add a root link without mass and fix this one to it",
        )  # fmt: skip
