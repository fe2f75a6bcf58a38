"""Sliders set numbers within limits, and what they set can be read back."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.viewing.states import at_rest, displacement, moved, rotation_vector, slider, sliders
from support.tolerances import MODEL
from support.viewed import AWKWARD, random_state, tree


@pytest.mark.parametrize("seed", range(6))
def test_a_displacement_leads_back_to_the_coordinates(seed: int) -> None:
    model = tree(seed, floating=seed % 2 == 0).model
    q = random_state(tree(seed, floating=seed % 2 == 0), seed).q
    again = model.coordinates_at(displacement(model, q)[None])[0]
    for k in model.quaternions:  # of two signs, the same rotation
        again[k : k + 4] *= np.sign(again[k : k + 4] @ q[k : k + 4])
    assert np.linalg.norm(again - q) <= MODEL * (1.0 + np.linalg.norm(q))


def test_the_rotation_vector_is_the_shortest() -> None:
    half = 3.0 / 2.0
    turned = np.array([0.0, 0.0, math.sin(half), math.cos(half)])
    assert np.allclose(rotation_vector(turned), [0, 0, 3.0], rtol=MODEL)
    assert np.allclose(rotation_vector(-turned), [0, 0, 3.0], rtol=MODEL)
    assert not rotation_vector(np.array([0.0, 0.0, 0.0, 1.0])).any()


@pytest.mark.parametrize(
    ("low", "high"),
    [(-2.97, 2.97), (0.0, 1e-4), (-1e-9, 3e-9), (-0.3, 0.7), (0.12, 0.45), (-math.pi, math.pi), (-1e6, 7.0)],
)
def test_a_slider_keeps_to_limits_and_reaches_zero(low: float, high: float) -> None:
    own = slider("x", "rad", low, high)
    assert low <= own.low + 1e-6 * own.step and own.high - 1e-6 * own.step <= high
    assert own.low - low < own.step and high - own.high < own.step
    assert (own.high - own.low) / own.step >= 400
    if low <= 0.0 <= high:
        assert own.shown(0.0) == 0.0 and abs(own.low / own.step - round(own.low / own.step)) < 1e-6
    for x in (low, high, 0.3 * low + 0.7 * high, 2.0 * high + 1.0):
        assert own.low <= own.shown(x) <= own.high


def test_sliders_go_as_far_as_the_limits() -> None:
    robot = rttrr_pin.load(AWKWARD)
    q = sliders(robot.model)["q"]
    assert [(own.low, own.high) for own in q] == [(-1.0, 2.0), (-3.14, 3.14), (0.0, 1e-4)]
    assert [own.unit for own in sliders(robot.model)["v"]] == ["rad/s", "rad/s", "m/s"]


def test_a_floating_base_moves_too() -> None:
    robot = rttrr_pin.load("rttrr", base="floating")
    state = moved(robot.model, at_rest(robot.model), "q", 2, 0.5)
    state = moved(robot.model, state, "q", 5, 0.7)
    assert np.allclose(state.q[:7], [0, 0, 0.5, 0, 0, math.sin(0.35), math.cos(0.35)], atol=MODEL)
    assert moved(robot.model, state, "v", 3, 2.0).v[3] == 2.0
    assert moved(robot.model, state, "a", 1, -1.0).a[1] == -1.0


def test_moving_one_joint_leaves_the_bits_of_the_others() -> None:
    robot = rttrr_pin.load("rttrr")
    state = random_state(robot)
    after = moved(robot.model, state, "q", 1, 0.01)
    assert after.q[1] == 0.01
    assert (np.delete(after.q, 1) == np.delete(state.q, 1)).all()


def test_at_rest_is_within_the_limits() -> None:
    robot = rttrr_pin.load('<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>'
                           '<child link="b"/><axis xyz="0 0 1"/><limit lower="0.5" upper="1" velocity="1" effort="1"/></joint></robot>')  # fmt: skip
    assert at_rest(robot.model).q == [0.5]
