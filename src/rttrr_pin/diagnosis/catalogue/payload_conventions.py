"""Hypotheses on payloads: sign, frame and point; they show where a batch has loads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.catalogue.kinematics import in_base, on_parents, turned, turned_back
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.implementations.protocol import Batch

Taken = Callable[[Model, Batch, Load], Load]
"""The payload as the program takes it."""


def payload_conventions(model: Model) -> list[Hypothesis]:
    """All of them."""
    com = any(link.com.any() for link in model.links)
    return [own for own in SLIPS if com or own.id != "payload at the COM"] if model.links else []


def _slip(id: str, sentence: str, repair: str, taken: Taken) -> Hypothesis:
    return Hypothesis(id, "convention", sentence, repair, partial(_apply, taken=taken))


def _apply(variant: Variant, x: Sequence[float], taken: Taken) -> Variant:
    model = variant.model
    return variant.with_input(
        lambda batch: replace(batch, loads=tuple(taken(model, batch, load) for load in batch.loads))
    )


def _times(model: Model, batch: Batch, load: Load, factor: float) -> Load:
    return replace(load, f=factor * load.f, n=factor * load.n)


def _other_axes(to_base: bool) -> Taken:
    """The same numbers in base axes, or in those of the link."""
    return lambda model, batch, load: replace(load, in_base=to_base)


def _moved(arm: Callable[[Model, Batch, Load], Array]) -> Taken:
    """The force acts at another point: n + r x f, r in the axes of the load."""
    return lambda model, batch, load: replace(load, n=load.n + np.cross(arm(model, batch, load), load.f))


def _com(model: Model, batch: Batch, load: Load) -> Array:
    """From the origin of the link to its centre of mass."""
    com = model.links[load.link].com
    return turned(in_base(model, batch)[0][:, load.link], com) if load.in_base else com


def _from_base(model: Model, batch: Batch, load: Load) -> Array:
    """From the origin of the link to that of the base."""
    R, p = (x[:, load.link] for x in in_base(model, batch))
    return -p if load.in_base else -turned_back(R, p)


def _from_parent(model: Model, batch: Batch, load: Load) -> Array:
    """From the origin of the link to that of its parent."""
    R, p = (x[:, load.link] for x in on_parents(model, batch))
    own = -turned_back(R, p)
    return turned(in_base(model, batch)[0][:, load.link], own) if load.in_base else own


def _at_parent(model: Model, batch: Batch, load: Load) -> Load:
    """At the link before, where there is one."""
    parent = model.joints[load.link].parent
    return replace(load, link=parent) if parent >= 0 else load


def _spatial_in_base(model: Model, batch: Batch, load: Load) -> Load:
    """The numbers in base axes and about the origin of the base."""
    return _moved(_from_base)(model, batch, replace(load, in_base=True))


def _exchanged(model: Model, batch: Batch, load: Load) -> Load:
    return replace(load, f=load.n, n=load.f)


SLIPS = (
    _slip(
        "sign of the payload", "the payload has the opposite sign: it is taken for what acts on the robot",
        "negate it: the payload is what the robot exerts on its surroundings", partial(_times, factor=-1.0),
    ),
    _slip("payload twice", "the payload is counted twice", "count it once", partial(_times, factor=2.0)),
    _slip(
        "payload in base axes", "the payload, given in the axes of its link, is taken for one in base axes",
        "turn the payload by R^T from base axes", _other_axes(True),
    ),
    _slip(
        "payload in link axes", "the payload, given in base axes, is taken for one in the axes of its link",
        "turn the payload by R^T from base axes", _other_axes(False),
    ),
    _slip(
        "payload in base axes about the base",
        "the payload is taken for one in base axes, its moment about the origin of the base",
        "the payload acts at the origin of its link", _spatial_in_base,
    ),
    _slip(
        "payload at the COM", "the force of the payload acts at the centre of mass of its link",
        "let it act at the origin of the link's frame", _moved(_com),
    ),
    _slip(
        "payload about the base", "the moment of the payload is taken about the origin of the base",
        "take it about the origin of the link's frame", _moved(_from_base),
    ),
    _slip(
        "payload about the parent's origin", "the moment of the payload is taken about the origin of the link before",
        "take it about the origin of the link's frame", _moved(_from_parent),
    ),
    _slip(
        "payload at the parent", "the payload acts at the link before, with the same numbers",
        "let it act at its own link", _at_parent,
    ),
    _slip(
        "payload without moment", "the moment of the payload is not counted", "add n of the payload",
        lambda model, batch, load: replace(load, n=0.0 * load.n),
    ),
    _slip(
        "payload without force", "the force of the payload is not counted", "add f of the payload",
        lambda model, batch, load: replace(load, f=0.0 * load.f),
    ),
    _slip(
        "payload, moment first", "force and moment of the payload are exchanged", "pass the force first", _exchanged
    ),
    _slip(
        "payload ignored", "the payload is not counted", "add the payload to f and n of its link",
        partial(_times, factor=0.0),
    ),
    Hypothesis(
        id="factor of the payload",
        kind="convention",
        sentence="the payload is multiplied by a factor",
        repair="count the payload once, in N and N m",
        apply=lambda variant, x: _apply(variant, x, partial(_times, factor=float(x[0]))),
        start=(1.5,),
        neutral=(1.0,),
        values=lambda x: {"factor": x[0]},
    ),
)  # fmt: skip
