"""Checks of physics: what no rigid body can have, decided in rationals of the file's decimal text."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.check import Check, Observation, Subject
from rttrr_pin.inspection.exact import Shape, is_positive, nearest_possible, rank, shape
from rttrr_pin.inspection.results import Edit, Severity
from rttrr_pin.urdf.decimals import text_of
from rttrr_pin.urdf.document import UrdfInertial


def _empty(inertial: UrdfInertial) -> bool:
    """Whether all six entries are zero."""
    return not any(number.exact for number in inertial.entries.values())


def negative_mass(subject: Subject) -> Iterator[Observation]:
    """Mass below zero."""
    for link, inertial in subject.inertials():
        if inertial.mass.exact < 0:
            yield Observation(link, float(inertial.mass), "kg", "the mass is negative", "write the body's mass in kg")


def tensor_without_mass(subject: Subject) -> Iterator[Observation]:
    """No mass, but a tensor."""
    for link, inertial in subject.inertials():
        if inertial.mass.exact == 0 and not _empty(inertial):
            yield Observation(
                link, 0.0, "kg", "the mass is zero, the inertia is not",
                "write the mass, or zeros for all of the inertia if the link is only a frame",
            )  # fmt: skip


def moving_without_mass(subject: Subject) -> Iterator[Observation]:
    """A moving link without mass that carries none either: its joint's torque moves nothing."""
    document = subject.document
    massive = dict.fromkeys(document.links, False)
    massive |= {link.name: inertial.mass.exact != 0 for link, inertial in subject.inertials()}
    for _, name in reversed(list(document.walk())):
        massive[name] = massive[name] or any(massive[joint.child] for joint in document.children[name])
    for joint in document.joints.values():
        if joint.moves and not massive[joint.child]:
            yield Observation(
                document.links[joint.child], 0.0, "kg",
                f"joint {joint.name!r} moves it, but there is no mass on it or beyond: the mass matrix is singular",
                "give it a mass and an inertia, or make the joint fixed",
            )  # fmt: skip


def indefinite(subject: Subject) -> Iterator[Observation]:
    """A negative moment of inertia about some axis."""
    for link, inertial in subject.inertials():
        if not is_positive(inertial) and nearest_possible(inertial) is None:
            yield Observation(
                link, float(principal(inertial.tensor)[0][0]), "kg m^2",
                "the smallest principal moment is negative: the tensor is not positive definite",
                "compute the tensor anew; a wrong sign or slot among ixy, ixz, iyz does this",
            )  # fmt: skip


def triangle(subject: Subject) -> Iterator[Observation]:
    """I1 + I2 < I3: Sigma, and with it the pseudo-inertia, has a negative eigenvalue."""
    for link, inertial in subject.inertials():
        if is_positive(inertial) and rank(inertial) is None and nearest_possible(inertial) is None:
            low, mid, high = principal(inertial.tensor)[0]
            yield Observation(
                link, float(high - low - mid), "kg m^2",
                f"of the principal moments {low:.4g}, {mid:.4g} and {high:.4g} kg m^2, the last exceeds the sum of the "
                "others: no density has them",
                "compute the tensor anew, about the centre of mass, in kg m^2",
            )  # fmt: skip


def triangle_by_rounding(subject: Subject) -> Iterator[Observation]:
    """No body has these digits, but one has numbers that round to them."""
    for link, inertial in subject.inertials():
        possible = nearest_possible(inertial) if rank(inertial) is None else None
        if possible is not None:
            low, mid, high = principal(inertial.tensor)[0]
            yield Observation(
                link, float(high - low - mid), "kg m^2",
                "the largest principal moment exceeds the sum of the others by less than the last digits' rounding",
                "write more digits, or take the repair: it rounds to the same digits",
                _repair(link.name, inertial, possible),
            )  # fmt: skip


def _repair(link: str, inertial: UrdfInertial, possible: dict[str, Fraction]) -> tuple[Edit, ...]:
    """The entries that moved, with all their digits: what is written is what was checked."""
    return tuple(
        Edit(link, "inertia", name, text_of(value))
        for name, value in possible.items()
        if value != inertial.entries[name].exact
    )


BOUNDARY = {
    Shape.PLATE: "exactly on the boundary: only a plate without thickness has this inertia",
    Shape.ROD: "exactly on the boundary: only a rod without thickness has this inertia",
}


def boundary(subject: Subject) -> Iterator[Observation]:
    """Flat plates and thin rods, which are possible and at the very edge."""
    for link, inertial in subject.inertials():
        body = shape(inertial)
        if body in BOUNDARY:
            yield Observation(
                link, None, "", BOUNDARY[body],
                "give the body its thickness: at the boundary, a parser's rounding decides what it does",
            )  # fmt: skip


def point_mass(subject: Subject) -> Iterator[Observation]:
    """Mass, but no tensor."""
    for link, inertial in subject.inertials():
        if shape(inertial) is Shape.POINT:
            yield Observation(
                link, float(inertial.mass), "kg", "there is a mass, but the inertia is zero: a point",
                "write the inertia about the centre of mass",
            )  # fmt: skip


CHECKS = (
    Check("P101", Severity.ERROR, "No mass is negative.", negative_mass),
    Check("P102", Severity.ERROR, "A link without mass has no inertia either.", tensor_without_mass),
    Check("P103", Severity.WARNING, "Each moving joint moves some mass.", moving_without_mass),
    Check("P104", Severity.ERROR, "The inertia is positive semidefinite.", indefinite),
    Check("P105", Severity.ERROR,
          "The principal moments fulfil the triangle inequality; with it the 4x4 pseudo-inertia is positive "
          "semidefinite.", triangle),
    Check("P106", Severity.WARNING, "The digits written fulfil P104 and P105, and not only numbers that round to them.",
          triangle_by_rounding),
    Check("P107", Severity.NOTE, "The body has thickness: it is no exact plate and no exact rod.", boundary),
    Check("P108", Severity.WARNING, "A link with mass has an inertia.", point_mass),
)  # fmt: skip
