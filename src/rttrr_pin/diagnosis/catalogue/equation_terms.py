"""Hypotheses on the terms of the equation of motion: which of them count, and how often."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import WORDS, told_first, with_gravity
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant, run
from rttrr_pin.implementations.protocol import Batch


@dataclass(frozen=True, slots=True)
class Term:
    """What of the equation of motion is left out: rates, accelerations, gravity."""

    id: str
    sentence: str
    repair: str
    v: bool = False
    a: bool = False
    gravity: bool = False


TERMS = (
    Term("rates ignored", "rates are not counted: tau has no velocity terms", "pass v", v=True),
    Term("accelerations ignored", "accelerations are not counted: tau is nle, without M a", "pass a", a=True),
    Term("gravity alone", "tau is gravity compensation alone: neither rates nor accelerations count", "pass v and a",
         v=True, a=True),
    Term("M a alone", "tau is M a alone, without nle", "add velocity terms and gravity", v=True, gravity=True),
    Term("velocity terms alone", "tau is made of velocity terms alone", "add M a and gravity", a=True, gravity=True),
)  # fmt: skip


def equation_terms(model: Model) -> Iterator[Hypothesis]:
    """Terms left out, and factors of them."""
    for term in TERMS:
        if not term.gravity or model.gravity.any():
            yield Hypothesis(term.id, "convention", term.sentence, term.repair, partial(_without, term=term))
    for id, sentence, repair, apply in FACTORS:
        yield Hypothesis(
            id=id,
            kind="convention",
            sentence=sentence,
            repair=repair,
            apply=apply,
            start=(1.5,),
            neutral=(1.0,),
            values=partial(told_first, units=WORDS),
        )


def _without(variant: Variant, x: Sequence[float], term: Term) -> Variant:
    def inputs(batch: Batch) -> Batch:
        v = np.zeros_like(batch.v) if term.v else batch.v
        a = np.zeros_like(batch.a) if term.a else batch.a
        return replace(batch, v=v, a=a)

    return (with_gravity(variant, np.zeros(3)) if term.gravity else variant).with_input(inputs)


def _scaled(variant: Variant, x: Sequence[float], name: str) -> Variant:
    def inputs(batch: Batch) -> Batch:
        own: dict[str, Any] = {name: float(x[0]) * getattr(batch, name)}
        return replace(batch, **own)

    return variant.with_input(inputs)


def _velocity_terms(variant: Variant, x: Sequence[float]) -> Variant:
    """What results without rates, and a factor times the rest."""
    factor = float(x[0])

    def outputs(batch: Batch, values: Values) -> Values:
        given = variant.given(batch)
        at_rest = replace(given, v=np.zeros_like(given.v))
        still = variant.shown(batch, run(variant.model, at_rest, variant.mutations))
        return {
            key: still[key] + factor * (values[key] - still[key]) if factor != 1.0 else values[key] for key in values
        }

    return variant.with_output(outputs)


FACTORS = (
    ("factor of a", "a is multiplied by a factor", "pass a as it is", partial(_scaled, name="a")),
    ("factor of v", "v is multiplied by a factor", "pass v as it is", partial(_scaled, name="v")),
    (
        "factor of velocity terms", "velocity terms are multiplied by a factor",
        "add velocity terms once, with sign +", _velocity_terms,
    ),
)  # fmt: skip
"""Name, sentence, repair, and the program with the factor."""
