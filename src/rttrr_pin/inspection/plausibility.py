"""Checks against the link's geometry: numbers that some body has, but hardly this one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.checks import Edit, Observation, Severity, Subject, check
from rttrr_pin.inspection.exact import DIAGONAL
from rttrr_pin.inspection.shapes import Filled, Looks
from rttrr_pin.urdf.document import ENTRIES, UrdfInertial, UrdfLink

LARGEST_GYRATION = 1.5
"""Radius of gyration over the distance of the farthest point drawn. No mass inside the drawing gives more than 1."""

SMALLEST_GYRATION = 0.1
"""The same; a homogeneous ball has 0.63, a rod about its middle 0.58, a heavy core in a wide cover seldom 0.15."""

DENSITIES = (5.0, 25_000.0)
"""Mass over the volume of the hull [kg/m^3]: an open frame, and above osmium (22,590)."""

MARKER = 1e-8
"""Volume of the hull [m^3]: boxes of a millimetre or two are drawn for sensors that have no drawing."""

OUTSIDE = 0.5
"""How far the centre of mass may lie outside the box around the drawing, in half diagonals: motors often lack there."""

UNITS = (
    (1e9, "g mm^2"),
    (1e7, "g cm^2"),
    (1e6, "kg mm^2"),
    (1e4, "kg cm^2"),
    (1e3, "g m^2"),
    (1e-3, "t m^2"),
)
"""1 kg m^2 is so many of them: a file written in that unit is too large by the factor."""

FAR, NEAR, EXACTLY = 0.5, 0.13, 1e-3
"""Distances |I - solid| / |solid|: the file's tensor is not the solid's; another reading is; it is to the digits."""

SURE_FAR = 0.02
"""The file's distance from a box, cylinder or ball that another reading of the file meets exactly."""


@dataclass(frozen=True, eq=False)
class Case:
    """A link whose inertia can be compared with its geometry.

    Attributes:
        link: the link.
        inertial: its <inertial>.
        looks: its geometry.
        mass: [kg].
        gyration: the largest radius of gyration [m].
        reach: from the centre of mass to the farthest point drawn [m].
    """

    link: UrdfLink
    inertial: UrdfInertial
    looks: Looks
    mass: float
    gyration: float
    reach: float


@lru_cache(maxsize=1)  # all checks of this file look at the same cases
def _cases(subject: Subject) -> tuple[Case, ...]:
    """Links with mass, a tensor, and geometry that could be read."""
    cases = []
    for link, inertial in subject.inertials():
        if inertial.mass.exact > 0 and not inertial.is_zero and (looks := subject.looks(link)).known:
            mass = float(inertial.mass)
            gyration = float(np.sqrt(max(principal(inertial.tensor)[0][-1], 0.0) / mass))
            reach = float(np.linalg.norm(looks.points - inertial.origin.p, axis=1).max())
            cases.append(Case(link, inertial, looks, mass, gyration, reach))
    return tuple(cases)


@check("G201", Severity.WARNING)
def too_wide(subject: Subject) -> Iterator[Observation]:
    """The radius of gyration is within the link's geometry."""
    for case in _cases(subject):
        if case.gyration > LARGEST_GYRATION * case.reach:
            yield Observation(
                case.link, case.gyration, "m",
                f"the radius of gyration is {case.gyration:.3g} m, but nothing is drawn farther than "
                f"{case.reach:.3g} m from the centre of mass",
                "check the inertia's unit (kg m^2), and that mass and inertia belong together" + _unit_hint(case),
            )  # fmt: skip


@check("G202", Severity.WARNING)
def too_narrow(subject: Subject) -> Iterator[Observation]:
    """The radius of gyration is at least a tenth of the link's reach."""
    for case in _cases(subject):
        if case.gyration < SMALLEST_GYRATION * case.reach:
            yield Observation(
                case.link, case.gyration, "m",
                f"the radius of gyration is {case.gyration:.3g} m, but the link is drawn up to {case.reach:.3g} m from "
                "the centre of mass: nearly all mass would sit in the middle",
                "check the inertia's unit (kg m^2) and for placeholders such as 1e-6" + _unit_hint(case),
            )  # fmt: skip


def _unit_hint(case: Case) -> str:
    """The unit in which the file's tensor would suit the hull, if there is one."""
    if not case.looks.solids:
        return ""
    ratio = float(np.trace(case.inertial.tensor) / np.trace(case.looks.solids[-1].inertia(case.mass)))
    fitting = [unit for factor, unit in UNITS if 1 / 3 < ratio / factor < 3]
    return f"; in {fitting[0]} it would suit" if fitting else ""


@check("G203", Severity.WARNING)
def density(subject: Subject) -> Iterator[Observation]:
    """The mass over the volume of the hull is a density that things have."""
    for case in _cases(subject):
        if case.looks.volume < MARKER:
            continue
        value = case.mass / case.looks.volume
        if not DENSITIES[0] <= value <= DENSITIES[1]:
            heavy = value > DENSITIES[1]
            like = "denser than any metal" if heavy else "like a gas"
            yield Observation(
                case.link, value, "kg/m^3",
                f"{case.mass:.4g} kg in {case.looks.volume:.3g} m^3 is {like}",
                f"check the mass ({'g' if heavy else 't'} for kg?) and the geometry's unit (mm for m?)",
            )  # fmt: skip


