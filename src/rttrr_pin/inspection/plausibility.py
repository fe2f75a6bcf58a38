"""Checks against the link's geometry and the robot's size: numbers that some body has, but hardly this one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import listed
from rttrr_pin.inspection.cases import DENSITIES, LARGEST_GYRATION, Case, cases, ellipsoid_density
from rttrr_pin.inspection.causes import cause_of
from rttrr_pin.inspection.checks import Observation, Severity, Subject, check
from rttrr_pin.inspection.merged import anchored

LENGTH_UNITS = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254}
"""How many m each is."""

MARKER = 1e-8
"""Volume of the hull [m^3]: boxes of a millimetre or two are drawn for sensors that have no drawing."""

OUTSIDE = 0.5
"""How far the centre of mass may lie outside the box around the drawing, in half diagonals: motors often lack there."""

DEFAULTS = {7850.0: "steel", 1000.0: "water"}
"""Densities [kg/m^3] that CAD programs take where no material was chosen."""

ALIKE, SEVERAL, MOST = 0.02, 3, 0.9
"""How near densities are to such a one, relative (steel is 7800 to 8000); how many links must be, and what share of
the mass."""


def _drawn(subject: Subject) -> Iterator[Case]:
    """Links with mass, a tensor, and geometry that could be read."""
    return (case for case in cases(subject).values() if case.drawn)


@check("G201", Severity.WARNING)
def too_wide(subject: Subject) -> Iterator[Observation]:
    """The radius of gyration is within the link's geometry."""
    for case in _drawn(subject):
        if case.wide:
            yield Observation(
                case.link, case.gyration, "m",
                f"the radius of gyration is {case.gyration:.3g} m, but nothing is drawn farther than "
                f"{case.reach:.3g} m from the centre of mass{_about_axis(subject, case)}",
                "check the inertia's unit (kg m^2), and that mass and inertia belong together",
            )  # fmt: skip


def _about_axis(subject: Subject, case: Case) -> str:
    """That a fixed base does not feel what is wrong with a link on its first joint, where that is so."""
    document = subject.document
    joint = document.carried_by.get(case.link.name)
    if joint is None or joint.type not in ("revolute", "continuous") or joint.parent not in anchored(document):
        return ""
    axis = np.array(joint.axis.floats) / np.linalg.norm(joint.axis.floats)
    gyration = np.sqrt(max(axis @ case.inertial.inertia @ axis, 0.0) / case.mass)
    if gyration > LARGEST_GYRATION * case.reach:
        return ""
    return f"; on a fixed base only the moment about {joint.name} counts, and its radius is {gyration:.3g} m"


@check("G202", Severity.WARNING)
def too_narrow(subject: Subject) -> Iterator[Observation]:
    """The radius of gyration is at least a tenth of the drawing's radius."""
    for case in _drawn(subject):
        if case.narrow:
            yield Observation(
                case.link, case.gyration, "m",
                f"the radius of gyration is {case.gyration:.3g} m, but the link is drawn with a radius of "
                f"{case.radius:.3g} m: nearly all mass would sit in the middle",
                "check the inertia's unit (kg m^2) and for placeholders such as 1e-6",
            )  # fmt: skip


@check("G203", Severity.WARNING)
def density(subject: Subject) -> Iterator[Observation]:
    """The mass over the volume of the hull is a density that things have."""
    for case in _drawn(subject):
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
    for case in _drawn(subject):
        low, high = case.looks.points.min(axis=0), case.looks.points.max(axis=0)
        com = case.inertial.origin.p
        away = float(np.linalg.norm(np.maximum(np.maximum(low - com, com - high), 0.0)))
        size = float(np.linalg.norm(high - low)) / 2
        if away > OUTSIDE * size:
            cause, sentence = _misplaced(com, low, high)
            yield Observation(
                case.link, away, "m",
                f"the centre of mass lies {away:.3g} m outside the box around the geometry, whose half diagonal is "
                f"{size:.3g} m{sentence}",
                "check the <origin> of the <inertial>: its unit (m), its sign, and that it is in the link's frame",
                cause=cause,
            )  # fmt: skip


