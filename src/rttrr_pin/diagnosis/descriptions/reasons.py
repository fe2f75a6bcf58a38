"""Why the inertia of a link differs: one description is the other, read or written with a known slip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import TEN, inertial_parameters
from rttrr_pin.diagnosis.catalogue.parameters import KINDS, known_slips
from rttrr_pin.diagnosis.descriptions.tolerance import PRINTED

NEAR = 4.0
"""Times what six digits leave: mass, centre of mass and tensor were printed each, and these are products of them."""


def reasons(a: Model, b: Model, pairs: Sequence[tuple[str, str]]) -> Iterator[str]:
    """One sentence for each link whose inertia in one model is what a slip makes of that in the other.

    The slips are those of `diagnose`, at one link, without a fitted number; all ten parameters must be what it makes.

    Args:
        a: the first model.
        b: the second.
        pairs: names of the links that are one, first and second.
    """
    of_b = dict(pairs)
    of_a = {second: first for first, second in pairs}
    told: dict[str, dict[str, str]] = {}
    for which, own, other, partner in (("the second", a, b, of_b), ("the first", b, a, of_a)):
        for link, sentence in _slips(own, other, partner):
            of_link = told.setdefault(link if own is a else partner[link], {})
            of_link[sentence] = "one of them" if sentence in of_link else which
    for sentences in told.values():
        yield "; or ".join(f"in {which}, {sentence}" for sentence, which in sentences.items())


def _slips(own: Model, other: Model, partner: dict[str, str]) -> Iterator[tuple[str, str]]:
    """Links of a model, and the slips that make of them what the other model has."""
    index, there = ({link.name: i for i, link in enumerate(model.links)} for model in (own, other))
    unlike = {}
    for name, k in index.items():
        if partner.get(name) in there:
            x, y = inertial_parameters(own.links[k]), inertial_parameters(other.links[there[partner[name]]])
            if not _same(x, y):
                unlike[name] = x, y
    if not unlike:
        return
    for slip in known_slips(own):
        if slip.link in unlike and slip.parameters is not None:
            x, y = unlike[slip.link]
            changes = slip.parameters.reshape(-1, TEN)
            if np.count_nonzero(changes.any(axis=1)) == 1 and _same(x + changes[index[slip.link]], y):
                yield slip.link, slip.sentence


def _same(x: Array, y: Array) -> bool:
    """Whether two sets of ten parameters are one, to the digits that are printed."""
    return all(
        np.abs(x[kind] - y[kind]).max() <= NEAR * PRINTED * max(np.abs(x[kind]).max(), np.abs(y[kind]).max())
        for kind in KINDS
    )
