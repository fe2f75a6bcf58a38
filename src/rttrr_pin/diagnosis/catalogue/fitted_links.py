"""Hypotheses whose numbers are fitted: a link's mass, centre of mass and tensor are others than in the file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from rttrr_pin.core.algebra import Matrix
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.identification import INERTIAL
from rttrr_pin.core.inertia import SpatialInertia
from rttrr_pin.core.model import Link, Model
from rttrr_pin.diagnosis.catalogue.altering import (
    TEN,
    WORDS,
    inertial_parameters,
    line_of,
    link_of,
    spread,
    told_factor,
    with_links,
)
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.inspection.plausibility import LENGTH_UNITS
from rttrr_pin.inspection.readings import MASS_UNITS, TENSOR_UNITS
from rttrr_pin.urdf.inertial import ENTRIES

MASSES, LENGTHS, TENSORS = MASS_UNITS | WORDS, LENGTH_UNITS | WORDS, TENSOR_UNITS | WORDS

SIX = tuple(name.replace("I_", "i") for name in INERTIAL[4:])
"""The tensor's entries in the order of the parameters, by URDF's names."""

Fitted = Callable[[Link, Array], Link]
"""The link with numbers that say nothing where they are 0."""


@dataclass(frozen=True, slots=True)
class LinkFit:
    """Numbers of a link that are fitted.

    Attributes:
        id: what it is called.
        sentence: what is other at `{link}`.
        fitted: the link with them.
        start: where the fit begins, from a link.
        told: of the link of the file and that of the fit.
        directions: the change of the ten parameters with each number, (fitted, 10); None where it is not linear.
        holds: whether the link has what is fitted.
        places: whether it is made at each link, by one number at all of them, or both.
    """

    id: str
    sentence: str
    fitted: Fitted
    start: Callable[[Link], Array]
    told: Callable[[Link, Array], Mapping[str, Any]]
    directions: Callable[[Link], Array] | None
    holds: Callable[[Link], bool]
    places: Literal["each", "all", "both"] = "each"


def fitted(model: Model) -> Iterator[Hypothesis]:
    """Every fit at every link, and those of one number at all of them."""
    for fit in FITS:
        links = {i: link for i, link in enumerate(model.links) if link.mass and fit.holds(link)}
        if fit.places != "all":
            yield from (_at(model, fit, {i: link}) for i, link in links.items())
        if fit.places != "each" and len(links) > 1:
            yield _at(model, fit, links)


def _at(model: Model, fit: LinkFit, links: Mapping[int, Link]) -> Hypothesis:
    """A fit at some links."""
    first, name = next(iter(links.values())), "every link"
    if len(links) == 1:
        name = first.name
    start = fit.start(first)
    directions = {} if fit.directions is None else {i: fit.directions(link) for i, link in links.items()}

    def told(x: Sequence[float]) -> Mapping[str, Any]:
        return fit.told(first, np.array(x))

    return Hypothesis(
        id=fit.id if len(links) == 1 else f"{fit.id} at every link",
        kind="parameters",
        sentence=fit.sentence.format(link=name),
        repair=f"use the file's: {fit.sentence.format(link=name)}",
        apply=partial(_apply, fitted=fit.fitted, indices=tuple(links)),
        link=first.name if len(links) == 1 else None,
        start=tuple(start.tolist()),
        neutral=(0.0,) * len(start),
        parameters=spread(model, directions) if directions else None,
        values=told,
        line=line_of(model, link=first.name) if len(links) == 1 else "",
    )


def _apply(variant: Variant, x: Sequence[float], fitted: Fitted, indices: tuple[int, ...]) -> Variant:
    """Some links with the same numbers."""
    numbers = np.array(x, dtype=np.float64)
    return with_links(variant, {i: fitted(variant.model.links[i], numbers) for i in indices})


def _six(x: Array) -> Array:
    """The tensor of six entries in the order of the parameters."""
    return SpatialInertia.of_parameters((0.0, 0.0, 0.0, 0.0, *x.tolist())).J.array


def _entries(tensor: Array) -> dict[str, float]:
    """By URDF's names, in the order of the file."""
    return {name: float(tensor[at]) for name, at in ENTRIES.items()}


def _whole(link: Link, x: Array) -> Link:
    """All ten parameters changed; at zero the link is itself, to the bit."""
    return link_of(link, inertial_parameters(link) + x) if x.any() else link


def _told_mass(link: Link, x: Array) -> Mapping[str, Any]:
    mass = link.mass + float(x[0])
    return {"mass": mass, "mass in the file": link.mass, **told_factor(mass / link.mass, MASSES)}


def _told_com(link: Link, x: Array) -> Mapping[str, Any]:
    return {"COM": (link.com + x).tolist(), "COM in the file": link.com.tolist()}


