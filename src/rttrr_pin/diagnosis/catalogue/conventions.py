"""Hypotheses on conventions: signs, units, order of joints, gravity, frames and points; none on the mechanics."""

from __future__ import annotations

from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.base_conventions import base_conventions
from rttrr_pin.diagnosis.catalogue.equation_terms import equation_terms
from rttrr_pin.diagnosis.catalogue.gravity import gravities
from rttrr_pin.diagnosis.catalogue.joint_order import orders
from rttrr_pin.diagnosis.catalogue.payload_conventions import payload_conventions
from rttrr_pin.diagnosis.catalogue.signs_and_units import no_tau, signs_and_units
from rttrr_pin.diagnosis.catalogue.wrench_conventions import wrench_conventions
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis


def conventions(model: Model) -> list[Hypothesis]:
    """All hypotheses on conventions about a robot; those that change no number of it are left out."""
    if not model.nv:
        return [*gravities(model), *wrench_conventions(model), *payload_conventions(model)]
    return [
        *no_tau(model),
        *gravities(model),
        *equation_terms(model),
        *signs_and_units(model),
        *orders(model),
        *base_conventions(model),
        *wrench_conventions(model),
        *payload_conventions(model),
    ]
