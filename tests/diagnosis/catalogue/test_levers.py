"""Programs under a hypothesis are those with the same fault, written by hand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import rttrr_pin
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.joints import joints
from rttrr_pin.diagnosis.catalogue.levers import levers
from rttrr_pin.diagnosis.catalogue.mechanics import mechanics
from rttrr_pin.diagnosis.catalogue.neighbours import neighbours
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from support import planted
from support.planted import text


def assert_same(robot: str, own: Callable[[Model], Hypothesis], program: planted.Program) -> None:
    loaded = rttrr_pin.load(text(robot))
    states = sample_states(loaded, 30, payload=None).states
    hypothesis = own(loaded.model)
    tau = hypothesis.apply(Variant(loaded.model), hypothesis.neutral).evaluate(states)["tau"]
    right = Variant(loaded.model).evaluate(states)["tau"]
    by_hand = np.array([program(*state) for state in zip(states.q, states.v, states.a, strict=True)])
    assert np.abs(tau - right).max() > 1e-4
    assert np.allclose(tau, by_hand, rtol=1e-12, atol=1e-13)


def test_a_force_at_the_next_joint_is_what_the_toolbox_did() -> None:
    assert_same("modified_dh", lambda m: levers(m)[0], planted.newton_euler("modified_dh", lever_of_next=True))


def test_one_term_of_three_that_is_turned_is_what_the_toolbox_did() -> None:
    def own(model: Model) -> Hypothesis:
        return next(one for one in mechanics(model) if one.id.startswith("outwards: turn the first term alone"))

    assert_same("modified_dh", own, planted.newton_euler("modified_dh", partly_turned=True))


def test_a_tensor_that_is_not_turned_is_what_fusing_without_turning_gives() -> None:
    def own(model: Model) -> Hypothesis:
        return next(one for one in neighbours(model) if one.id == "tensor of a fixed link not turned")

    assert_same("arm_with_gripper", own, planted.merged_without_turning(text("arm_with_gripper"), "gripper_mount"))


def test_a_file_without_friction_is_none_whose_friction_counts() -> None:
    robot = rttrr_pin.load(text("modified_dh")).with_joint_effects({"joint_1": rttrr_pin.JointEffects(0.1, 0.2, 0.3)})
    assert not [one.id for one in joints(robot.model) if one.id.startswith("friction of the file")]
