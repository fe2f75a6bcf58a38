"""Errors in the lever of F that are in no one place of the recursion: F acts where the next joint is."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.catalogue.kinematics import on_parents
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant, run
from rttrr_pin.implementations.protocol import Batch

REPAIR = "in n_i, F_i acts at the centre of mass of link i: r_C x F, not p_i+1 x F"


def levers(model: Model) -> list[Hypothesis]:
    """F at the origin of the next link, which has no next at the end of a branch, at every link and at each."""
    massive = tuple(i for i, link in enumerate(model.links) if link.mass)
    groups = [massive] if len(massive) > 1 else []
    return [_at_next(model, links) for links in (*groups, *((i,) for i in massive))]


def _at_next(model: Model, links: tuple[int, ...]) -> Hypothesis:
    name = model.links[links[0]].name if len(links) == 1 else None
    return Hypothesis(
        id="force at the next joint" + ("" if name else " at every link"),
        kind="mechanics",
        sentence=f"in n of {name or 'every link'}, F acts at the origin of the next link, not at the centre of mass; "
        "of the last link, at its own origin",
        repair=REPAIR,
        apply=partial(_apply, links=links),
        link=name,
        line="core/newton_euler.py, inwards:  n = keep(N + n_on + body.r_C.cross(F))",
    )


def _apply(variant: Variant, x: Sequence[float], links: tuple[int, ...]) -> Variant:
    model = variant.model
    still = model.with_gravity(np.zeros(3))
    following = {joint.parent: i for i, joint in reversed(list(enumerate(model.joints)))}

    def outputs(batch: Batch, values: Values) -> Values:
        own = variant.given(batch)
        p = on_parents(model, own)[1]
        loads = []
        for i in links:
            lever = p[:, following[i]] if i in following else np.zeros((len(own), 3))
            moment = np.cross(lever - model.links[i].com, values["F"][:, i])
            loads.append(Load(i, np.zeros(3), moment))
        nothing = np.zeros_like(own.v)
        more = run(still, Batch(model, own.q, nothing, nothing, tuple(loads)))
        return {**values, "n": values["n"] + more["n"], "tau": values["tau"] + more["tau"]}

    return variant.with_output(outputs)
