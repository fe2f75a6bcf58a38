"""`assert_inverse_dynamics`: nothing where a program is right, and a text that names the fault where it is not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import Robot, load
from rttrr_pin.conformance import assert_inverse_dynamics
from rttrr_pin.diagnosis.variants.mutations import at, mutation
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.errors import InputError, MissingJointError, ShapeError
from rttrr_pin.implementations import Batch

DATA = Path(__file__).parents[2] / "data" / "torques_differ"

Array = np.ndarray


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load(DATA / "two_links.urdf")


def function_of(variant: Variant) -> Callable[[Array, Array, Array], Array]:
    def my_id(q: Array, v: Array, a: Array) -> Array:
        return variant.evaluate(Batch(variant.model, *np.atleast_2d(q, v, a)))["tau"].reshape(v.shape)

    return my_id


@pytest.fixture(scope="module")
def right(robot: Robot) -> Callable[[Array, Array, Array], Array]:
    return function_of(Variant(robot.model))


@pytest.fixture(scope="module")
def wrong(robot: Robot) -> Callable[[Array, Array, Array], Array]:
    """Without the gyroscopic term of the last link, or a tensor's part where there is none."""
    error = at(mutation("outwards: drop body.I @ w_dot"), 1)
    return function_of(Variant(robot.model).with_mutation(error))


def message_of(*arguments: Any, **how: Any) -> str:
    with pytest.raises(AssertionError) as caught:
        assert_inverse_dynamics(*arguments, **how)
    return str(caught.value)


def test_a_right_program_passes(robot: Robot, right: Any) -> None:
    assert_inverse_dynamics(right, robot, n_states=4)
    assert_inverse_dynamics("recursion", DATA / "two_links.urdf", n_states=2, levels=["payload", "fast"])


def test_a_fault_is_named_with_link_repair_and_a_test(robot: Robot, wrong: Any) -> None:
    lines = message_of(wrong, robot, n_states=4).splitlines()
    assert lines[0] == "my_id does not compute the inverse dynamics of two_links:"
    text = "\n".join(lines)
    link = robot.model.link_names[1]
    [cause] = [line for line in lines if line.startswith("cause: ")]
    assert link in cause
    assert "repair: " in text and "within rounding: gravity" in text
    begin = lines.index("a state as simple as could be found, as a test:") + 1
    compile("\n".join(line.removeprefix("  ") for line in lines[begin:]), "<test>", "exec")


def test_own_states_are_asked_alone(robot: Robot, wrong: Any) -> None:
    """At rest the fault does not show."""
    nothing, one = np.zeros(2), np.ones(2)
    assert_inverse_dynamics(wrong, robot, states=(one, nothing, nothing))
    text = message_of(wrong, robot, states=(np.zeros((3, 2)), one, one), diagnose=False)
    assert "at the states that were passed: " in text
    assert "state 0 of two_links: q=[0.0, 0.0], v=[1.0, 1.0], a=[1.0, 1.0]" in text


def test_states_come_by_joint_name_too(robot: Robot, right: Any) -> None:
    names = robot.model.v_names
    state = dict.fromkeys(names, 0.5)
    assert_inverse_dynamics(right, robot, states=(state, state, state))
    with pytest.raises(MissingJointError):
        assert_inverse_dynamics(right, robot, states=({names[0]: 1.0}, state, state))


def test_a_batch_that_does_not_fit_is_refused(robot: Robot, right: Any) -> None:
    with pytest.raises(InputError):
        assert_inverse_dynamics(right, robot, states=(np.zeros(2), np.zeros(2)))
    with pytest.raises(ShapeError):
        assert_inverse_dynamics(right, robot, states=(np.zeros((2, 2)), np.zeros((3, 2)), np.zeros(2)))


def test_a_program_that_fails_has_its_error_told(robot: Robot) -> None:
    """At rates that it was not tried at."""

    def my_id(q: Array, v: Array, a: Array) -> Array:
        if np.abs(v).max() > 10.0:
            raise OverflowError("too fast for me")
        return np.zeros_like(v)

    assert "too fast for me" in message_of(my_id, robot, levels=["fast"])


def test_what_cannot_be_explained_says_what_it_depends_on(robot: Robot, right: Any) -> None:
    def my_id(q: Array, v: Array, a: Array) -> Array:
        return right(q, v, a) + 0.1 * np.sin(7.0 * q) * np.cosh(v)

    text = message_of(my_id, robot, levels=["gravity"])
    assert "no cause of the catalogue explains it:" in text
    assert "a state as simple as could be found" in text


def test_a_program_that_offers_nothing_is_no_right_one(robot: Robot, right: Any) -> None:
    with pytest.raises(InputError, match="offers none of payload"):
        assert_inverse_dynamics(right, robot, levels=["payload"])
