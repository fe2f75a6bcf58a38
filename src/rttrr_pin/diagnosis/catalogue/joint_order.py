"""Hypotheses on the order of joints: whose numbers stand in which column."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.slots import Slots, single, slots
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.urdf.document import UrdfDocument

ALL_PAIRS = 12
"""Joints up to which every two may be exchanged; beyond, neighbours."""

EXCHANGED = "joints exchanged"

Order = tuple[int, ...]
"""Of the joints of one coordinate: the k-th column is taken for that of the joint of this index."""


def orders(model: Model) -> Iterator[Hypothesis]:
    """Other orders of the joints of one coordinate: of q, v, a and tau together, and of tau alone."""
    own = single(slots(model))
    seen = {tuple(range(len(own)))}
    for id, sentence, order in (*_whole_orders(model, own), *_exchanges(own)):
        if order not in seen:
            seen.add(order)
            yield from _both(id, sentence, own, order)
    if model.floating:
        yield from _base_slots(model)


def _whole_orders(model: Model, own: Sequence[Slots]) -> Iterator[tuple[str, str, Order]]:
    """Orders of all joints."""
    n = len(own)
    if n < 2:
        return
    names = [one.name for one in own]
    yield "order reversed", "the joints are taken in reversed order", tuple(reversed(range(n)))
    known = {"alphabetical order": sorted(names), "breadth-first order": _breadth_first(model, names)}
    if isinstance(model.document, UrdfDocument):
        in_file = [name for name in model.document.joints if name in names]
        if len(in_file) == n:
            known |= {
                "order of the file": in_file,
                "depth-first order of the file": _depth_first(model.document, names),
            }
    for id, order in known.items():
        there = tuple(names.index(name) for name in order)
        yield id, f"the joints are taken in {id}", there
        back = tuple(int(k) for k in np.argsort(there))
        yield f"{id}, inverted", f"the joints are put back from {id}, which they are not in", back
    yield "joints shifted by one", "each joint is given the column of the one behind it", (*range(1, n), 0)
    yield "joints shifted back by one", "each joint is given the column of the one before it", (n - 1, *range(n - 1))


def _breadth_first(model: Model, names: Sequence[str]) -> list[str]:
    """By number of joints from the root, as Isaac Lab has them."""
    depth = {joint.name: len(list(model.path(i))) for i, joint in enumerate(model.joints)}
    return sorted(names, key=depth.__getitem__)


def _depth_first(document: UrdfDocument, names: Sequence[str]) -> list[str]:
    """Depth first, the joints on a link in the order of the file, as MuJoCo has them."""
    place = {name: k for k, name in enumerate(document.joints)}
    waiting, found = [document.root], list[str]()
    while waiting:
        link = waiting.pop()
        joint = document.carried_by.get(link)
        if joint is not None and joint.name in names:
            found.append(joint.name)
        children = sorted(document.children[link], key=lambda one: place[one.name], reverse=True)
        waiting += [one.child for one in children]
    return found


def _exchanges(own: Sequence[Slots]) -> Iterator[tuple[str, str, Order]]:
    """Two joints exchanged."""
    n = len(own)
    pairs = combinations(range(n), 2) if n <= ALL_PAIRS else ((k, k + 1) for k in range(n - 1))
    for i, j in pairs:
        order = list(range(n))
        order[i], order[j] = j, i
        yield EXCHANGED, f"{own[i].name} and {own[j].name} are exchanged", tuple(order)


def _both(id: str, sentence: str, own: Sequence[Slots], order: Order) -> Iterator[Hypothesis]:
    """The order of all that is per joint, and of tau alone."""
    said: Mapping[str, Any] = {"order": [own[k].name for k in order]}
    repair = f"order by joint name: {', '.join(one.name for one in own)}"
    joint = " and ".join(own[k].name for k in range(len(own)) if order[k] != k) if id == EXCHANGED else None
    for end, where, apply in (
        ("", "q, v, a and tau", partial(_ordered, own=own, order=order)),
        (" in tau", "tau alone", partial(_tau_ordered, own=own, order=order)),
    ):
        yield Hypothesis(
            id=id + end,
            kind="convention",
            sentence=f"{sentence}, in {where}",
            repair=repair,
            apply=apply,
            joint=joint,
            values=lambda x: said,
        )


def _ordered(variant: Variant, x: Sequence[float], own: Sequence[Slots], order: Order) -> Variant:
    """Column k of all is that of joint `order[k]`."""
    q, v = ([getattr(one, name)[0] for one in own] for name in "qv")

    def inputs(batch: Batch) -> Batch:
        return replace(batch, q=_moved(batch.q, q, order), v=_moved(batch.v, v, order), a=_moved(batch.a, v, order))

    return _tau_ordered(variant.with_input(inputs), x, own, order)


def _moved(x: Array, columns: Sequence[int], order: Order) -> Array:
    """What stands in the k-th of some columns, in that of joint `order[k]`."""
    moved = x.copy()
    moved[:, [columns[joint] for joint in order]] = x[:, columns]
    return moved


def _tau_ordered(variant: Variant, x: Sequence[float], own: Sequence[Slots], order: Order) -> Variant:
    def outputs(batch: Batch, values: Values) -> Values:
        tau = values["tau"].copy()
        tau[:, [one.v[0] for one in own]] = values["tau"][:, [own[joint].v[0] for joint in order]]
        return {**values, "tau": tau}

    return variant.with_output(outputs)


def _base_slots(model: Model) -> Iterator[Hypothesis]:
    """Tau of a robot that floats, its base's six numbers forgotten or elsewhere."""
    n, base = model.nv, slots(model)[0]
    width = len(base.v)
    if n == width:
        return
    rest = np.arange(n)
    forgotten = np.where(rest < width, rest, rest - width)
    for id, sentence, columns in (
        ("index of joints without the base", f"tau of a joint is read {width} columns too early", forgotten),
        ("base behind the joints", "tau of the base stands behind that of the joints", (rest + width) % n),
        ("base before the joints", "tau of the base is read from the last columns", (rest - width) % n),
    ):
        yield Hypothesis(
            id=id,
            kind="convention",
            sentence=sentence,
            repair=f"the joints begin behind the {width} columns of {base.name}",
            apply=partial(_tau_columns, columns=columns.tolist()),
        )


def _tau_columns(variant: Variant, x: Sequence[float], columns: list[int]) -> Variant:
    return variant.with_output(lambda batch, values: {**values, "tau": values["tau"][:, columns]})
