"""The order in which deviations are looked at is the order in which the recursion computes."""

from __future__ import annotations

import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.exact.adjudication import Deviation, in_order, walk
from support.trees import random_tree


@pytest.mark.parametrize("seed", range(8))
def test_the_walk_meets_everything_once_and_causes_first(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 12), base="floating").model
    steps = list(walk(model))
    assert len(steps) == len(set(steps)) == 4 * len(model.links) + model.nv
    at = {step: k for k, step in enumerate(steps)}
    column = 0
    for i in model.independent:
        made_of = [i, *(k for k, joint in enumerate(model.joints) if joint.mimic and joint.mimic.joint == i)]
        for k in range(column, column + model.joints[i].nv):
            assert all(at["tau", k] > max(at["f", link], at["n", link]) for link in made_of)
        column += model.joints[i].nv
    for i, joint in enumerate(model.joints):
        if joint.parent >= 0:
            assert at["F", joint.parent] < at["F", i] and at["n", joint.parent] > at["n", i]
    assert max(at["N", i] for i in range(len(model.links))) < min(at["f", i] for i in range(len(model.links)))


def test_deviations_are_put_in_that_order(rttrr: Robot) -> None:
    names = [("tau", at) for at in rttrr.joint_names] + [(key, at) for key in "FNfn" for at in rttrr.link_names]
    ordered = in_order(rttrr.model, [Deviation(*name, 0.0, 0.0, 0.0, "N") for name in names])
    places = [(one.quantity, one.at) for one in ordered]
    assert places[:3] == [("F", "link_1"), ("N", "link_1"), ("F", "link_2")]
    assert places[12:15] == [("f", "tool"), ("n", "tool"), ("f", "link_5")] and places[16] == ("tau", "joint_5")
    assert sorted(places) == sorted(names)
