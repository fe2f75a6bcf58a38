"""Hypotheses on a link and another: what is fixed to it, and its twin on the other side."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.core.joints import FIXED
from rttrr_pin.core.model import Link, Model
from rttrr_pin.diagnosis.catalogue.altering import differs, inertial_parameters, line_of, spread, symmetric, with_links
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.inspection.structure import other_side

Altered = Callable[[Model, int, int], Mapping[int, Link]]
"""The links that come out otherwise, of a link and the other."""


@dataclass(frozen=True, slots=True)
class PairSlip:
    """A slip of a `{link}` and an `{other}`: the one that it is fixed to, or its twin."""

    id: str
    sentence: str
    repair: str
    altered: Altered


def neighbours(model: Model) -> Iterator[Hypothesis]:
    """Slips of fixed links, and of links with a twin."""
    for i, joint in enumerate(model.joints):
        if joint.type is FIXED and model.links[i].mass:
            yield from _of_pair(model, LUMPED if joint.parent >= 0 else LUMPED[:1], i, joint.parent)
    index = {link.name: i for i, link in enumerate(model.links)}
    for i, link in enumerate(model.links):
        twins = [index[name] for name in other_side(link.name) if name in index]
        if twins and link.mass:
            yield from _of_pair(model, COPIED, i, twins[0])


def _of_pair(model: Model, slips: Sequence[PairSlip], i: int, other: int) -> Iterator[Hypothesis]:
    """Those that change a number."""
    link, beside = model.links[i].name, model.links[other].name if other >= 0 else model.root.name
    for slip in slips:
        altered = slip.altered(model, i, other).items()
        both = {k: (inertial_parameters(new), inertial_parameters(model.links[k])) for k, new in altered}
        if not any(differs(*pair) for pair in both.values()):
            continue
        yield Hypothesis(
            id=slip.id,
            kind="parameters",
            sentence=slip.sentence.format(link=link, other=beside),
            repair=slip.repair.format(link=link, other=beside),
            apply=partial(_apply, altered=slip.altered, i=i, other=other),
            link=link,
            parameters=spread(model, {k: new - own for k, (new, own) in both.items()}),
            values=lambda x: {"mass in the file": model.links[i].mass},
            line=line_of(model, link=link),
        )


def _apply(variant: Variant, x: Sequence[float], altered: Altered, i: int, other: int) -> Variant:
    return with_links(variant, altered(variant.model, i, other))


def _at_parent_origin(model: Model, i: int, other: int) -> Mapping[int, Link]:
    """The centre of mass at the origin of the link that carries it, p + R r_C = 0."""
    joint = model.joints[i]
    return {i: replace(model.links[i], com=-joint.R.T @ joint.p)}


def _com_of_parent(model: Model, i: int, other: int) -> Mapping[int, Link]:
    """The centre of mass where that of the link that carries it is."""
    joint = model.joints[i]
    return {i: replace(model.links[i], com=joint.R.T @ (model.links[other].com - joint.p))}


def _tensor_not_turned(model: Model, i: int, other: int) -> Mapping[int, Link]:
    """The tensor, in the axes of the link itself, taken for one in those of the link that carries it."""
    R, link = model.joints[i].R, model.links[i]
    return {i: replace(link, inertia=symmetric(R.T @ link.inertia @ R))}


def _without_parallel_axes(model: Model, i: int, other: int) -> Mapping[int, Link]:
    """The tensor about the link's own centre of mass added to the other's, that about the other's origin being due."""
    joint, link, carrier = model.joints[i], model.links[i], model.links[other]
    missing = link.mass * point_tensor(Vector.of(joint.p + joint.R @ link.com)).array
    return {other: replace(carrier, inertia=symmetric(carrier.inertia - missing))}


def _copy(*names: str) -> Altered:
    """What the twin has."""

    def altered(model: Model, i: int, other: int) -> Mapping[int, Link]:
        own: dict[str, Any] = {name: getattr(model.links[other], name) for name in names}
        return {i: replace(model.links[i], **own)}

    return altered


LUMPED = (
    PairSlip(
        "fixed link at the parent's origin", "the mass of {link} is taken to be at the origin of {other}",
        "move {link} to {other} by the placement of its fixed joint: p + R r_C", _at_parent_origin,
    ),
    PairSlip(
        "fixed link at the parent's COM", "the mass of {link} is added to that of {other}, whose centre of mass stays",
        "compute the common centre of mass of {link} and {other}", _com_of_parent,
    ),
    PairSlip(
        "fixed link without parallel axes",
        "the tensor of {link} about its own centre of mass is added to that of {other}",
        "move the tensor of {link} to the origin of {other}: add m (d.d 1 - d d^T)", _without_parallel_axes,
    ),
    PairSlip(
        "tensor of a fixed link not turned",
        "the tensor of {link} is added to that of {other} without being turned to its axes",
        "turn the tensor of {link} by R of its fixed joint: R I R^T", _tensor_not_turned,
    ),
)  # fmt: skip

COPIED = (
    PairSlip(
        "COM of the twin", "the centre of mass of {link} is that of {other}",
        "mirror the centre of mass of {link}", _copy("com"),
    ),
    PairSlip(
        "tensor of the twin", "the tensor of {link} is that of {other}", "mirror the tensor of {link}",
        _copy("inertia"),
    ),
    PairSlip(
        "inertia of the twin", "mass, centre of mass and tensor of {link} are those of {other}",
        "mirror the inertia of {link}", _copy("mass", "com", "inertia"),
    ),
)  # fmt: skip
