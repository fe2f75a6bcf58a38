"""The catalogues of conventions, parameters, joints and placements: what holds of each of their hypotheses."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.catalogue.conventions import conventions
from rttrr_pin.diagnosis.catalogue.joint_terms import joint_terms
from rttrr_pin.diagnosis.catalogue.joints import joints
from rttrr_pin.diagnosis.catalogue.parameters import parameters
from rttrr_pin.diagnosis.catalogue.placements import placements
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.validation.sampling import Sampler
from support.robots import driven
from support.serial_chains import random_chain
from support.trees import random_tree

CATALOGUES = (conventions, parameters, joints, placements, joint_terms)

MOVING = ("revolute", "continuous", "prismatic", "fixed")

CLOSE = 1e-9
"""Relative to the largest number of a quantity."""

UNSEEN = 1e-7

REVERSALS = (
    "sign of tau",
    "sign of tau at a joint",
    "joint direction",
    "joints exchanged",
    "order reversed",
    "gravity of another sign",
    "sign of the payload",
    "sign of f and n",
    "moments before forces",
    "quaternion conjugated",
    "base, angular first",
)


def _twins() -> Robot:
    """Two arms whose links are called left and right."""
    text = random_tree(5, 5, ("revolute",), mimics=False)
    names = {"link_0": "left_arm", "link_1": "right_arm"}
    for old, new in names.items():
        text = text.replace(f'"{old}"', f'"{new}"')
    return rttrr_pin.load(text)


@cache
def robots() -> dict[str, Robot]:
    tree = rttrr_pin.load(random_tree(3, 4, MOVING))
    return {
        "rttrr": rttrr_pin.load("rttrr"),
        "serial": rttrr_pin.load(random_chain(4, ("revolute",) * 4 + ("fixed",))),
        "tree": rttrr_pin.load(random_tree(1, 5, MOVING, mimics=False)),
        "mimic": driven(rttrr_pin.load(random_tree(11, 6, ("revolute", "prismatic")))),
        "frictionless": Robot(rttrr_pin.load(random_tree(2, 4, MOVING)).model.without_friction()),
        "all types": rttrr_pin.load(random_tree(39, 6)),
        "floating": Robot(tree.model.with_floating_base()),
        "twins": _twins(),
    }


NAMES = ("rttrr", "serial", "tree", "twins", "frictionless", "mimic", "all types", "floating")
"""The arm, the mimic joints and the floating base stand where `one_in` takes one of them."""


def hypotheses(model: Model) -> list[Hypothesis]:
    return [one for catalogue in CATALOGUES for one in catalogue(model)]


@cache
def batch(name: str) -> Batch:
    """Random states, a payload in link axes and one in base axes."""
    model = robots()[name].model
    own = Sampler(model, seed=3).draw(0, 5)
    rng = np.random.default_rng(4)
    depth = [len(list(model.path(i))) for i in range(len(model.links))]
    deepest = depth.index(max(depth))
    massive = max(range(len(depth)), key=lambda i: (bool(model.links[i].com.any()), depth[i]))
    loads = (
        Load(massive, rng.uniform(-50, 50, (5, 3)), rng.uniform(-10, 10, (5, 3))),
        Load(deepest, rng.uniform(-50, 50, 3), rng.uniform(-10, 10, 3), in_base=True),
    )
    return replace(own, loads=loads)


def change(one: Hypothesis) -> Array:
    """Of the parameters, at the start of the fit."""
    assert one.parameters is not None
    return np.array(one.start) @ one.parameters if one.start else one.parameters


def gap(x: Values, y: Values) -> float:
    """The largest difference, relative to the largest number of its quantity."""
    return max(float(np.abs(x[key] - y[key]).max() / (np.abs(y[key]).max() or 1.0)) for key in y if y[key].size)


@pytest.mark.parametrize("name", NAMES)
def test_identifiers_are_unique(name: str) -> None:
    keys = [(one.id, one.link, one.joint) for one in hypotheses(robots()[name].model)]
    assert len(keys) > 100
    assert len(set(keys)) == len(keys), {key for key in keys if keys.count(key) > 1}


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", NAMES)
def test_neutral_numbers_are_the_reference(name: str) -> None:
    own = batch(name)
    plain = Variant(own.model)
    reference = plain.evaluate(own)
    for one in hypotheses(own.model):
        assert len(one.start) == len(one.neutral)
        if one.neutral:
            assert gap(one.apply(plain, one.neutral).evaluate(own), reference) < CLOSE, one.sentence


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", NAMES)
def test_each_changes_a_number(name: str) -> None:
    """Those that are not linear in inertial parameters, at random states with payloads; no input is changed in place."""
    own = batch(name)
    plain = Variant(own.model)
    reference = plain.evaluate(own)
    kept = [x.copy() for x in (own.q, own.v, own.a, *reference.values())]
    unseen = [
        (one.id, one.link, one.joint)
        for one in hypotheses(own.model)
        if one.parameters is None and gap(one.apply(plain, one.start).evaluate(own), reference) < UNSEEN
    ]
    assert not unseen
    for x, y in zip(kept, (own.q, own.v, own.a, *reference.values()), strict=True):
        assert np.array_equal(x, y)


@pytest.mark.one_in(8)
@pytest.mark.parametrize("name", NAMES)
def test_parameters_are_what_apply_does(name: str) -> None:
    """They are the difference of the two robots' parameters, and tau by the regressor is tau by the recursion."""
    own, robot = replace(batch(name), loads=()), robots()[name]
    plain = Variant(own.model)
    reference, before = plain.evaluate(own)["tau"], robot.inertial_parameters()
    Y = robot.regressor(own.q, own.v, own.a)
    told = [one for one in parameters(own.model) if one.parameters is not None]
    assert len(told) > 20
    for k, one in enumerate(told):
        assert one.parameters is not None
        assert one.parameters.shape == ((len(one.start),) if one.start else ()) + before.shape
        altered = one.apply(plain, one.start)
        after = Robot(altered.model).inertial_parameters()
        assert change(one).any(), one.id
        assert np.abs(after - before - change(one)).max() < CLOSE * max(np.abs(after).max(), np.abs(before).max()), (
            one.id
        )
        if k % 7 == 0:
            tau = altered.evaluate(own)["tau"]
            size = max(np.abs(tau).max(), np.abs(reference).max())
            assert np.abs(tau - reference - Y @ change(one)).max() < CLOSE * size, (one.id, one.link)


