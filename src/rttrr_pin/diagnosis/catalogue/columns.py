"""Columns of q, v, a and tau, multiplied by factors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.catalogue.slots import Slots
from rttrr_pin.diagnosis.variants.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch


def scaled(variant: Variant, q: Mapping[int, float], v: Mapping[int, float], a: Mapping[int, float]) -> Variant:
    """The program whose inputs are multiplied by factors, by column."""

    def inputs(batch: Batch) -> Batch:
        return replace(batch, q=_times(batch.q, q), v=_times(batch.v, v), a=_times(batch.a, a))

    return variant.with_input(inputs)


def tau_scaled(variant: Variant, factors: Mapping[int, float]) -> Variant:
    """The program whose tau is multiplied by factors, by column."""
    return variant.with_output(lambda batch, values: {**values, "tau": _times(values["tau"], factors)})


def geared(variant: Variant, x: Sequence[float], joint: Slots) -> Variant:
    """The program that has q, v, a and tau of a joint multiplied by a factor."""
    q, v = dict.fromkeys(joint.q, float(x[0])), dict.fromkeys(joint.v, float(x[0]))
    return tau_scaled(scaled(variant, q, v, v), v)


def _times(x: Array, factors: Mapping[int, float]) -> Array:
    if not factors:
        return x
    row = np.ones(x.shape[1])
    row[list(factors)] = list(factors.values())
    return x * row


def added(values: Values, at: Sequence[int], force: Array | float) -> Values:
    """Values with a force more at some rates."""
    tau = values["tau"].copy()
    tau[:, at] += force
    return {**values, "tau": tau}
