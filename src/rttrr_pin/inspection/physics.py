"""Checks of physics: what no rigid body can have, decided in rationals of the file's decimal text."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.checks import Edit, Observation, Severity, Subject, check
from rttrr_pin.inspection.exact import Shape, is_positive, nearest_possible, rank, shape
from rttrr_pin.inspection.merged import merged_links
from rttrr_pin.urdf.decimals import text_of
from rttrr_pin.urdf.inertial import NO_INERTIAL, UrdfInertial


@check("P101", Severity.ERROR)
def negative_mass(subject: Subject) -> Iterator[Observation]:
    """No mass is negative."""
    for link, inertial in subject.inertials():
        if inertial.mass.exact < 0:
            yield Observation(link, float(inertial.mass), "kg", "the mass is negative", "write the body's mass in kg")


@check("P102", Severity.ERROR)
def tensor_without_mass(subject: Subject) -> Iterator[Observation]:
    """A link without mass has no inertia either."""
    for link, inertial in subject.inertials():
        if inertial.mass.exact == 0 and not inertial.is_zero:
            yield Observation(
                link, 0.0, "kg", "the mass is zero, the inertia is not",
                "write the mass, or zeros for all of the inertia if the link is only a frame",
            )  # fmt: skip


def _massive(subject: Subject) -> dict[str, bool]:
    """For each link, whether there is mass on it or beyond."""
    document = subject.document
    massive = dict.fromkeys(document.links, False)
    massive |= {link.name: inertial.mass.exact != 0 for link, inertial in subject.inertials()}
    for _, name in reversed(list(document.walk())):
        massive[name] = massive[name] or any(massive[joint.child] for joint in document.children[name])
    return massive


@check("P103", Severity.WARNING)
def moving_without_mass(subject: Subject) -> Iterator[Observation]:
    """Each moving joint moves some mass, if the robot has any."""
    document, massive = subject.document, _massive(subject)
    reported = set[str]()
    for _, name in document.walk() if massive[document.root] else ():
        joint = document.carried_by.get(name)
        if joint is not None and joint.parent in reported:
            reported.add(name)
        elif joint is not None and joint.moves and not massive[name]:
            reported.add(name)
            yield Observation(
                document.links[name], 0.0, "kg",
                f"joint {joint.name!r} moves it, but there is no mass on it or beyond: the mass matrix is singular",
                "give it a mass and an inertia, or make the joint fixed",
            )  # fmt: skip


@check("P104", Severity.ERROR)
def indefinite(subject: Subject) -> Iterator[Observation]:
    """The inertia is positive semidefinite."""
    for link, inertial in subject.inertials():
        if not is_positive(inertial) and nearest_possible(inertial) is None:
            yield Observation(
                link, float(principal(inertial.tensor)[0][0]), "kg m^2",
                "the smallest principal moment is negative: the tensor is not positive definite",
                "compute the tensor anew; a wrong sign or slot among ixy, ixz, iyz does this",
            )  # fmt: skip


@check("P105", Severity.ERROR)
def triangle(subject: Subject) -> Iterator[Observation]:
    """The principal moments fulfil the triangle inequality; with it the 4x4 pseudo-inertia is positive semidefinite."""
    for link, inertial in subject.inertials():
        if is_positive(inertial) and rank(inertial) is None and nearest_possible(inertial) is None:
            low, mid, high = principal(inertial.tensor)[0]
            yield Observation(
                link, float(high - low - mid), "kg m^2",
                f"of the principal moments {low:.4g}, {mid:.4g} and {high:.4g} kg m^2, the last exceeds the sum of the "
                "others: no density has them",
                "compute the tensor anew, about the centre of mass, in kg m^2",
            )  # fmt: skip


@check("P106", Severity.WARNING)
def triangle_by_rounding(subject: Subject) -> Iterator[Observation]:
    """The digits written fulfil P104 and P105, and not only numbers that round to them."""
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


@check("P107", Severity.NOTE)
def boundary(subject: Subject) -> Iterator[Observation]:
    """The body has thickness: it is no exact plate and no exact rod."""
    for link, inertial in subject.inertials():
        body = shape(inertial)
        if body in BOUNDARY:
            yield Observation(
                link, None, "", BOUNDARY[body],
                "give the body its thickness: at the boundary, a parser's rounding decides what it does",
            )  # fmt: skip


@check("P108", Severity.WARNING)
def point_mass(subject: Subject) -> Iterator[Observation]:
    """A link with mass, together with what is fixed to it, has an inertia."""
    links = subject.document.links
    for name, merged in merged_links(subject.document).items():
        if merged.mass > 0.0 and not merged.inertia.any():
            massive = (links[each] for each in merged.members if (links[each].inertial or NO_INERTIAL).mass.exact)
            yield Observation(
                next(massive, links[name]), merged.mass, "kg", "there is a mass, but the inertia is zero: a point",
                "write the inertia about the centre of mass",
            )  # fmt: skip


@check("P109", Severity.WARNING)
def massless(subject: Subject) -> Iterator[Observation]:
    """Some link has a mass."""
    if not any(inertial.mass.exact for _, inertial in subject.inertials()):
        yield Observation(
            subject.document, 0.0, "kg",
            f"none of the {len(subject.document.links)} links has a mass: every force and torque is zero",
            "write an <inertial> for each body; a file for kinematics alone needs none",
        )  # fmt: skip


@check("P110", Severity.WARNING)
def collides_without_mass(subject: Subject) -> Iterator[Observation]:
    """A link that collides, together with what is fixed to it, has a mass, unless it is a base without <inertial>."""
    document, massive = subject.document, _massive(subject)
    for body in merged_links(document).values():
        links = [document.links[name] for name in body.members]
        colliding = [link for link in links if any(shape.role == "collision" for shape in link.shapes)]
        has_mass = any((link.inertial or NO_INERTIAL).mass.exact for link in links)
        meant = body.members[0] != document.root or any(link.inertial for link in links)
        if colliding and meant and massive[body.members[0]] and not has_mass:
            yield Observation(
                colliding[0], 0.0, "kg",
                "it collides, but has no mass: MuJoCo, Bullet and Isaac take one from its shapes, or refuse it",
                "write its mass and inertia",
            )  # fmt: skip
