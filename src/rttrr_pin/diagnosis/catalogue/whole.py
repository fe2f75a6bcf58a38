"""The whole catalogue: a new part of it is a line here."""

from __future__ import annotations

from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.conventions import conventions
from rttrr_pin.diagnosis.catalogue.joint_terms import joint_terms
from rttrr_pin.diagnosis.catalogue.joints import joints
from rttrr_pin.diagnosis.catalogue.levers import levers
from rttrr_pin.diagnosis.catalogue.mechanics import mechanics
from rttrr_pin.diagnosis.catalogue.parameters import parameters
from rttrr_pin.diagnosis.catalogue.placements import placements
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis

CATALOGUES = (conventions, parameters, placements, joints, mechanics, levers, joint_terms)


def hypotheses_of(model: Model) -> list[Hypothesis]:
    """All hypotheses about a robot."""
    return [own for catalogue in CATALOGUES for own in catalogue(model)]