@check("G204", Severity.WARNING)
def com_outside(subject: Subject) -> Iterator[Observation]:
    """The centre of mass lies in or near the link's geometry."""
    for case in _cases(subject):
        low, high = case.looks.points.min(axis=0), case.looks.points.max(axis=0)
        com = case.inertial.origin.p
        away = float(np.linalg.norm(np.maximum(np.maximum(low - com, com - high), 0.0)))
        size = float(np.linalg.norm(high - low)) / 2
        if away > OUTSIDE * size:
            yield Observation(
                case.link, away, "m",
                f"the centre of mass lies {away:.3g} m outside the box around the geometry, whose half diagonal is "
                f"{size:.3g} m",
                "check the <origin> of the <inertial>: its unit (m), its sign, and that it is in the link's frame",
            )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Reading:
    """Another meaning of the numbers written.

    Attributes:
        written: the tensor that would have to be written, in the inertial frame, (3, 3) [kg m^2].
        meaning: how the numbers would have to be understood.
        sure: whether nothing else explains an exact match: a factor of 1000 may be the mass's, slots the drawing's.
    """

    written: Array
    meaning: str
    sure: bool = True


def _misread(
    subject: Subject, readings: Callable[[UrdfInertial], Iterator[Reading]], fix: str
) -> Iterator[Observation]:
    """Links whose tensor suits their solid only in another reading."""
    for case in _cases(subject):
        best = _best(case, list(readings(case.inertial)))
        if best is not None:
            reading, solid, off, gap = best
            plausible = DENSITIES[0] <= case.mass / solid.body.mass <= DENSITIES[1]
            sure = plausible and solid.exact and gap < EXACTLY and reading.sure
            yield Observation(
                case.link, off, "",
                f"the inertia differs from that of {solid.label} by {off:.3g} of it, and by {gap:.2g} if it is "
                f"{reading.meaning}",
                fix, _rewrite(case, reading) if sure else (),
            )  # fmt: skip


def _best(case: Case, readings: list[Reading]) -> tuple[Reading, Filled, float, float] | None:
    """The reading that comes nearest to a solid; None where the file's own numbers suit one, or no reading does."""
    solids = [(solid, solid.inertia(case.mass)) for solid in case.looks.solids]
    offs = [_distance(case.inertial.inertia, wanted) for _, wanted in solids]
    R, best = case.inertial.origin.R, None
    for (solid, wanted), off in zip(solids, offs, strict=True):
        for reading in readings:
            gap = _distance(R @ reading.written @ R.T, wanted)
            clear = (gap < NEAR and min(offs) > FAR) or (solid.exact and gap < EXACTLY and min(offs) > SURE_FAR)
            if clear and (best is None or gap < best[3]):
                best = (reading, solid, off, gap)
    return best


def _distance(x: Array, wanted: Array) -> float:
    """|x - wanted| / |wanted|."""
    return float(np.linalg.norm(x - wanted) / np.linalg.norm(wanted))


def _rewrite(case: Case, reading: Reading) -> tuple[Edit, ...]:
    """The tensor as it would have to be written."""
    small = 1e-12 * float(np.abs(reading.written).max())
    values = {name: float(reading.written[at]) for name, at in ENTRIES.items()}
    return tuple(
        Edit(case.link.name, "inertia", name, f"{0.0 if abs(value) < small else value:.9g}")
        for name, value in values.items()
        if value != float(case.inertial.entries[name])
    )


@check("G205", Severity.WARNING)
def about_origin(subject: Subject) -> Iterator[Observation]:
    """The inertia is about the centre of mass, not about the link's origin."""

    def readings(inertial: UrdfInertial) -> Iterator[Reading]:
        """I - m (c.c 1 - c c^T) is about the centre of mass."""
        c, R = inertial.origin.p, inertial.origin.R
        if c.any():
            shifted = inertial.inertia - float(inertial.mass) * point_tensor(Vector.of(c)).array
            yield Reading(R.T @ shifted @ R, "about the link's origin and not about the centre of mass")

    return _misread(subject, readings, "subtract m (c.c 1 - c c^T), the parallel-axis term")


@check("G206", Severity.WARNING)
def swapped(subject: Subject) -> Iterator[Observation]:
    """ixx, iyy, izz stand in their own slots."""

    def readings(inertial: UrdfInertial) -> Iterator[Reading]:
        for order in list(permutations(range(3)))[1:]:
            written = inertial.tensor.copy()
            written[range(3), range(3)] = inertial.tensor.diagonal()[list(order)]
            names = ", ".join(DIAGONAL[k] for k in order)
            yield Reading(written, f"in the wrong slots: ixx, iyy, izz hold what belongs to {names}", sure=False)

    return _misread(subject, readings, "write each moment into its own slot, or the rpy that the inertial frame lacks")


@check("G207", Severity.WARNING)
def wrong_power(subject: Subject) -> Iterator[Observation]:
    """The inertia is in kg m^2."""

    def readings(inertial: UrdfInertial) -> Iterator[Reading]:
        for factor, unit in UNITS:
            yield Reading(inertial.tensor / factor, f"in {unit} and not in kg m^2", sure=factor >= 1e6)

    return _misread(subject, readings, "write the inertia in kg m^2")


@check("G208", Severity.NOTE)
def unknown(subject: Subject) -> Iterator[Observation]:
    """The geometry of each link with mass could be read."""
    lost = [
        link.name for link, inertial in subject.inertials() if inertial.mass.exact > 0 and subject.looks(link).missing
    ]
    if lost:
        shown = ", ".join(lost[:3]) + (", ..." if len(lost) > 3 else "")
        yield Observation(
            subject.document, float(len(lost)), "links",
            f"not compared with their geometry, whose meshes were not found: {shown}",
            "inspect the file where its meshes lie",
        )  # fmt: skip