@pytest.mark.one_in(2)
@pytest.mark.parametrize("name", ["rttrr", "mimic"])
def test_two_are_applied_one_after_the_other(name: str) -> None:
    """Nothing of the first is lost: its inputs and outputs come first, and changes of inertia add up."""
    model = robots()[name].model
    every = hypotheses(model)
    for first, second in product(every[::9], every[::11]):
        one = first.apply(Variant(model), first.start)
        both = second.apply(one, second.start)
        assert both.inputs[: len(one.inputs)] == one.inputs
        assert both.outputs[: len(one.outputs)] == one.outputs
    linear = [one for one in every if one.parameters is not None and one.link]
    before = Robot(model).inertial_parameters()
    for first, second in product(linear[::40], linear[::30]):
        if first.link != second.link:
            both = second.apply(first.apply(Variant(model), first.start), second.start)
            after = Robot(both.model).inertial_parameters()
            assert np.abs(after - before - change(first) - change(second)).max() < CLOSE * np.abs(after).max()


@pytest.mark.parametrize("name", ["rttrr", "floating"])
def test_reversals_made_twice_are_none(name: str) -> None:
    own = batch(name)
    plain = Variant(own.model)
    reference, seen = plain.evaluate(own), 0
    for one in conventions(own.model):
        if one.id in REVERSALS:
            assert gap(one.apply(one.apply(plain, ()), ()).evaluate(own), reference) < CLOSE, one.sentence
            seen += 1
    assert seen > 10


@pytest.mark.parametrize("name", NAMES)
def test_sentences_are_told_with_numbers(name: str) -> None:
    for one in hypotheses(robots()[name].model):
        for text in (one.id, one.sentence, one.repair):
            assert text
            assert "{" not in text
            assert "array" not in text
        values = one.values(one.start)
        assert not one.start or values, one.id


def calls_for(links: int) -> int:
    """Function calls that the catalogue of a random tree takes: what it does, whatever the machine."""
    model, seen = rttrr_pin.load(random_tree(8, links, MOVING)).model, 0

    def count(_frame: object, event: str, _of: object) -> None:
        nonlocal seen
        seen += event == "call"

    hypotheses(model)
    sys.setprofile(count)
    try:
        assert len(hypotheses(model)) > 40 * links
    finally:
        sys.setprofile(None)
    return seen


def test_the_work_grows_as_the_tree() -> None:
    assert calls_for(32) < 3 * calls_for(16)


def test_lines_are_those_of_the_file() -> None:
    robot = robots()["rttrr"]
    told = {one.line for one in parameters(robot.model) if one.link == "link_2"}
    assert len(told) == 1
    line = int(told.pop().split()[1])
    assert 'name="link_2"' in robot.model.urdf.splitlines()[line - 1]
