"""Hypotheses on inertial parameters: what a program may have in place of a link's mass, centre of mass and tensor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joints import FIXED
from rttrr_pin.core.model import Link, Model
from rttrr_pin.diagnosis.catalogue.altering import (
    differs,
    each_and_all,
    inertial_parameters,
    line_of,
    spread,
    with_links,
)
from rttrr_pin.diagnosis.catalogue.fitted_links import fitted
from rttrr_pin.diagnosis.catalogue.link_slips import LINK_SLIPS, LinkSlip, Slipped
from rttrr_pin.diagnosis.catalogue.neighbours import neighbours
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.urdf.document import UrdfDocument

KINDS = slice(0, 1), slice(1, 4), slice(4, 10)
"""Mass, first moment and tensor of the ten parameters."""


def parameters(model: Model) -> list[Hypothesis]:
    """All hypotheses on the inertial parameters of a robot; those that change no number of it are left out."""
    return [*known_slips(model), *fitted(model)]


def known_slips(model: Model) -> list[Hypothesis]:
    """Those of them without a number to fit."""
    return [*_slips(model), *_defaults(model), *neighbours(model)]


def _slips(model: Model) -> Iterator[Hypothesis]:
    """Known slips at each link, and at every one at once."""
    own = {i: inertial_parameters(link) for i, link in enumerate(model.links)}
    massive = [i for i, link in enumerate(model.links) if own[i].any()]
    frames = {i: _inertial_frame(model, model.links[i]) for i in massive}
    told: dict[tuple[str, int], list[Array]] = {}
    for slip in LINK_SLIPS:
        changes: dict[int, Array] = {}
        for i in massive:
            if slip.turned and np.array_equal(frames[i], np.eye(3)):
                continue
            new = inertial_parameters(slip.slipped(model.links[i], frames[i]))
            before = told.setdefault((slip.family, i), [own[i]]) if slip.family else [own[i]]
            if all(differs(new, other, KINDS) for other in before):
                changes[i] = new - own[i]
                before.append(new)
        yield from (_one(model, slip, i, frames, change) for i, change in changes.items())
        if slip.everywhere and len(changes) > 1:
            yield _every(model, slip, frames, changes)
    fixed = [i for i in massive if model.joints[i].type is FIXED]
    if len(fixed) > 1:
        yield _fixed_ignored(model, {i: -own[i] for i in fixed})


def _defaults(model: Model) -> Iterator[Hypothesis]:
    """Links that have no inertia, and get that of a body by default, as in DART: each, and all of them."""
    empty = [i for i, link in enumerate(model.links) if not inertial_parameters(link).any()]
    for some in each_and_all(empty):
        links = {i: replace(model.links[i], mass=1.0, inertia=np.eye(3)) for i in some}
        name = model.links[some[0]].name if len(some) == 1 else None
        told = f"{name}, which has no inertia," if name else "every link that has no inertia"
        yield Hypothesis(
            id="default inertia" if name else "default inertia at every link",
            kind="parameters",
            sentence=f"{told} counts with 1 kg and a tensor of 1 kg m^2 about each axis",
            repair=f"let {name or 'links without inertia'} have no mass; some programs need an <inertial> of zeros",
            apply=partial(_apply_links, links=links),
            link=name,
            parameters=spread(model, {i: inertial_parameters(link) for i, link in links.items()}),
            values=lambda x: {"mass": 1.0, "mass in the file": 0.0},
            line=line_of(model, link=name),
        )


def _apply_links(variant: Variant, x: Sequence[float], links: Mapping[int, Link]) -> Variant:
    return with_links(variant, links)


def _inertial_frame(model: Model, link: Link) -> Array:
    """R of a link's inertial frame in the link frame; the identity where it is not turned, or there is no file."""
    document = model.document
    element = document.links.get(link.name) if link.rotated and isinstance(document, UrdfDocument) else None
    inertial = None if element is None else element.inertial
    if inertial is None or not np.array_equal(inertial.inertia, link.inertia):
        return np.eye(3)
    return inertial.origin.R


def _apply(variant: Variant, x: Sequence[float], slipped: Slipped, frames: Mapping[int, Array]) -> Variant:
    """The slip at some links."""
    return with_links(variant, {i: slipped(variant.model.links[i], R) for i, R in frames.items()})


def _one(model: Model, slip: LinkSlip, i: int, frames: Mapping[int, Array], change: Array) -> Hypothesis:
    """A slip at one link."""
    link = model.links[i]
    return Hypothesis(
        id=_id(model, slip, i),
        kind="parameters",
        sentence=slip.sentence.format(link=link.name),
        repair=slip.repair.format(link=link.name, kg=f", its {link.mass:.6g} kg" if link.mass else ""),
        apply=partial(_apply, slipped=slip.slipped, frames={i: frames[i]}),
        link=link.name,
        parameters=spread(model, {i: change}),
        values=partial(_numbers, link=link, slipped=slip.slipped, R=frames[i]),
        line=line_of(model, link=link.name),
    )


def _id(model: Model, slip: LinkSlip, i: int) -> str:
    """Links that are fixed, and the base of a robot that floats, have names of their own where they are ignored."""
    if slip.id == "link ignored" and model.joints[i].type is FIXED:
        return "fixed link ignored"
    if slip.id == "link ignored" and model.floating and i == 0:
        return "root link ignored"
    return slip.id


def _numbers(x: Sequence[float], link: Link, slipped: Slipped, R: Array) -> Mapping[str, Any]:
    """What of a link is other than in the file."""
    other, values = slipped(link, R), dict[str, Any]()
    for name, new, own in (
        ("mass", other.mass, link.mass),
        ("COM", other.com.tolist(), link.com.tolist()),
        ("tensor", other.inertia.tolist(), link.inertia.tolist()),
    ):
        if new != own:
            values |= {name: new, f"{name} in the file": own}
    return values


def _every(model: Model, slip: LinkSlip, frames: Mapping[int, Array], changes: Mapping[int, Array]) -> Hypothesis:
    """A slip at every link."""
    return Hypothesis(
        id=f"{slip.id} at every link",
        kind="parameters",
        sentence=slip.sentence.format(link="every link"),
        repair=slip.repair.format(link="every link", kg=""),
        apply=partial(_apply, slipped=slip.slipped, frames={i: frames[i] for i in changes}),
        parameters=spread(model, changes),
    )


def _fixed_ignored(model: Model, changes: Mapping[int, Array]) -> Hypothesis:
    """No fixed link is counted."""
    mass = sum(model.links[i].mass for i in changes)
    return Hypothesis(
        id="fixed links ignored",
        kind="parameters",
        sentence="the mass and inertia of links on fixed joints are not counted",
        repair=f"add each of them to the link that carries it, {mass:.6g} kg in all",
        apply=lambda variant, x: with_links(variant, {i: Link(model.links[i].name) for i in changes}),
        parameters=spread(model, changes),
        values=lambda x: {"mass": 0.0, "mass in the file": mass},
    )
