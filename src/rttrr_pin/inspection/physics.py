"""Checks of physics: what no rigid body can have, decided in rationals of the file's decimal text."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.check import Check, Observation, Subject
from rttrr_pin.inspection.exact import Shape
from rttrr_pin.inspection.reading import Body, Mass
from rttrr_pin.inspection.results import Edit, Severity
from rttrr_pin.urdf.decimals import text_of


def _inertials(subject: Subject) -> Iterator[tuple[Body, Mass]]:
    return ((body, body.inertial) for body in subject.links.values() if body.inertial is not None)


def _empty(inertial: Mass) -> bool:
    """Whether all six entries are zero."""
    return not any(number.exact for number in inertial.entries.values())


def negative_mass(subject: Subject) -> Iterator[Observation]:
    """Mass below zero."""
    for body, inertial in _inertials(subject):
        if inertial.mass.exact < 0:
            yield Observation(body, float(inertial.mass), "kg", "the mass is negative", "write the body's mass in kg")


def tensor_without_mass(subject: Subject) -> Iterator[Observation]:
    """No mass, but a tensor."""
    for body, inertial in _inertials(subject):
        if inertial.mass.exact == 0 and not _empty(inertial):
            yield Observation(
                body, 0.0, "kg", "the mass is zero, the inertia is not",
                "write the mass, or zeros for all of the inertia if the link is only a frame",
            )  # fmt: skip


def moving_without_mass(subject: Subject) -> Iterator[Observation]:
    """A moving link without mass that carries none either: its joint's torque moves nothing."""
    document = subject.document
    massive = {
        name: body.inertial is not None and body.inertial.mass.exact != 0 for name, body in subject.links.items()
    }
    for _, name in reversed(list(document.walk())):
        massive[name] = massive[name] or any(massive[joint.child] for joint in document.children[name])
    for joint in document.joints:
        if joint.moves and not massive[joint.child]:
            yield Observation(
                subject.links[joint.child], 0.0, "kg",
                f"joint {joint.name!r} moves it, but there is no mass on it or beyond: the mass matrix is singular",
                "give it a mass and an inertia, or make the joint fixed",
            )  # fmt: skip


def indefinite(subject: Subject) -> Iterator[Observation]:
    """A negative moment of inertia about some axis."""
    for body, inertial in _inertials(subject):
        if not inertial.positive and inertial.mended is None:
            yield Observation(
                body, float(principal(inertial.written)[0][0]), "kg m^2",
                "the smallest principal moment is negative: the tensor is not positive definite",
                "compute the tensor anew; a wrong sign or slot among ixy, ixz, iyz does this",
            )  # fmt: skip


def triangle(subject: Subject) -> Iterator[Observation]:
    """I1 + I2 < I3: Sigma, and with it the pseudo-inertia, has a negative eigenvalue."""
    for body, inertial in _inertials(subject):
        if _positive_but_impossible(inertial) and inertial.mended is None:
            low, mid, high = principal(inertial.written)[0]
            yield Observation(
                body, float(high - low - mid), "kg m^2",
                f"of the principal moments {low:.4g}, {mid:.4g} and {high:.4g} kg m^2, the last exceeds the sum of the "
                "others: no density has them",
                "compute the tensor anew, about the centre of mass, in kg m^2",
            )  # fmt: skip


def triangle_by_rounding(subject: Subject) -> Iterator[Observation]:
    """No body has these digits, but one has numbers that round to them."""
    for body, inertial in _inertials(subject):
        if inertial.rank is None:
            mended = inertial.mended
            if mended is not None:
                low, mid, high = principal(inertial.written)[0]
                yield Observation(
                    body, float(high - low - mid), "kg m^2",
                    "the largest principal moment exceeds the sum of the others by less than the last digits' rounding",
                    "write more digits, or take the repair: it rounds to the same digits",
                    _repair(body.name, inertial, mended),
                )  # fmt: skip


def _repair(link: str, inertial: Mass, mended: dict[str, Fraction]) -> tuple[Edit, ...]:
    """The entries that moved, with all their digits: what is written is what was checked."""
    return tuple(
        Edit(link, "inertia", name, text_of(value))
        for name, value in mended.items()
        if value != inertial.entries[name].exact
    )


def _positive_but_impossible(inertial: Mass) -> bool:
    return inertial.positive and inertial.rank is None


BOUNDARY = {
    Shape.PLATE: "exactly on the boundary: only a plate without thickness has this inertia",
    Shape.ROD: "exactly on the boundary: only a rod without thickness has this inertia",
}


def boundary(subject: Subject) -> Iterator[Observation]:
    """Flat plates and thin rods, which are possible and at the very edge."""
    for body, inertial in _inertials(subject):
        shape = inertial.shape
        if shape in BOUNDARY:
            yield Observation(
                body, None, "", BOUNDARY[shape],
                "give the body its thickness: at the boundary, a consumer's rounding decides what it does",
            )  # fmt: skip


def point_mass(subject: Subject) -> Iterator[Observation]:
    """Mass, but no tensor."""
    for body, inertial in _inertials(subject):
        if inertial.shape is Shape.POINT:
            yield Observation(
                body, float(inertial.mass), "kg", "there is a mass, but the inertia is zero: a point",
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