def _told_tensor(link: Link, x: Array) -> Mapping[str, Any]:
    return {"tensor": _entries(link.inertia + _six(x)), "tensor in the file": _entries(link.inertia)}


def _told_whole(link: Link, x: Array) -> Mapping[str, Any]:
    own = inertial_parameters(link)
    return {
        "parameters": dict(zip(INERTIAL, (own + x).tolist(), strict=True)),
        "parameters in the file": dict(zip(INERTIAL, own.tolist(), strict=True)),
    }


def _mass_direction(link: Link) -> Array:
    """A mass more at the centre of mass."""
    return inertial_parameters(Link(link.name, 1.0, link.com))[None]


def _tensor_rows(J: Array) -> Array:
    """The ten parameters of a tensor alone."""
    return np.array(SpatialInertia(J=Matrix.of(J)).parameters, dtype=np.float64)


def _size(link: Link) -> float:
    """A moment of inertia of the size of the link's."""
    return float(np.abs(inertial_parameters(link)[4:]).max()) or 1e-3 * abs(link.mass)


def _whole_start(link: Link) -> Array:
    """A tenth more of everything, and a little of what there is none of."""
    return 0.1 * np.abs(inertial_parameters(link)) + _tensor_rows(1e-3 * _size(link) * np.ones((3, 3)))


def _entry(k: int) -> LinkFit:
    """One entry of the tensor, in the axes of the link."""
    name, direction = SIX[k], np.eye(6)[k]
    row = np.concatenate([np.zeros(4), direction])[None]
    at = ENTRIES[name]

    def told(link: Link, x: Array) -> Mapping[str, Any]:
        old = float(link.inertia[at])
        return {name: old + float(x[0]), f"{name} in the file": old}

    return LinkFit(
        f"{name} of another size", f"{name} of {{link}} is another", lambda link, x: replace(
            link, inertia=link.inertia + x[0] * _six(direction)), lambda link: np.array([0.5 * _size(link)]),
        told, lambda link: row, lambda link: True,
    )  # fmt: skip


def _has_tensor(link: Link) -> bool:
    return bool(link.inertia.any())


def _has_com(link: Link) -> bool:
    return bool(link.com.any())


def _one(link: Link) -> Array:
    return np.array([1.0])


FITS = (
    LinkFit(
        "mass of another size", "the mass of {link} is another",
        lambda link, x: replace(link, mass=link.mass + float(x[0])), lambda link: np.array([link.mass]),
        _told_mass, _mass_direction, lambda link: True,
    ),
    LinkFit(
        "mass of another size", "the mass of {link} is multiplied by one factor",
        lambda link, x: replace(link, mass=link.mass * (1.0 + float(x[0]))), _one,
        lambda link, x: told_factor(1.0 + float(x[0]), MASSES), lambda link: link.mass * _mass_direction(link),
        lambda link: True, "all",
    ),
    LinkFit(
        "inertia of another size", "mass and tensor of {link} are multiplied by one factor",
        lambda link, x: replace(
            link, mass=link.mass * (1.0 + float(x[0])), inertia=link.inertia * (1.0 + float(x[0]))
        ), _one,
        lambda link, x: told_factor(1.0 + float(x[0]), MASSES), lambda link: inertial_parameters(link)[None],
        _has_tensor, "both",
    ),
    LinkFit(
        "tensor of another size", "the tensor of {link} is multiplied by one factor",
        lambda link, x: replace(link, inertia=link.inertia * (1.0 + float(x[0]))), _one,
        lambda link, x: told_factor(1.0 + float(x[0]), TENSORS), lambda link: _tensor_rows(link.inertia)[None],
        _has_tensor, "both",
    ),
    LinkFit(
        "COM of another size", "the centre of mass of {link} is multiplied by one factor",
        lambda link, x: replace(link, com=link.com * (1.0 + float(x[0]))), _one,
        lambda link, x: told_factor(1.0 + float(x[0]), LENGTHS), None, _has_com, "both",
    ),
    *(_entry(k) for k in range(6)),
    LinkFit(
        "COM at another place", "the centre of mass of {link} is at another place",
        lambda link, x: replace(link, com=link.com + x),
        lambda link: np.full(3, 0.1 * (float(np.linalg.norm(link.com)) or 0.1)), _told_com, None, lambda link: True,
    ),
    LinkFit(
        "another tensor", "the tensor of {link} is another",
        lambda link, x: replace(link, inertia=link.inertia + _six(x)),
        lambda link: 0.1 * _size(link) * np.array([1.0, 0.1, 1.0, 0.1, 0.1, 1.0]), _told_tensor,
        lambda link: np.hstack([np.zeros((6, 4)), np.eye(6)]), lambda link: True,
    ),
    LinkFit(
        "another inertia", "mass, centre of mass and tensor of {link} are others", _whole,
        _whole_start, _told_whole, lambda link: np.eye(TEN), lambda link: True,
    ),
)  # fmt: skip
