"""Tests of `my_dynamics`: pytest examples/pytest."""

from __future__ import annotations

from functools import partial

import my_dynamics
from hypothesis import given, settings

from rttrr_pin.conformance import assert_inverse_dynamics, level_robots, parametrize_with_checks
from rttrr_pin.conformance.kit.strategies import robots_in_motion

PATH = level_robots()["rttrr"]
my_id = partial(my_dynamics.inverse_dynamics, my_dynamics.read_chain(PATH))


@parametrize_with_checks(str(PATH))
def test_inverse_dynamics(check):
    check(my_id)


def test_of_the_levels_of_this_robot():
    assert_inverse_dynamics(my_id, PATH, n_states=4)


@settings(max_examples=20, deadline=None)
@given(robots_in_motion(4, ("revolute", "prismatic", "fixed"), trees=False, mimic=False))
def test_of_any_chain(tmp_path_factory, example):
    robot, state = example
    path = tmp_path_factory.mktemp("drawn") / "robot.urdf"
    path.write_text(robot.model.document.text)
    assert_inverse_dynamics(partial(my_dynamics.inverse_dynamics, my_dynamics.read_chain(path)), robot, states=state)
