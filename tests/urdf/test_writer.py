"""A model written as a URDF and read again is the same model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.core.joint import Limits
from rttrr_pin.core.model import Model
from rttrr_pin.urdf.writer import urdf_text
from support.robots import BUNDLED
from support.serial_chains import EXAMPLES, random_chain
from support.tolerances import EXACT, MODEL, norm_error
from support.trees import random_tree


def again(model: Model) -> Model:
    return rttrr_pin.load(urdf_text(model), base="floating" if model.floating else "fixed", friction=True).model


@pytest.mark.parametrize("source", [*BUNDLED, *EXAMPLES, *range(6)])
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_a_written_model_is_read_as_the_same(source: str | int, base: str) -> None:
    """Rotations to a few eps, all else to the last bit, followers and friction included."""
    text = random_tree(source, 9) if isinstance(source, int) else EXAMPLES.get(source, source)
    model = rttrr_pin.load(text, base=base, friction=True).model  # type: ignore[arg-type]
    read = again(model)
    assert (read.name, read.root.name, read.link_names) == (model.name, model.root.name, model.link_names)
    for one, other in zip(read.joints, model.joints, strict=True):
        assert (one.name, one.type, one.parent, one.limits, one.effects) == (
            other.name,
            other.type,
            other.parent,
            other.limits,
            other.effects,
        )
        assert norm_error(one.p, other.p) == EXACT
        assert norm_error(one.R, other.R) <= MODEL
        assert norm_error(one.axis, other.axis) <= MODEL
        assert (one.mimic is None) == (other.mimic is None)
        if one.mimic and other.mimic:
            assert (one.mimic.joint, one.mimic.multiplier, one.mimic.offset) == (
                other.mimic.joint,
                other.mimic.multiplier,
                other.mimic.offset,
            )
    for link, same in zip(read.links, model.links, strict=True):
        assert link.mass == same.mass
        assert norm_error(link.com, same.com) == EXACT
        assert norm_error(link.inertia, same.inertia) == EXACT


@pytest.mark.parametrize(
    ("limits", "written"),
    [
        (Limits(), ("continuous", Limits())),
        (Limits(-1.0, 2.0, 3.0, 4.0), ("revolute", Limits(-1.0, 2.0, 3.0, 4.0))),
        (Limits(lower=0.5, velocity=3.0), ("revolute", Limits(0.5, 0.5, 3.0, 0.0))),
        (Limits(upper=0.5), ("revolute", Limits(0.0, 0.5, 0.0, 0.0))),
        (Limits(upper=-0.5), ("revolute", Limits(-0.5, -0.5, 0.0, 0.0))),
        (Limits(effort=5.0), ("continuous", Limits(velocity=0.0, effort=5.0))),
    ],
)
def test_limits_that_urdf_has_no_words_for(limits: Limits, written: tuple[str, Limits]) -> None:
    model = rttrr_pin.load(random_chain(3, ("revolute",))).model
    (joint,) = again(replace(model, joints=(replace(model.joints[0], limits=limits),))).joints
    assert (joint.type.name, joint.limits) == written


def test_names_survive_whatever_their_letters() -> None:
    model = rttrr_pin.load(EXAMPLES["one-joint"]).model
    named = replace(model, name="\u00e4<&>\"'", root=replace(model.root, name="a  b\u00a0"))
    assert (again(named).name, again(named).root.name) == (named.name, named.root.name)


def test_every_digit_survives() -> None:
    model = rttrr_pin.load(EXAMPLES["one-joint"]).model
    for mass in (5e-324, 1.7976931348623157e308, 0.1 + 0.2, -0.0, -1.0):
        assert again(replace(model, links=(replace(model.links[0], mass=mass),))).links[0].mass == mass
    assert np.isfinite(model.links[0].inertia).all()