def _misplaced(com: Array, low: Array, high: Array) -> tuple[str, str]:
    """The one slip that explains a centre of mass outside a box, and what to say of it."""
    if not com.any():
        return "zero", "; it is the link's origin, as if the <origin> were missing"
    meant = {("unit", f"in {name}"): com * factor for name, factor in LENGTH_UNITS.items()}
    meant |= {("sign", f"with the other sign of {'xyz'[k]}"): com * (1 - 2 * np.eye(3)[k]) for k in range(3)}
    inside = [cause for cause, point in meant.items() if (low <= point).all() and (point <= high).all()]
    return (inside[0][0], f"; {inside[0][1]} it would be inside") if len(inside) == 1 else ("", "")


@check("G205", Severity.WARNING)
def misread(subject: Subject) -> Iterator[Observation]:
    """The inertia is not that of the link's shape in another unit, order, sign or frame, or with other digits."""
    for case in _drawn(subject):
        cause = cause_of(case) if case.unlike else None
        if cause is not None and cause.solid:
            yield Observation(
                case.link, min(case.distances), "", f"the inertia differs from that of {cause.solid} by "
                f"{min(case.distances):.3g} of it",
                "write the inertia about the centre of mass in kg m^2, in the axes of the inertial frame, each number "
                "in its own slot",
            )  # fmt: skip


@check("G208", Severity.NOTE)
def unknown(subject: Subject) -> Iterator[Observation]:
    """The geometry of each link with mass could be read."""
    lost = [
        link.name for link, inertial in subject.inertials() if inertial.mass.exact > 0 and subject.looks(link).missing
    ]
    if lost:
        yield Observation(
            subject.document, float(len(lost)), "links",
            f"not compared with their geometry, whose meshes were not found: {listed(lost, 3)}",
            "inspect the file where its meshes lie",
        )  # fmt: skip


@check("G209", Severity.WARNING)
def implausible(subject: Subject) -> Iterator[Observation]:
    """A link whose geometry is not known has the radius of gyration of a thing that could be part of the robot."""
    for case in cases(subject).values():
        if case.possible and not case.drawn and (case.wide or case.narrow):
            density = ellipsoid_density(case.mass, case.moments)
            within = (
                f" in a robot whose joints and centres of mass lie within {case.extent:.3g} m" if case.extent else ""
            )
            like = "" if np.isnan(density) else f"; the ellipsoid with this mass and inertia has {density:.2g} kg/m^3"
            yield Observation(
                case.link, case.gyration, "m",
                f"the radius of gyration is {case.gyration:.3g} m{within}{like}",
                "check the inertia's unit (kg m^2), the mass's (kg), and for placeholders",
            )  # fmt: skip


@check("G210", Severity.WARNING)
def one_density(subject: Subject) -> Iterator[Observation]:
    """Not all links have the density that a CAD program takes where no material was chosen."""
    filled = [(float(inertial.mass), subject.looks(link).filled) for link, inertial in subject.inertials()]
    known = np.array([(mass, volume) for mass, volume in filled if mass > 0.0 and volume > MARKER]).reshape(-1, 2)
    densities = known[:, 0] / known[:, 1]
    for density, material in DEFAULTS.items():
        alike = np.abs(densities / density - 1.0) < ALIKE
        if alike.sum() >= SEVERAL and known[alike, 0].sum() > MOST * known[:, 0].sum():
            yield Observation(
                subject.document, float(np.median(densities[alike])), "kg/m^3",
                f"{alike.sum()} of {len(known)} links whose volume is known are as dense as {material}, which CAD "
                "programs take where no material was chosen",
                "choose the materials of the parts in the CAD program, and export again",
                cause="density",
            )  # fmt: skip
